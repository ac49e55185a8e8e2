"""Neutral parameters: values at which a module changes nothing (the hypothesis of Theorem 1).

Theorem 1 says that w1 = w2 z is at least as robust as its prefix w2. Its proof (Appendix) takes the
best parameters of w2, with 0 for the new module z, as parameters of w1, and says that the two
robots are then the same. So it needs, for *every* module that may be added, values within that
module's own range at which it adds no mass and moves no frame. With lengths bounded below there are
none, and the claim is false in general (row 4.9 of ``docs/explanation/errata.md``).

This module decides the hypothesis module by module from the semantic rules. A production
``A -> A z`` changes nothing if it passes on every attribute as it received it and emits nothing:
then the derivation without it gives the same robot (``production_change``). This has limits:

- A joint adds a coordinate. The robot is the same only while the joint is held, which takes an
  effort that the shorter robot need not have. So a module with a degree of freedom has no neutral
  values here, and this argument does not prove Theorem 1 for any grammar whose robots grow by such
  modules.
- An effector adds an effector; a base starts a robot and is added to none.
- A module is not judged if it comes together with others, stands between several nonterminals, or
  leads from one nonterminal to another: the word without it then has another derivation, if any.
- At neutral values a link between two joints leaves them on one axis, where M is singular: the
  longer robot is the shorter one as a mechanism, but may still be inadmissible as a model.
- A massless body is still a point of the body for ``avoid ... with body``, at the start of a copied
  frame. The text of the finding says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from graphlib import TopologicalSorter
from itertools import combinations, islice, product
from typing import Literal, TypeAlias

from compiler.expressions.evaluators.trigonometric import TooManyTerms
from compiler.neutral_modules.parameter_domains import (
    Domain,
    Value,
    contains,
    domain_text,
    multiples_within,
    named_values,
    value_text,
)
from compiler.neutral_modules.production_change import (
    Equation,
    NotCopied,
    ProductionChange,
    roots_of,
)
from compiler.robots.evaluation_order import UsefulAttributes, useful_attributes
from grammar_lang import ir
from grammar_lang.elaboration.circularity import reads
from grammar_lang.ir.expressions import too_large

CANDIDATES = 1000
"""The most combinations of values that are tried for one module."""

Values: TypeAlias = tuple[tuple[str, Value], ...]
Status: TypeAlias = Literal["neutral", "excluded", "not shown"]


@dataclass(frozen=True, slots=True)
class NeutralParameters:
    """The finding about a module at one occurrence on the right side of a production.

    - ``neutral``: at ``values``, within their ranges, it changes nothing; parameters that are not
      named may have any value.
    - ``excluded``: it would change nothing at ``values``, but the ranges contain neither these nor
      any others with this property; ``reason`` names a range that contains none.
    - ``not shown``: no such values are known; ``reason`` says why.
    """

    module: str
    production: str
    occurrence: int
    status: Status
    values: Values
    reason: str

    @property
    def text(self) -> str:
        """The finding in one line."""
        where = f"module `{self.module}` in `{self.production}`"
        at = " and ".join(f"{name} = {value_text(value)}" for name, value in self.values)
        if self.status == "neutral":
            found = f"{where} is neutral at {at}" if at else f"{where} is neutral"
            return found if at and self.reason == NOTHING else f"{found}: {self.reason}"
        if self.status == "excluded":
            return f"{where} would be neutral at {at}, but {self.reason}: Theorem 1 does not apply"
        return f"{where} has no neutral value that is known: {self.reason}"


NOTHING = "it adds neither mass nor motion"
MASSLESS = f"{NOTHING}, only points without mass, which `avoid ... with body` sees"


def neutral_parameters(program: ir.Program, grammar: ir.Grammar) -> list[NeutralParameters]:
    """The neutral parameters of all modules of a grammar, by production and position.

    A grammar without semantics gives no findings.
    """
    blocks = grammar.semantics or {}
    useful = useful_attributes(grammar.productions, blocks)
    found: list[NeutralParameters] = []
    for rule in grammar.productions:
        if rule.label not in blocks:
            continue
        block = inlined(blocks[rule.label])
        for occurrence, symbol in enumerate(rule.right):
            if symbol.kind == "module":
                module = program.modules[symbol.name]
                found.append(_Occurrence(rule, block, occurrence, module, useful).finding())
    return found


def inlined(block: ir.SemanticBlock) -> ir.SemanticBlock:
    """A block with its local values inserted where they are read, unless that gets too large.

    Local values that remain stand for unknowns, from which nothing is concluded.
    """
    rules = {rule.target: rule for rule in block.rules if rule.target.occurrence == ir.LOCAL}
    local: dict[ir.Expr, ir.Expr] = {}

    def new(expression: ir.Expr) -> ir.Expr:
        return ir.with_leaves(expression, lambda leaf: local.get(leaf, leaf))

    before = {name: {r for r in reads(rule.value) if r in rules} for name, rule in rules.items()}
    for target in TopologicalSorter(before).static_order():
        value = new(rules[target].value)
        local[target] = target if too_large(value) else value
    kept = (rule for rule in block.rules if rule.target not in rules)
    return ir.SemanticBlock(
        tuple(replace(rule, value=new(rule.value)) for rule in kept),
        tuple(ir.with_expressions(each, new) for each in block.emissions),
        block.span,
    )


@dataclass(frozen=True, slots=True)
class _Roots:
    """All values of one parameter at which a necessary equation holds.

    ``inside`` are such values in its domain, and ``outside`` is one that is not in it; with
    ``none`` there are certainly no values inside.
    """

    inside: tuple[Value, ...]
    outside: Value
    none: bool
    turn: bool


@dataclass(frozen=True, slots=True)
class _Occurrence:
    """A module on the right side of a production."""

    production: ir.Production
    block: ir.SemanticBlock
    occurrence: int
    module: ir.Module
    useful: UsefulAttributes

    def finding(self) -> NeutralParameters:
        reason = self._of_kind() or self._of_place()
        if reason is not None:
            return self._found("not shown", (), reason)
        try:
            change, equations = self._equations({})
        except NotCopied as problem:
            return self._found("not shown", (), str(problem))
        except TooManyTerms:
            return self._found("not shown", (), "its rules are too long to compare")
        return self._decided(self._roots(change, equations))

    def _decided(self, roots: Mapping[str, _Roots]) -> NeutralParameters:
        excluding = next((name for name, each in roots.items() if each.none), None)
        for values in islice(self._candidates(roots), CANDIDATES):
            if excluding is not None and excluding not in dict(values):
                continue
            inside = [contains(self._domain(name), value) for name, value in values]
            if excluding is None and not all(inside):
                continue
            if self._change(dict(values)) is None:
                if excluding is None:
                    return self._found("neutral", values, self._remaining())
                return self._found("excluded", values, self._excluding(excluding, roots))
        zeros: dict[str, Value] = {p.name: Fraction(0) for p in self.module.parameters}
        reason = self._change(zeros)
        return self._found("not shown", (), reason or "its ranges contain no value that was tried")

    def _remaining(self) -> str:
        return MASSLESS if self.block.emissions else NOTHING

    def _excluding(self, name: str, roots: Mapping[str, _Roots]) -> str:
        text = f"its {name} is in {domain_text(self._domain(name))}"
        return f"{text}, without a whole turn" if roots[name].turn else text

    def _found(self, status: Status, values: Values, reason: str) -> NeutralParameters:
        return NeutralParameters(
            self.module.name, self.production.label, self.occurrence, status, values, reason
        )

    def _domain(self, name: str) -> Domain:
        return next(p.domain for p in self.module.parameters if p.name == name)

    # --- reasons that exclude a module ----------------------------------------------------------

    def _of_kind(self) -> str | None:
        """Why a module of this kind always adds something."""
        if self.module.dofs:
            joint = self.module.dofs[0].name
            return f"it adds a degree of freedom, so that it is neutral only while {joint} is held"
        if self.module.states or self.module.inputs:
            return "it adds a state or an input of its own"
        if self.module.role == "base":
            return "a base starts a robot and is added to none"
        if self.module.role == "effector":
            return "it adds an effector"
        return None

    def _of_place(self) -> str | None:
        """Why the robot without this production is not known."""
        right = self.production.right
        for place, symbol in enumerate(right):
            if symbol.kind == "module" and place != self.occurrence:
                return f"it comes with `{symbol.name}` in one production"
        nonterminals = [symbol.name for symbol in right if symbol.kind == "nonterminal"]
        if len(nonterminals) != 1:
            return "its production extends no single part of a robot"
        if nonterminals[0] != self.production.left:
            left = self.production.left
            return f"it makes a `{left}` of a `{nonterminals[0]}`, which cannot just replace it"
        defined = {rule.target for rule in self.block.rules}
        for attribute in self.useful.due(self.production):
            if attribute not in defined:
                return f"its production does not define the attribute `{attribute.name}`"
        return None

    # --- candidates and ranges ------------------------------------------------------------------

    def _roots(self, change: ProductionChange, equations: list[Equation]) -> dict[str, _Roots]:
        """Parameters with an equation that only certain values satisfy."""
        names = {number: name for name, number in change.parameters.items()}
        found: dict[str, _Roots] = {}
        for equation in equations:
            roots = roots_of(equation.polynomial, change.evaluator.ring)
            if roots is None or not equation.necessary:
                continue
            number, root, unit = roots
            name = names[number]
            each = _within(self._domain(name), root, unit)
            if name not in found or each.none:
                found[name] = each
        return found

    def _candidates(self, roots: Mapping[str, _Roots]) -> Iterator[Values]:
        """Values for some of the parameters: few parameters first, zero before other values."""
        parameters = self.module.parameters
        options = {p.name: _options(p.domain, roots.get(p.name)) for p in parameters}
        names = [parameter.name for parameter in parameters]
        for size in range(len(names) + 1):
            for chosen in combinations(names, size):
                for values in product(*(options[name] for name in chosen)):
                    yield tuple(zip(chosen, values, strict=True))

    # --- changes made by the module -------------------------------------------------------------

    def _equations(self, values: Mapping[str, Value]) -> tuple[ProductionChange, list[Equation]]:
        nonterminal = next(
            i for i, symbol in enumerate(self.production.right) if symbol.kind == "nonterminal"
        )
        used = frozenset(self.useful.synthesized.get(self.production.left, ()))
        change = ProductionChange(self.block, nonterminal, self.occurrence, values, used)
        return change, change.equations()

    def _change(self, values: Mapping[str, Value]) -> str | None:
        """The change that the module makes at these values, as far as is known; None if none."""
        try:
            _, equations = self._equations(values)
        except NotCopied as problem:
            return str(problem)
        except TooManyTerms:
            return "its rules are too long to compare"
        return next((each.reason for each in equations if each.polynomial.terms), None)


def _within(domain: Domain, root: Fraction | None, unit: Fraction | None) -> _Roots:
    if root is not None:
        inside = contains(domain, root)
        return _Roots((root,) if inside else (), root, inside is False, turn=False)
    values, sure = multiples_within(domain, unit or Fraction(2))
    return _Roots(tuple(values), Fraction(0), sure and not values, turn=True)


def _options(domain: Domain, roots: _Roots | None) -> tuple[Value, ...]:
    """Values to try: those that an equation requires, else zero, one and those in the domain."""
    if roots is not None:
        return roots.inside or (roots.outside,)
    found = [Fraction(0), Fraction(1), *named_values(domain)]
    return tuple(dict.fromkeys(found))
