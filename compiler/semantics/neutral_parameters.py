"""Neutral parameters: values at which a module changes nothing (the hypothesis of Theorem 1).

Theorem 1 says that w1 = w2 z is at least as robust as its prefix w2.  Its proof (Appendix) writes
the best parameters of w2, with 0 for the new module z, as parameters of w1, and says that the two
robots are then the same.  So it needs, for *every* module that may be added, values within that
module's own range at which it adds no mass and moves no frame.  With lengths bounded below there
are none, and the claim is false in general (row 4.9 of ``docs/differences-from-the-paper.md``).

This file decides the hypothesis module by module from the semantic rules: every step of a frame
that a module contributes has to be the identity, every body it emits without mass.  What this
does not give:

- A joint adds a coordinate.  The robot is the same only while the joint is held, which takes an
  effort that the shorter robot need not have; so a module with a degree of freedom has no neutral
  values here, and Theorem 1 is shown by this argument for no grammar in which robots grow by them.
- An effector adds an effector; a base starts a robot and is added to none.
- At neutral values a link between two joints leaves them on one axis, where M is singular: the
  longer robot is the shorter one as a mechanism, and may still be inadmissible as a model.
- A massless body still is a point of the body for ``avoid ... with body``: one where the frame it
  stands on begins.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, islice, product
from typing import Literal, TypeAlias

from compiler.arithmetic.rational_enclosure import exact_rational, rational_bounds
from compiler.arithmetic.scalars import ScalarTable
from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text

CANDIDATES = 2000
"""The most combinations of values that are tried for one module."""

Values: TypeAlias = tuple[tuple[str, Fraction], ...]
Status: TypeAlias = Literal["neutral", "excluded", "not shown"]


@dataclass(frozen=True, slots=True)
class NeutralParameters:
    """What is known of a module where it occurs on the right side of a production.

    - ``neutral``: at ``values``, within their ranges, it changes nothing; parameters that are not
      named may have any value.
    - ``excluded``: it would at ``values``, but the ranges of ``reason`` do not contain them.
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
        at = " and ".join(f"{name} = {number_text(value)}" for name, value in self.values)
        if self.status == "neutral":
            return f"{where} is neutral at {at}" if at else f"{where} is neutral: {self.reason}"
        if self.status == "excluded":
            return f"{where} would be neutral at {at}, but {self.reason}: Theorem 1 does not apply"
        return f"{where} has no neutral value that is known: {self.reason}"


def neutral_parameters(program: ir.Program, grammar: ir.Grammar) -> list[NeutralParameters]:
    """The neutral parameters of all modules of a grammar, by production and place.

    A grammar without semantics gives no findings.
    """
    found: list[NeutralParameters] = []
    for rule in grammar.productions:
        block = (grammar.semantics or {}).get(rule.label)
        if block is None:
            continue
        for occurrence, symbol in enumerate(rule.right):
            if symbol.kind == "module":
                module = program.modules[symbol.name]
                others = rule.right[:occurrence] + rule.right[occurrence + 1 :]
                roles = [program.modules[s.name].role for s in others if s.kind == "module"]
                owner = "effector" in roles
                found.append(_Occurrence(rule, block, occurrence, module, owner).finding())
    return found


