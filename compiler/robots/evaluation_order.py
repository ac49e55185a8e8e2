"""The order in which the attributes of a grammar are evaluated, fixed once for all derivations.

Source: K. Kennedy and S. K. Warren, "Automatic generation of efficient evaluators for attribute
grammars", POPL 1976. A node of a derivation is visited one or more times; each visit gives it some
of its inherited attributes and obtains the synthesized ones that depend on no others. The work of a
visit is a *plan*: rules to evaluate and children to visit, in order. A plan depends on the
production and on the inherited attributes given so far, and on nothing else in the derivation.

The method succeeds for exactly the absolutely noncircular grammars, which are those that the check
of a file accepts. As each visit of a child gives or obtains something new, the number of visits of
a node is at most one more than the number of attributes of its nonterminal, and evaluation is
linear in the size of the derivation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from heapq import heapify, heappop, heappush
from typing import TypeAlias

from compiler.robots.frame_table import SemanticsError
from grammar_lang import ir
from grammar_lang.elaboration.circularity import induced, reads

Given: TypeAlias = tuple[frozenset[str], ...]
"""The inherited attributes that the visits of a node have given it so far, visit by visit."""


@dataclass(frozen=True, slots=True)
class Visit:
    """A visit of the child at a position; the last of ``given`` is what this visit gives."""

    position: int
    given: Given


EvaluationStep: TypeAlias = ir.AttributeRule | Visit
Plan: TypeAlias = tuple[EvaluationStep, ...]


@dataclass(slots=True)
class EvaluationOrder:
    """The plans of one grammar. Each plan is made when it is first asked for, and then kept.

    Only attributes that some emission needs are evaluated, and those that visuals need if
    ``visuals`` is set. Productions without a block are left out.
    """

    productions: Sequence[ir.Production]
    blocks: Mapping[str, ir.SemanticBlock]
    visuals: bool = False
    useful: UsefulAttributes = field(init=False)
    _by_label: dict[str, ir.Production] = field(init=False)
    _needs: dict[str, dict[str, frozenset[str]]] = field(init=False)
    _done: dict[tuple[str, Given], _Progress] = field(init=False)

    def __post_init__(self) -> None:
        known = [p for p in self.productions if p.label in self.blocks]
        self.useful = useful_attributes(known, self.blocks, visuals=self.visuals)
        self._by_label = {production.label: production for production in known}
        self._done = {}
        needs: dict[str, dict[str, set[str]]] = {
            nonterminal: {name: set() for name in names}
            for nonterminal, names in self.useful.synthesized.items()
        }
        for nonterminal, pairs in induced(known, self.blocks).items():
            for before, after in pairs:
                if after in needs.get(nonterminal, {}):
                    needs[nonterminal][after].add(before)
        self._needs = {
            nonterminal: {name: frozenset(each) for name, each in names.items()}
            for nonterminal, names in needs.items()
        }

    def first(self, label: str) -> Given:
        """The visits of a root with this production: one, which gives it all it inherits."""
        return (self._inherited(self._production(label).left),)

    def plan(self, label: str, given: Given) -> Plan:
        """The plan of the last of the ``given`` visits to a node with this production.

        Raises:
            SemanticsError: an attribute has no rule or depends on itself, or there is no block.
        """
        return self._after(label, given).plan

    def _after(self, label: str, given: Given) -> _Progress:
        key = (label, given)
        if key not in self._done:
            before = self._after(label, given[:-1]) if given else self._begin(label)
            self._done[key] = self._continue(self._production(label), before, given)
        return self._done[key]

    def _production(self, label: str) -> ir.Production:
        if label not in self._by_label:
            raise SemanticsError(f"production `{label}` has no semantics")
        return self._by_label[label]

    def _inherited(self, nonterminal: str) -> frozenset[str]:
        return frozenset(self.useful.inherited.get(nonterminal, ()))

    # --- plans ------------------------------------------------------------------------------------

    def _begin(self, label: str) -> _Progress:
        """The progress before any rule is evaluated and any child is visited."""
        production = self._production(label)
        rules = self.useful.rules(production, self.blocks[label])
        defined = {rule.target for rule in rules}
        for target in self.useful.due(production):
            if target not in defined:
                nonterminal = owner(production, target)
                raise SemanticsError(f"attribute `{target.name}` of `{nonterminal}` has no rule")
        inner = [i for i, symbol in enumerate(production.right) if symbol.kind == "nonterminal"]
        return _Progress(
            (), rules, frozenset(), frozenset(range(len(rules))), dict.fromkeys(inner, ())
        )

    def _continue(self, production: ir.Production, before: _Progress, given: Given) -> _Progress:
        """The progress after doing all that the newly given attributes allow."""
        work = _Work(before)
        if given:
            work.learn(ir.AttributeOf(ir.THIS, name) for name in sorted(given[-1]))
            work.evaluate()
            while (visit := self._due(production, work)) is not None:
                work.children[visit.position] = visit.given
                work.steps.append(visit)
                work.learn(self._obtained(production, visit))
                work.evaluate()
        after = work.progress()
        if given:
            self._check_circle(production, after, frozenset().union(*given))
        return after

    def _due(self, production: ir.Production, work: _Work) -> Visit | None:
        """The next child to visit: the first that needs no later visit, else the first useful one.

        A visit that is not the last one must obtain something.
        """
        found: Visit | None = None
        for position, given in work.children.items():
            everything = self._inherited(production.right[position].name)
            so_far: frozenset[str] = frozenset().union(*given)
            if given and so_far == everything:
                continue
            now = frozenset(n for n in everything if ir.AttributeOf(position, n) in work.known)
            visit = Visit(position, (*given, now - so_far))
            if now == everything:
                return visit
            if found is None and any(self._obtained(production, visit)):
                found = visit
        return found

    def _obtained(self, production: ir.Production, visit: Visit) -> Iterator[ir.AttributeOf]:
        """The attributes of its child that a visit makes known."""
        known: frozenset[str] = frozenset().union(*visit.given)
        before: frozenset[str] = frozenset().union(*visit.given[:-1])
        for name, needed in self._needs.get(production.right[visit.position].name, {}).items():
            if needed <= known and (len(visit.given) == 1 or not needed <= before):
                yield ir.AttributeOf(visit.position, name)

    def _check_circle(
        self, production: ir.Production, after: _Progress, given: frozenset[str]
    ) -> None:
        """Report attributes that depend only on given attributes but could not be evaluated."""
        left = [after.rules[number].target for number in sorted(after.waiting)]
        if given != self._inherited(production.left):
            needs = self._needs.get(production.left, {})
            left = [t for t in left if t.occurrence == ir.THIS and needs[t.name] <= given]
        if left:
            message = f"attribute `{left[0].name}` depends on itself"
            raise SemanticsError(f"{message}, in production `{production.label}`")


@dataclass(frozen=True, slots=True)
class _Progress:
    """The work done at a node after some visits, and the ``plan`` of the last one.

    ``waiting`` holds the numbers of the ``rules`` that are not evaluated yet, ``children`` the
    visits of each child so far.
    """

    plan: Plan
    rules: tuple[ir.AttributeRule, ...]
    known: frozenset[ir.AttributeOf]
    waiting: frozenset[int]
    children: Mapping[int, Given]


class _Work:
    """A plan being made: evaluates rules, in order, once the attributes they read are known."""

    def __init__(self, before: _Progress) -> None:
        self.rules = before.rules
        self.known = set(before.known)
        self.children = dict(before.children)
        self.steps: list[EvaluationStep] = []
        self._missing: dict[int, set[ir.AttributeOf]] = {}
        self._readers: dict[ir.AttributeOf, list[int]] = {}
        for number in sorted(before.waiting):
            missing = {each for each in reads(self.rules[number].value) if each not in self.known}
            self._missing[number] = missing
            for each in missing:
                self._readers.setdefault(each, []).append(number)
        self._ready = [number for number, missing in self._missing.items() if not missing]
        heapify(self._ready)

    def learn(self, attributes: Iterator[ir.AttributeOf]) -> None:
        """Mark these attributes as known."""
        for attribute in attributes:
            if attribute in self.known:
                continue
            self.known.add(attribute)
            for number in self._readers.get(attribute, ()):
                self._missing[number].discard(attribute)
                if not self._missing[number]:
                    heappush(self._ready, number)

    def evaluate(self) -> None:
        """Evaluate every rule that is ready."""
        while self._ready:
            number = heappop(self._ready)
            del self._missing[number]
            self.steps.append(self.rules[number])
            self.learn(iter((self.rules[number].target,)))

    def progress(self) -> _Progress:
        """The work done so far."""
        return _Progress(
            tuple(self.steps),
            self.rules,
            frozenset(self.known),
            frozenset(self._missing),
            self.children,
        )


# --- Which attributes of a grammar some emission reads, directly or through other attributes ------


Key: TypeAlias = tuple[str, str]
"""A nonterminal and the name of one of its attributes."""


@dataclass(frozen=True, slots=True)
class UsefulAttributes:
    """For each nonterminal the names of its useful attributes, in order of discovery."""

    synthesized: Mapping[str, tuple[str, ...]]
    inherited: Mapping[str, tuple[str, ...]]

    def rules(
        self, production: ir.Production, block: ir.SemanticBlock
    ) -> tuple[ir.AttributeRule, ...]:
        """The rules of a block that define useful attributes, in their order."""
        return tuple(rule for rule in block.rules if self._defines(production, rule.target))

    def due(self, production: ir.Production) -> Iterator[ir.AttributeOf]:
        """The useful attributes that the block of a production must define."""
        for name in self.synthesized.get(production.left, ()):
            yield ir.AttributeOf(ir.THIS, name)
        for position, symbol in enumerate(production.right):
            if symbol.kind == "nonterminal":
                for name in self.inherited.get(symbol.name, ()):
                    yield ir.AttributeOf(position, name)

    def _defines(self, production: ir.Production, target: ir.AttributeOf) -> bool:
        kind = self.synthesized if target.occurrence == ir.THIS else self.inherited
        return target.name in kind.get(owner(production, target), ())


def owner(production: ir.Production, attribute: ir.AttributeOf) -> str:
    """The nonterminal whose attribute a production names; for a local value the production."""
    if attribute.occurrence == ir.THIS:
        return production.left
    if attribute.occurrence == ir.LOCAL:
        return f"production {production.label}"
    return production.right[attribute.occurrence].name


def expressions(emission: ir.Emission) -> tuple[ir.Expr, ...]:
    """The expressions in an emission."""
    match emission:
        case ir.Rod(frame, _, length, density, radius):
            return (frame, length, density) if radius is None else (frame, length, density, radius)
        case ir.PointMass(frame, mass):
            return (frame, mass)
        case ir.Solid(frame, mass, com, inertia):
            return (frame, mass, com, *inertia)
        case ir.Shape(_, frame, _, sizes):
            return (frame, *sizes)
        case ir.Effector(frame):
            return (frame,)


def useful_attributes(
    productions: Iterable[ir.Production],
    blocks: Mapping[str, ir.SemanticBlock],
    *,
    visuals: bool = False,
) -> UsefulAttributes:
    """The attributes that emissions need in some derivation; the others are never evaluated.

    With ``visuals``, the attributes that visuals need are included.

    An attribute is inherited if no production of its nonterminal defines it for ``this``.
    """
    synthesized: set[Key] = set()
    needs: dict[tuple[bool, Key], dict[Key, None]] = {}
    todo: list[Key] = []
    for production in productions:
        if production.label not in blocks:
            continue
        block = blocks[production.label]
        for rule in block.rules:
            here = rule.target.occurrence == ir.THIS
            key = owner(production, rule.target), rule.target.name
            if here:
                synthesized.add(key)
            read = needs.setdefault((here, key), {})
            read |= {(owner(production, each), each.name): None for each in reads(rule.value)}
        emitted = [expr for emission in block.emissions for expr in expressions(emission)]
        emitted += [visual.frame for visual in block.visuals] if visuals else []
        for expression in emitted:
            todo += [(owner(production, each), each.name) for each in reads(expression)]
    found: dict[Key, None] = {}
    while todo:
        key = todo.pop()
        if key not in found:
            found[key] = None
            todo += needs.get((key in synthesized, key), ())
    return UsefulAttributes(
        _by_nonterminal(key for key in found if key in synthesized),
        _by_nonterminal(key for key in found if key not in synthesized),
    )


def _by_nonterminal(keys: Iterable[Key]) -> dict[str, tuple[str, ...]]:
    names: dict[str, list[str]] = {}
    for nonterminal, name in keys:
        names.setdefault(nonterminal, []).append(name)
    return {nonterminal: tuple(each) for nonterminal, each in names.items()}
