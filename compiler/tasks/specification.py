"""What a task asks: of motions, as one formula, and of paths through the cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import assert_never

from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_inputs
from compiler.tasks.carrying import carried_on_samples
from compiler.tasks.sampled_formula import (
    Literal,
    SampledFormula,
    is_timed,
    nodes,
    sampled,
)
from compiler.tasks.word_formula import every
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from grammar_lang.ir import StartAt, StartIn, Task
from grammar_lang.ir.formula_parts import atoms

# --- The one formula of a task: its ``satisfy`` clauses, with ``reach`` and ``avoid`` as sugar ----


_THROUGHOUT = ir.Window(Fraction(0), None)


def task_formula(task: ir.Task, effectors: int, recorded: int) -> ir.Formula | None:
    """What the effectors of a robot have to satisfy at time 0; None for no demand at all.

    A margin of an ``avoid`` is not expressed: the formula asks for less than the task then.

    Args:
        task: the task.
        effectors: how many effectors the robot has.
        recorded: the effector that starts and reaches, from 0.
    """
    parts = [clause.formula for clause in task.demanded]
    if task.reach is not None:
        if task.repeat:
            there = ir.Atom(task.reach.region, recorded + 1, poses=task.reach.poses)
            parts.append(ir.Eventually(there, _THROUGHOUT))
        else:
            parts.append(_stay(task, task.reach, recorded))
    parts += [
        ir.Always(ir.Not(ir.Atom(region, effector)), _THROUGHOUT)
        for avoid in task.avoid
        if avoid.subject == "effector"
        for region in avoid.regions
        for effector in range(1, effectors + 1)
    ]
    if len(parts) < 2:
        return parts[0] if parts else None
    return ir.And(tuple(parts))


def _stay(task: ir.Task, reach: ir.Reach, recorded: int) -> ir.Formula:
    """The effector, from 0, is in the target at the end, and as long before as the task says."""
    return ir.Last(task.stay, ir.Atom(reach.region, recorded + 1))


def path_formulas(task: ir.Task, recorded: int) -> tuple[ir.Formula, ...]:
    """What paths through cells have to satisfy besides their ends; ``recorded`` reaches, from 0."""
    formulas = tuple(clause.formula for clause in task.satisfy)
    if task.reach is None or not task.stay:
        return formulas
    return (*formulas, _stay(task, task.reach, recorded))


def recorded_effector(task: ir.Task) -> int | None:
    """The effector that a task binds to be the recorded one, from 0; None: any, the claim says.

    It is the one that reaches; where nothing is to be reached, the one that starts.
    """
    if task.reach is not None:
        named = task.reach.effector
    elif isinstance(task.start, ir.StartAt):
        named = 1
    else:
        named = task.start.effector
    return None if named is None else named - 1


def missing_effector(task: ir.Task, effectors: int) -> int | None:
    """An effector, from 1, that a task names and a robot with so many lacks; None for none.

    Such a robot is no candidate, whatever is asked of the effector.
    """
    named = [atom.effector for atom in atoms(*(clause.formula for clause in task.demanded))]
    if task.reach is not None and task.reach.effector is not None:
        named.append(task.reach.effector)
    if isinstance(task.start, ir.StartIn) and task.start.effector is not None:
        named.append(task.start.effector)
    return max((number for number in named if number > effectors), default=None)


# --- What a task asks of paths through the cells --------------------------------------------------
#
# Source: Section 4.2 (the set of runs from the initial region to the target that avoid obstacles),
# with correction 4.18: ``reach`` is about the last instant only, the target may be entered early;
# ``satisfy`` as a formula about samples (:mod:`compiler.tasks.sampled_formula`).


@dataclass(frozen=True, slots=True)
class PlannedEffector:
    """Where one effector (from 0) may begin, be and end; ascending indices of cells.

    ``start`` and ``end`` may contain forbidden cells, which win; ``end`` None: anywhere.
    """

    effector: int
    start: tuple[int, ...]
    forbidden: tuple[int, ...] = ()
    end: tuple[int, ...] | None = None


@dataclass(frozen=True, slots=True)
class PlanningProblem:
    """Find paths of adjacent cells for some effectors.

    Attributes:
        neighbours: per cell its neighbours, ascending.
        propositions: per cell the regions that it lies in.
        effectors: those that are planned, by ascending number.
        formula: what the paths satisfy together, or None.
        timed: whether it matters at which samples cells are entered.
        steps: the last sample; a path has at most so many changes of cell.
        changes: the bound on the changes of all paths together.
        settled: the last sample at which a cell is entered, None: any; where it is timed.
        names: per cell its name, for people; none: cells go by their numbers.
    """

    neighbours: tuple[tuple[int, ...], ...]
    propositions: tuple[frozenset[str], ...]
    effectors: tuple[PlannedEffector, ...]
    formula: SampledFormula | None
    timed: bool
    steps: int
    changes: int
    names: tuple[str, ...] = ()
    settled: int | None = None

    @property
    def by_samples(self) -> bool:
        """Whether paths are words over the samples; else over the changes of one effector."""
        return self.timed or len(self.effectors) > 1

    def name(self, cell: int) -> str:
        """What a cell is called."""
        return self.names[cell] if self.names else f"cell {cell}"


def planning_problem(
    abstraction: Abstraction,
    task: Task,
    effector: int,
    start_cells: Mapping[int, Sequence[int]] | None = None,
) -> PlanningProblem:
    """The path problem of a task.

    Cells inside a region that ``avoid ... with effector`` names are forbidden.  ``with body`` does
    not bind the effector's own point, and a margin does not either: they are left to the control
    synthesis and the proof, so that the path problem has every path a robot can follow.

    Args:
        abstraction: the cells of the task's workspace.
        task: the task.
        effector: the recorded effector, from 0; those that atoms name are planned as well.
        start_cells: by effector (from 0) the cells to start in, where they depend on the robot;
            an effector that is not named, nor starts in a region, may start anywhere.
    """
    clauses = path_formulas(task, effector)
    asked = [sampled(_conjunction(clauses), task.step, task.steps)] if clauses else []
    asked += carried_on_samples(task)
    formula = every(asked) if asked else None
    known = {} if start_cells is None else start_cells
    planned = {effector} | (set() if formula is None else _named(formula))
    forbidden = abstraction.within(_avoided(task))
    end = None if task.reach is None else abstraction.within([task.reach.region])
    timed = any(map(is_timed, clauses)) or _meeting(abstraction, task)
    several = timed or len(planned) > 1
    return PlanningProblem(
        abstraction.neighbours,
        tuple(cell.propositions for cell in abstraction.cells),
        tuple(
            PlannedEffector(
                number,
                tuple(sorted(set(known[number])))
                if number in known
                else _start(abstraction, task, effector, number),
                forbidden,
                end if number == effector else None,
            )
            for number in sorted(planned)
        ),
        formula,
        timed,
        task.steps,
        task.steps * len(planned) if several else task.steps,
        tuple(cell.name for cell in abstraction.cells),
    )


def _start(abstraction: Abstraction, task: Task, recorded: int, number: int) -> tuple[int, ...]:
    match task.start:
        case StartIn(region=region, effector=named):
            starting = recorded if named is None else named - 1
            if number == starting:
                return abstraction.within([region])
            return tuple(range(len(abstraction.cells)))
        case StartAt():
            return tuple(range(len(abstraction.cells)))
        case _:
            assert_never(task.start)


def _meeting(abstraction: Abstraction, task: Task) -> bool:
    """Whether a load may be put down in the cell in which it is taken up."""
    pairs = ((abstraction.within([c.source]), abstraction.within([c.target])) for c in task.carries)
    return any(set(source) & set(target) for source, target in pairs)


def _avoided(task: Task) -> list[str]:
    return [name for avoid in task.avoid if avoid.subject == "effector" for name in avoid.regions]


def _conjunction(formulas: Sequence[ir.Formula]) -> ir.Formula:
    return formulas[0] if len(formulas) == 1 else ir.And(tuple(formulas))


def _named(formula: SampledFormula) -> set[int]:
    """The effectors, from 0, that a formula names."""
    return {node.effector - 1 for node in nodes(formula) if isinstance(node, Literal)}


# --- What `robust` clauses say, by coordinate, rate and input -------------------------------------


def joint_radii(radii: ir.Radii, model: RobotModel) -> list[Fraction]:
    """Per joint's coordinate, then per rate, the radius that is due to its kind, in SI."""
    turning = [dof.kind == "revolute" for dof in model.dofs]
    places = [radii.angle if turns else radii.length for turns in turning]
    return places + [radii.angular_rate if turns else radii.speed for turns in turning]