@dataclass(frozen=True, slots=True)
class _Occurrence:
    """A module on the right side of a production.

    ``others_are_effectors``: another module there has that role.
    """

    production: ir.Production
    block: ir.SemanticBlock
    occurrence: int
    module: ir.Module
    others_are_effectors: bool

    def finding(self) -> NeutralParameters:
        if self.module.dofs:
            joint = self.module.dofs[0].name
            reason = (
                f"it adds a degree of freedom, so that it is neutral only while {joint} is held"
            )
            return self._found("not shown", (), reason)
        if self.module.role == "base":
            return self._found("not shown", (), "a base starts a robot and is added to none")
        if self._adds_effector():
            return self._found("not shown", (), "it adds an effector")
        outside: Values | None = None
        for values in islice(self._candidates(), CANDIDATES):
            if self._change(dict(values)) is None:
                if self._excluding(values) is None:
                    return self._found("neutral", values, "it adds neither mass nor motion")
                if outside is None and self._certainly_excluded(values):
                    outside = values
        if outside is not None:
            return self._found("excluded", outside, self._excluding(outside) or "")
        zeros = {parameter.name: Fraction(0) for parameter in self.module.parameters}
        return self._found("not shown", (), self._change(zeros) or "its ranges are not rational")

    def _adds_effector(self) -> bool:
        """Whether an effector of the block is this module's, or no other module's."""
        if not any(isinstance(emission, ir.Effector) for emission in self.block.emissions):
            return False
        return self.module.role == "effector" or not self.others_are_effectors

    def _found(self, status: Status, values: Values, reason: str) -> NeutralParameters:
        return NeutralParameters(
            self.module.name, self.production.label, self.occurrence, status, values, reason
        )

    # --- candidates and ranges ------------------------------------------------------------------

    def _candidates(self) -> Iterator[Values]:
        """Values for some of the parameters: few before many, zero before others."""
        parameters = self.module.parameters
        options = {parameter.name: _options(parameter.domain) for parameter in parameters}
        names = [parameter.name for parameter in parameters]
        for size in range(len(names) + 1):
            for chosen in combinations(names, size):
                for values in product(*(options[name] for name in chosen)):
                    yield tuple(zip(chosen, values, strict=True))

    def _excluding(self, values: Values) -> str | None:
        """The first range that is not known to contain its value."""
        domains = {parameter.name: parameter.domain for parameter in self.module.parameters}
        for name, value in values:
            if _contains(domains[name], value) is not True:
                return f"its {name} is in {_domain_text(domains[name])}"
        return None

    def _certainly_excluded(self, values: Values) -> bool:
        domains = {parameter.name: parameter.domain for parameter in self.module.parameters}
        return any(_contains(domains[name], value) is False for name, value in values)

    # --- what the module changes ----------------------------------------------------------------

    def _change(self, values: Mapping[str, Fraction]) -> str | None:
        """What the module changes at these values, as far as is seen; None if nothing."""
        reader = _Reader(self.occurrence, values)
        for rule in self.block.rules:
            change = self._rule_change(rule, reader)
            if change is not None:
                return change
        for emission in self.block.emissions:
            frame = self._frame_change(emission.frame, reader)
            if frame is not None:
                return frame
            if self._owns(emission.mentions) and not reader.massless(emission):
                return "it adds mass"
        return None

    def _rule_change(self, rule: ir.AttributeRule, reader: _Reader) -> str | None:
        target = rule.target.name
        match rule.value:
            case ir.World() | ir.Rot() | ir.Move() | ir.Shift() | ir.Compose():
                return self._frame_change(rule.value, reader)
            case ir.AttributeOf(_, name) if name == target:
                return None
            case _ if not self._owns(rule.mentions) or reader.passes_on(rule):
                return None
            case _:
                return f"the attribute `{target}` depends on it"

    def _frame_change(self, expression: ir.Expr, reader: _Reader) -> str | None:
        """Whether a step of a frame that belongs to the module is not the identity."""
        todo = [expression]
        while todo:
            current = todo.pop()
            match current:
                case ir.Compose(left, right):
                    todo += [right, left]
                case ir.Rot(_, value) | ir.Move(_, value) | ir.Shift(value):
                    if self._owns(current.mentions) and not reader.vanishes(value):
                        return "it turns a frame" if isinstance(current, ir.Rot) else _MOVES
                case _:
                    pass
        return None

    def _owns(self, mentions: Sequence[int]) -> bool:
        """Whether a step or emission is the module's: it is named there, or no module is."""
        return self.occurrence in mentions or not any(
            i >= 0 and self.production.right[i].kind == "module" for i in mentions
        )


_MOVES = "it shifts a frame"


