"""The demands of a task on every motion whatever the robot, clause by clause, for a SAT solver.

These are the demands of ``satisfy``, ``start in``, ``reach`` and ``avoid … with effector``; nothing
is assumed about anything else, nor about the robot itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final, TypeAlias

from compiler.robots.effector_counts import several_effectors
from compiler.tasks.endless_slots import EndlessSlots
from compiler.tasks.formula_slots import Slots, common_step
from compiler.tasks.region_signatures import region_signatures
from compiler.tasks.region_slots import Clause, Node, TooManySlotsError
from compiler.workspaces.polytope import Polytope, polytope_of, refuting_polytope
from grammar_lang import ir
from grammar_lang.ir.formula_parts import operands, subformulas
from grammar_lang.source import Span

Temporal: TypeAlias = ir.Until | ir.Always | ir.Eventually | ir.Next | ir.Last

SLOT_LIMIT = 1000
SIGNATURE_LIMIT = 64
AT_ANY_TIME: Final = ir.Window(Fraction(0), None)
SOME_EFFECTOR = 0
"""The number of the recorded effector if a task for several effectors names none."""


@dataclass(frozen=True, slots=True)
class NecessaryCondition:
    """A clause of a task, or a conjunct of a formula: the clauses hold if ``selector`` is true.

    ``formula`` is the number of its ``satisfy`` in the task; ``text`` states the demand.
    """

    selector: int
    span: Span
    text: str
    formula: int | None = None


@dataclass(frozen=True, slots=True)
class NecessaryConditions:
    """The demands of a task; a motion can meet them only if the clauses are satisfiable."""

    clauses: tuple[Clause, ...]
    demands: tuple[NecessaryCondition, ...]
    _writer: ConditionWriter

    def denial(self, formula: ir.Formula) -> tuple[NecessaryCondition, tuple[Clause, ...]]:
        """The demand that a formula over the atoms of the task does not hold, and its clauses.

        Only clauses that no other call has returned are returned.

        Raises:
            TooManySlotsError: there would be too many of them.
        """
        return self._writer.denial(formula)


def conjuncts(formula: ir.Formula) -> Iterator[ir.Formula]:
    """The parts of a conjunction and of conjunctions in it, as written; else the formula itself."""
    stack = [formula]
    while stack:
        node = stack.pop()
        if isinstance(node, ir.And):
            stack.extend(reversed(node.operands))
        else:
            yield node


@dataclass(frozen=True, slots=True)
class _Grid:
    """The cuts in time: ``count`` steps, in seconds; a motion may go on after them for ever."""

    step: Fraction
    count: int
    endless: bool

    def slots(self, signatures: Sequence[int], effectors: Sequence[int]) -> Slots:
        kind = EndlessSlots if self.endless else Slots
        return kind(self.count, signatures, effectors)


def _grid(task: ir.Task) -> _Grid | None:
    """The horizon, cut at all times in formulas; if endless, as far as formulas look ahead.

    None if there are too many steps.
    """
    if task.repeat:
        step = common_step(list(_named_times(task)) or [task.step])
        ahead = max((_look_ahead(each.formula, task.step) for each in task.demanded), default=step)
        count = int(ahead / step) + 1
    else:
        total = task.steps * task.step
        step = common_step([total, *(time for time in _named_times(task) if time < total)])
        count = int(total / step)
    return None if count > SLOT_LIMIT else _Grid(step, count, task.repeat)


def _named_times(task: ir.Task) -> Iterator[Fraction]:
    """The times that formulas name."""
    for clause in task.demanded:
        for node in subformulas(clause.formula):
            match node:
                case ir.Always(window=window) | ir.Eventually(window=window):
                    found = [window.lower, window.upper or Fraction(0)]
                case ir.Last(duration=duration):
                    found = [duration]
                case ir.Next():
                    found = [task.step]
                case _:
                    continue
            yield from (time for time in found if time > 0)


def _look_ahead(formula: ir.Formula, step: Fraction) -> Fraction:
    """How far ahead a formula looks at most, ignoring windows without an end, in seconds."""
    own = Fraction(0)
    match formula:
        case ir.Always(window=window) | ir.Eventually(window=window):
            own = window.lower if window.upper is None else window.upper
        case ir.Next():
            own = step
        case _:
            pass
    return own + max((_look_ahead(part, step) for part in operands(formula)), default=Fraction(0))


@dataclass(frozen=True, slots=True)
class _Ends:
    """The numbers of the effectors that start and end in a region; None if no region is named."""

    start: int | None
    reach: int | None


def _ends(program: ir.Program, task: ir.Task) -> _Ends:
    """The effectors that start and that reach; ``SOME_EFFECTOR`` if the task leaves it open."""
    recorded = SOME_EFFECTOR if task.reach is None else task.reach.effector or SOME_EFFECTOR
    start = None
    if isinstance(task.start, ir.StartIn):
        start = task.start.effector or recorded
    reach = None if task.reach is None else recorded
    if SOME_EFFECTOR not in (start, reach):
        return _Ends(start, reach)
    if several_effectors(program, program.grammars[task.grammar]) is False:
        start, reach = (1 if number == SOME_EFFECTOR else number for number in (start, reach))
    return _Ends(start, reach)


def _mentioned(task: ir.Task, *, avoided: bool) -> frozenset[str]:
    """The regions in the demands, with or without those that are only avoided."""
    names = {
        node.region
        for clause in task.demanded
        for node in subformulas(clause.formula)
        if isinstance(node, ir.Atom)
    }
    if isinstance(task.start, ir.StartIn):
        names.add(task.start.region)
    if task.reach is not None:
        names.add(task.reach.region)
    if avoided:
        names.update(name for avoid in _avoids(task) for name in avoid.regions)
    return frozenset(names)


def _avoids(task: ir.Task) -> Iterator[ir.Avoid]:
    return (avoid for avoid in task.avoid if avoid.subject == "effector")


@dataclass(frozen=True, slots=True)
class Regions:
    """The regions considered, numbered, and the signatures over these numbers."""

    numbers: Mapping[str, int]
    signatures: tuple[int, ...]


def _regions(workspace: ir.Workspace, names: frozenset[str]) -> Regions | None:
    """The named regions; None if there are too many signatures, or a shape is invalid."""
    bounds = polytope_of(workspace.bounds.shape, workspace.dimension)
    if not bounds.is_bounded or not bounds.has_interior:
        return None
    chosen = [region for region in workspace.regions if region.name in names]
    shapes: list[Polytope] = [refuting_polytope(r.shape, workspace.dimension) for r in chosen]
    if any(shape.is_empty for shape in shapes):
        return None
    signatures = region_signatures(bounds, shapes, SIGNATURE_LIMIT)
    if signatures is None:
        return None
    return Regions({region.name: k for k, region in enumerate(chosen)}, signatures)


@dataclass(slots=True)
class ConditionWriter:
    """Writes the demands of a task as clauses about slots of ``step`` seconds."""

    slots: Slots
    regions: Regions
    task: ir.Task
    step: Fraction
    demands: list[NecessaryCondition] = field(default_factory=list)

    def intervals(self, time: Fraction) -> int:
        """A time in steps, rounded up; at most one more than there are, if it is beyond the end."""
        return min(self.slots.count + 1, -(-time // self.step))

    def required(self, formula: ir.Formula) -> int:
        """A literal that is true only if a formula may hold at time 0."""
        return self.slots.row(self.node(formula)).some[0]

    def atom(self, region: str, effector: int) -> Node:
        """An effector is in a region."""
        return self.slots.region(effector, self.regions.numbers[region])

    def node(self, formula: ir.Formula) -> Node:
        """The subformula of the slots that a formula is."""
        slots = self.slots
        match formula:
            case ir.Atom(region=region, effector=effector, poses=poses):
                there = self.atom(region, effector)
                if not poses:
                    return there
                # Nothing is known about the orientation.
                return slots.conjunction([there, slots.free((effector, poses))])
            case ir.Not(operand=operand):
                return -self.node(operand)
            case ir.And(operands=operands):
                return slots.conjunction([self.node(part) for part in operands])
            case ir.Or(operands=operands):
                return slots.disjunction([self.node(part) for part in operands])
            case ir.Implies(left=left, right=right):
                return slots.disjunction([-self.node(left), self.node(right)])
            case _:
                return self.temporal(formula)

    def temporal(self, formula: Temporal) -> Node:
        """The same for an operator about other times than the present."""
        slots = self.slots
        match formula:
            case ir.Until(left=left, right=right):
                return slots.until(self.node(left), self.node(right))
            case ir.Always(operand=operand, window=window):
                return slots.always(self.node(operand), *self.window(window))
            case ir.Eventually(operand=operand, window=window):
                return slots.eventually(self.node(operand), *self.window(window))
            case ir.Next(operand=operand):
                one = self.intervals(self.task.step)
                return slots.eventually(self.node(operand), one, one)
            case ir.Last(operand=operand, duration=duration):
                return slots.last_part(self.node(operand), self.intervals(duration))

    def window(self, window: ir.Window) -> tuple[int, int]:
        """The ends of a window in steps; beyond the end of the slots if it has no end."""
        last = self.slots.count + 1
        upper = last if window.upper is None else self.intervals(window.upper)
        return self.intervals(window.lower), upper

    def denial(self, formula: ir.Formula) -> tuple[NecessaryCondition, tuple[Clause, ...]]:
        """The demand that a formula does not hold, and the clauses that it adds."""
        before = len(self.slots.clauses)
        self.demand([-self.slots.row(self.node(formula)).some[0]], formula.span, "")
        return self.demands.pop(), tuple(self.slots.clauses[before:])

    def demand(
        self, literals: Iterable[int], span: Span, text: str, formula: int | None = None
    ) -> None:
        """Demand all the literals, provided that a new selector is true."""
        selector = self.slots.variable()
        self.slots.clauses += [(-selector, literal) for literal in literals]
        self.demands.append(NecessaryCondition(selector, span, text, formula))

    def clauses(self, ends: _Ends, effectors: Iterable[int]) -> None:
        """Write all the demands of the task."""
        start, reach, slots = self.task.start, self.task.reach, self.slots
        for number, clause in enumerate(self.task.satisfy):
            for part in conjuncts(clause.formula):
                self.demand([self.required(part)], part.span, "this formula holds", number)
        for carry in self.task.carries:
            text = f"the load comes from `{carry.source}` to `{carry.target}`"
            self.demand([self.required(carry.visits)], carry.span, text)
        if isinstance(start, ir.StartIn) and ends.start is not None:
            literal = slots.row(self.atom(start.region, ends.start)).some[0]
            self.demand([literal], start.span, f"the effector starts in `{start.region}`")
        if reach is not None and ends.reach is not None:
            there = ir.Atom(reach.region, ends.reach)
            if self.task.repeat:
                literal, text = self.required(ir.Eventually(there, AT_ANY_TIME)), "comes to"
            else:
                literal, text = slots.row(self.node(there)).some[-1], "ends in"
            self.demand([literal], reach.span, f"the effector {text} `{reach.region}`")
        for avoid in _avoids(self.task):
            for region in avoid.regions:
                if region in self.regions.numbers:
                    rows = [slots.row(-self.atom(region, effector)) for effector in effectors]
                    literals = [literal for row in rows for literal in row.every]
                    self.demand(literals, avoid.span, f"`{region}` is never entered")


def necessary_conditions(program: ir.Program, task: ir.Task) -> NecessaryConditions | None:
    """The demands of a task between the times that its formulas name; None if they are too large.

    Also None for an endless motion with a last part, which is reported where it is read, and if a
    motion may end at several times.
    """
    if task.at_most and not task.repeat:
        return None
    grid = _grid(task)
    if grid is None or has_no_last_part(task):
        return None

    def writer(regions: Regions, effectors: Sequence[int]) -> ConditionWriter:
        return ConditionWriter(grid.slots(regions.signatures, effectors), regions, task, grid.step)

    return written_conditions(program, task, writer)


def has_no_last_part(task: ir.Task) -> bool:
    """Whether a formula is about the last part of a motion without an end."""
    parts = (node for clause in task.demanded for node in subformulas(clause.formula))
    return task.repeat and any(isinstance(node, ir.Last) for node in parts)


def written_conditions(
    program: ir.Program,
    task: ir.Task,
    writer: Callable[[Regions, Sequence[int]], ConditionWriter],
) -> NecessaryConditions | None:
    """The demands of a task as a writer for some regions and effectors writes them.

    If they are too large with the regions that are only avoided, they are given without these
    regions; None if they are too large even so.
    """
    ends = _ends(program, task)
    named = {
        node.effector
        for clause in task.demanded
        for node in subformulas(clause.formula)
        if isinstance(node, ir.Atom)
    }
    effectors = sorted(
        named | {number for number in (ends.start, ends.reach) if number is not None}
    )
    for avoided in (True, False):
        names = _mentioned(task, avoided=avoided)
        regions = _regions(program.workspaces[task.workspace], names)
        if regions is None:
            continue
        try:
            found = writer(regions, effectors)
            found.clauses(ends, effectors)
        except TooManySlotsError:
            continue
        return NecessaryConditions(tuple(found.slots.clauses), tuple(found.demands), found)
    return None