def disturbance_radii(task: ir.Task, model: RobotModel) -> list[Fraction]:
    """Per joint's coordinate, then per rate, how far its start may be from the planned, in SI."""
    return joint_radii((task.robust or ir.Robust()).start, model)


def measurement_radii(task: ir.Task, model: RobotModel) -> list[Fraction]:
    """Per joint's coordinate, then per rate, how far off it is measured at most, in SI."""
    return joint_radii((task.robust or ir.Robust()).measured, model)


@dataclass(frozen=True, slots=True)
class UncertainMass:
    """Bodies of a robot, by number, whose masses are times one constant within 1 +- ``part``."""

    part: Fraction
    bodies: tuple[int, ...]


def uncertain_masses(task: ir.Task, model: RobotModel) -> tuple[UncertainMass, ...]:
    """The constants by which masses may be off: of all bodies, per occurrence, and per load.

    Raises:
        ValueError: the task asks whose the bodies are, and the model does not say it of all.
    """
    robust = task.robust or ir.Robust()
    found = list[UncertainMass]()
    if robust.mass and model.bodies:
        found.append(UncertainMass(robust.mass, tuple(range(len(model.bodies)))))
    if robust.masses and len(model.owners) != len(model.bodies):
        raise ValueError("the owners of the bodies are not known")
    for clause in robust.masses:
        bodies: dict[int, list[int]] = {}
        for body, owner in enumerate(model.owners):
            if owner is not None and owner.module == clause.module:
                bodies.setdefault(owner.symbol, []).append(body)
        found += [UncertainMass(clause.part, tuple(own)) for _, own in sorted(bodies.items())]
    if robust.payload:
        found += [UncertainMass(robust.payload, (body,)) for body in model.payloads]
    return tuple(found)


def input_errors(
    task: ir.Task, model: RobotModel
) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
    """How far inputs may be from what is commanded: the part of themselves, and what comes on top.

    Both have one value per input (m,), the second, a part of its bound, in its unit.  Loads are
    there, or not.
    """
    robust, inputs = task.robust or ir.Robust(), robot_inputs(model)
    parts = tuple(Fraction(0) if item.is_load else robust.effort for item in inputs)
    most = [Fraction(0)] * len(inputs)
    for bound in input_bounds(model, task):
        size = max(abs(bound.lower), abs(bound.upper))
        for place in bound.inputs:
            most[place] = max(most[place], robust.effort_of_bound * size)
    return parts, tuple(most)