@dataclass(frozen=True, slots=True)
class _Reader:
    """Scalars of a block with values for the parameters of one occurrence, all else unknown."""

    occurrence: int
    values: Mapping[str, Fraction]

    def vanishes(self, expression: ir.Expr) -> bool:
        """Whether a scalar or vector is zero whatever the unknowns are."""
        if isinstance(expression, ir.Vector):
            return all(self.vanishes(item) for item in (expression.x, expression.y, expression.z))
        table, unknowns = ScalarTable(), dict[ir.Expr, int]()
        return table.rational(self._scalar(expression, table, unknowns)) == 0

    def massless(self, emission: ir.Emission) -> bool:
        """Whether a body has neither mass nor inertia nor extent."""
        match emission:
            case ir.Rod(_, _, length, density, radius):
                thin = radius is None or self.vanishes(radius)
                return thin and self.vanishes(length) and self._defined(density)
            case ir.PointMass(_, mass):
                return self.vanishes(mass)
            case ir.Solid(_, mass, com, inertia):
                moments = all(self.vanishes(item) for item in inertia)
                return moments and self.vanishes(mass) and self.vanishes(com)
            case ir.Effector():
                return False

    def passes_on(self, rule: ir.AttributeRule) -> bool:
        """Whether a scalar rule hands on an attribute of the same name unchanged."""
        table, unknowns = ScalarTable(), dict[ir.Expr, int]()
        try:
            found = self._scalar(rule.value, table, unknowns)
        except ValueError:
            return False
        same = (e for e in unknowns if isinstance(e, ir.AttributeOf))
        return any(e.name == rule.target.name and unknowns[e] == found for e in same)

    def _defined(self, expression: ir.Expr) -> bool:
        """Whether no quotient or root could be undefined: none is taken."""
        todo = [expression]
        while todo:
            current = todo.pop()
            match current:
                case ir.Binary("/", left, ir.Num(value)) if value:
                    todo.append(left)
                case ir.Binary("^", left, ir.Num(exponent)) if exponent >= 0:
                    todo.append(left)
                case ir.Binary("+" | "-" | "*", left, right):
                    todo += [left, right]
                case ir.Unary("neg" | "abs" | "sin" | "cos", operand):
                    todo.append(operand)
                case ir.Binary() | ir.Unary():
                    return False
                case _:
                    pass
        return True

    def _scalar(self, expression: ir.Expr, table: ScalarTable, unknowns: dict[ir.Expr, int]) -> int:
        """A scalar in a table; what is undefined somewhere is unknown."""
        match expression:
            case ir.Num(value):
                return table.constant(value)
            case ir.ParameterOf(occurrence, name) if (
                occurrence == self.occurrence and name in self.values
            ):
                return table.constant(self.values[name])
            case ir.Unary(function, operand) if function in ("neg", "abs", "sin", "cos", "tan"):
                return table.unary(function, self._scalar(operand, table, unknowns))
            case ir.Binary("^", left, ir.Num(exponent)) if exponent >= 1:
                return table.power(self._scalar(left, table, unknowns), int(exponent))
            case ir.Binary("/", left, right):
                return self._quotient(expression, left, right, table, unknowns)
            case ir.Binary(operator, left, right) if operator != "^":
                if not (self._defined(left) and self._defined(right)):
                    return self._unknown(expression, table, unknowns)
                first = self._scalar(left, table, unknowns)
                return table.binary(operator, first, self._scalar(right, table, unknowns))
            case _:
                return self._unknown(expression, table, unknowns)

    def _quotient(
        self,
        whole: ir.Expr,
        left: ir.Expr,
        right: ir.Expr,
        table: ScalarTable,
        unknowns: dict[ir.Expr, int],
    ) -> int:
        divisor = table.rational(self._scalar(right, table, unknowns))
        if not divisor:
            return self._unknown(whole, table, unknowns)
        numerator = self._scalar(left, table, unknowns)
        return table.binary("*", numerator, table.constant(1 / divisor))

    def _unknown(
        self, expression: ir.Expr, table: ScalarTable, unknowns: dict[ir.Expr, int]
    ) -> int:
        return table.parameter(unknowns.setdefault(expression, len(unknowns)))


# --- domains -------------------------------------------------------------------------------------


def _options(domain: ir.Interval | ir.Choices) -> tuple[Fraction, ...]:
    """Values to try: zero, one, and those that the domain names, as far as they are rational."""
    named = domain.values if isinstance(domain, ir.Choices) else (domain.lower, domain.upper)
    rationals = (exact_rational(value) for value in named)
    found = [Fraction(0), Fraction(1), *(value for value in rationals if value is not None)]
    return tuple(dict.fromkeys(found))


def _contains(domain: ir.Interval | ir.Choices, value: Fraction) -> bool | None:
    """Whether a domain contains a value; None where its bounds are too close to tell."""
    if isinstance(domain, ir.Choices):
        answers = [_equal(choice, value) for choice in domain.values]
        return True if True in answers else (None if None in answers else False)
    lower, upper = rational_bounds(domain.lower), rational_bounds(domain.upper)
    if lower[1] <= value <= upper[0]:
        return True
    return False if value < lower[0] or value > upper[1] else None


def _equal(expression: ir.Expr, value: Fraction) -> bool | None:
    low, high = rational_bounds(expression)
    if low == high:
        return low == value
    return None if low <= value <= high else False


def _domain_text(domain: ir.Interval | ir.Choices) -> str:
    if isinstance(domain, ir.Choices):
        return "{" + ", ".join(_number(value) for value in domain.values) + "}"
    return f"[{_number(domain.lower)}, {_number(domain.upper)}]"


def _number(expression: ir.Expr) -> str:
    value = exact_rational(expression)
    if value is not None:
        return number_text(value)
    return f"{float(rational_bounds(expression)[0]):.6g}"
