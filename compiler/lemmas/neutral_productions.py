"""Productions without which a robot has all the poses that it has with them, and perhaps more.

Both kinds have one nonterminal on the right side, the same as on the left side, and terminals on
one side of it. They pass on every attribute that some emission depends on.

- *Removable*: they emit nothing and pass on frames with rotations and translations that can all
  vanish at once, for coordinates and rates that may be zero and for suitable parameters. With these
  joints held there, the robot is the one without them.
- *Transparent*: they pass on frames unchanged and emit no effector. They may emit bodies: the
  effectors and the other bodies of the robot are where they are without them.

Source: the hypothesis of Theorem 1, reversed: errata, row 4.9.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.exact_numbers import Bounds, rational_bounds
from compiler.neutral_modules.neutral_parameters import inlined
from compiler.robots.evaluation_order import UsefulAttributes, useful_attributes
from grammar_lang import ir
from grammar_lang.ir.expressions import children

Step: TypeAlias = ir.Rot | ir.Move
EVERYTHING: Bounds = (Fraction(-(10**30)), Fraction(10**30))
"""Stands for the range of a coordinate without one."""


@dataclass(frozen=True, slots=True)
class NeutralProductions:
    """The numbers of the productions that are removable, and of those that are transparent."""

    removable: frozenset[int]
    transparent: frozenset[int]

    @property
    def none(self) -> bool:
        """Whether there are no such productions."""
        return not (self.removable or self.transparent)


def neutral_productions(program: ir.Program, grammar: ir.Grammar) -> NeutralProductions:
    """The productions recognised as removable or transparent; none without semantics."""
    blocks = grammar.semantics or {}
    useful = useful_attributes(grammar.productions, blocks)
    removable, transparent = set[int](), set[int]()
    for number, production in enumerate(grammar.productions):
        place = spine(production)
        if place is None or production.label not in blocks:
            continue
        block = inlined(blocks[production.label])
        neutral = _Production(program.modules, production, block, place, useful)
        if neutral.copies():
            transparent.add(number)
        elif neutral.can_be_nothing():
            removable.add(number)
    return NeutralProductions(frozenset(removable), frozenset(transparent))


def spine(production: ir.Production) -> int | None:
    """The position of the one nonterminal in ``A -> A y`` or ``A -> x A``; None for others."""
    inner = [i for i, symbol in enumerate(production.right) if symbol.kind == "nonterminal"]
    if len(inner) != 1 or len(production.right) < 2:
        return None
    (place,) = inner
    at_one_end = place in (0, len(production.right) - 1)
    return place if at_one_end and production.right[place].name == production.left else None


@dataclass(frozen=True, slots=True)
class _Production:
    modules: Mapping[str, ir.Module]
    production: ir.Production
    block: ir.SemanticBlock
    place: int
    useful: UsefulAttributes

    def copies(self) -> bool:
        """Whether it is transparent."""
        if any(isinstance(emission, ir.Effector) for emission in self.block.emissions):
            return False
        return all(value == source for source, value in self._handed_on())

    def can_be_nothing(self) -> bool:
        """Whether it is removable."""
        if self.block.emissions:
            return False
        uses = Counter(self._variables())
        return all(
            value == source or self._vanishes(source, value, uses)
            for source, value in self._handed_on()
        )

    def _handed_on(self) -> Iterator[tuple[ir.AttributeOf, ir.Expr | None]]:
        """For each attribute to define, its value without the production, and its rule."""
        rules = {rule.target: rule.value for rule in self.block.rules}
        for due in self.useful.due(self.production):
            upwards = due.occurrence == ir.THIS
            source = ir.AttributeOf(self.place if upwards else ir.THIS, due.name)
            yield source, rules.get(due)

    def _vanishes(
        self, source: ir.AttributeOf, value: ir.Expr | None, uses: Mapping[ir.Expr, int]
    ) -> bool:
        """Whether a frame equals ``source`` for some coordinates and parameters."""
        if value is None:
            return False
        factors = [f for f in ir.factors(value) if not isinstance(f, ir.World)]
        if factors.count(source) != 1:
            return False
        at = factors.index(source)
        for part in (factors[:at], factors[at + 1 :]):
            steps = [step for step in part if isinstance(step, ir.Rot | ir.Move)]
            if len(steps) < len(part):
                return False
            if not all(self._can_be_zero(run, uses) for run in _runs(steps)):
                return False
        return True

    def _can_be_zero(self, run: Sequence[Step], uses: Mapping[ir.Expr, int]) -> bool:
        """Whether rotations about one axis, or translations along one, can add up to zero.

        Variables that are also used elsewhere must be zero; the sum of the others must be zero.
        """
        low = high = Fraction(0)
        for step in run:
            term = step.angle if isinstance(step, ir.Rot) else step.distance
            bounds = self._values(term)
            if bounds is None:
                return False
            if uses.get(term, 0) > 1:
                if not bounds[0] <= 0 <= bounds[1]:
                    return False
                bounds = (Fraction(0), Fraction(0))
            if step.axis.startswith("-"):
                bounds = -bounds[1], -bounds[0]
            low, high = low + bounds[0], high + bounds[1]
        return low <= 0 <= high

    def _values(self, term: ir.Expr) -> Bounds | None:
        """Numbers between which a term takes all values, or a number; None if nothing is known.

        The coordinates of a joint whose rate may not be zero cannot be held.
        """
        match term:
            case ir.DofOf(occurrence, name):
                module = self.modules[self.production.right[occurrence].name]
                (dof,) = (each for each in module.dofs if each.name == name)
                rate = None if dof.rate is None else _inner(dof.rate)
                if dof.rate is not None and (rate is None or not rate[0] <= 0 <= rate[1]):
                    return None
                return EVERYTHING if dof.range is None else _inner(dof.range)
            case ir.ParameterOf(occurrence, name):
                module = self.modules[self.production.right[occurrence].name]
                (parameter,) = (each for each in module.parameters if each.name == name)
                if isinstance(parameter.domain, ir.Choices):
                    zero = ir.Num(Fraction(0)) in parameter.domain.values
                    return (Fraction(0), Fraction(0)) if zero else None
                return _inner(parameter.domain)
            case ir.AttributeOf():
                return None
            case _:
                return _closed(term)

    def _variables(self) -> Iterator[ir.Expr]:
        """Every mention of a coordinate or a parameter in the block."""
        todo: list[ir.Expr] = [rule.value for rule in self.block.rules]
        while todo:
            expression = todo.pop()
            if isinstance(expression, ir.DofOf | ir.ParameterOf):
                yield expression
            todo += children(expression)


def _closed(term: ir.Expr) -> Bounds | None:
    """Bounds of a number in reverse order, which is the safe order for sums that must reach zero.

    If a sum with such bounds contains zero, the sum of the numbers certainly can be zero. None if
    the term is not closed.
    """
    try:
        low, high = rational_bounds(term)
    except ValueError:
        return None
    return high, low


def _inner(interval: ir.Interval) -> Bounds | None:
    """Rationals within an interval, as far apart as known; None if there are none."""
    low, high = rational_bounds(interval.lower)[1], rational_bounds(interval.upper)[0]
    return (low, high) if low <= high else None


def _runs(steps: Sequence[Step]) -> Iterator[list[Step]]:
    """Runs of adjacent steps of one kind about or along one axis."""
    run: list[Step] = []
    for step in steps:
        if run and (type(run[0]), run[0].axis[-1]) != (type(step), step.axis[-1]):
            yield run
            run = []
        run.append(step)
    if run:
        yield run
