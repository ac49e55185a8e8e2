"""Productions without which a robot has the poses that it has with them, and some others.

Both kinds have one nonterminal on the right side, that of the left side, and terminals on one side
of it.  Every attribute that some emission depends on is handed on.

- *Removable*: nothing is emitted, and frames are handed on with turns and moves about or along the
  axes that can all be nothing at once, by coordinates and rates that may be zero and by parameters.
  With such joints held there, the robot is the one without them.
- *Transparent*: frames are handed on as they are, and no effector is emitted.  Bodies may be: the
  effectors and the other bodies of the robot are where they are without.

Source: the hypothesis of Theorem 1, turned round: errata, row 4.9.
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
"""For a coordinate without a range."""


@dataclass(frozen=True, slots=True)
class NeutralProductions:
    """By number the productions of a grammar that are removable, and those that are transparent."""

    removable: frozenset[int]
    transparent: frozenset[int]

    @property
    def none(self) -> bool:
        """Whether there are neither."""
        return not (self.removable or self.transparent)


def neutral_productions(program: ir.Program, grammar: ir.Grammar) -> NeutralProductions:
    """What is seen to be removable or transparent; a grammar without semantics has nothing."""
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
    """Where ``A -> A y`` or ``A -> x A`` has its one nonterminal; None for other productions."""
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
        """For each attribute that is due what it would be without the production, and its rule."""
        rules = {rule.target: rule.value for rule in self.block.rules}
        for due in self.useful.due(self.production):
            upwards = due.occurrence == ir.THIS
            source = ir.AttributeOf(self.place if upwards else ir.THIS, due.name)
            yield source, rules.get(due)

    def _vanishes(
        self, source: ir.AttributeOf, value: ir.Expr | None, uses: Mapping[ir.Expr, int]
    ) -> bool:
        """Whether a frame is ``source`` for some coordinates and parameters."""
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
        """Whether turns about one axis, or moves along one, can add up to nothing.

        What is used elsewhere, too, has to be zero; a sum of the others has to be.
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
        """Numbers all between which a term surely takes, or a number; None: nothing is seen.

        The coordinates of a joint whose rate may not be zero are never held.
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
    """A number, as if it were as far from every other one as is seen: bounds the wrong way round.

    Sums with it surely are zero where the sums of the bounds are.  None where it is not closed.
    """
    try:
        low, high = rational_bounds(term)
    except ValueError:
        return None
    return high, low


def _inner(interval: ir.Interval) -> Bounds | None:
    """Rationals within an interval, as far apart as is seen; None if there are none."""
    low, high = rational_bounds(interval.lower)[1], rational_bounds(interval.upper)[0]
    return (low, high) if low <= high else None


def _runs(steps: Sequence[Step]) -> Iterator[list[Step]]:
    """Neighbouring steps of one kind about or along one axis."""
    run: list[Step] = []
    for step in steps:
        if run and (type(run[0]), run[0].axis[-1]) != (type(step), step.axis[-1]):
            yield run
            run = []
        run.append(step)
    if run:
        yield run
