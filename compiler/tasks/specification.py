"""The demands of a task: on motions, as one formula, and on paths through the cells."""

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
    """The formula that a robot's effectors must satisfy at time 0; None if nothing is required.

    The margin of an ``avoid`` is not expressed: the formula then demands less than the task.

    Args:
        task: the task.
        effectors: the number of effectors of the robot.
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
    """The formulas of paths through cells, besides their ends; ``recorded`` reaches, from 0."""
    formulas = tuple(clause.formula for clause in task.satisfy)
    if task.reach is None or not task.stay:
        return formulas
    return (*formulas, _stay(task, task.reach, recorded))


def recorded_effector(task: ir.Task) -> int | None:
    """The effector that a task fixes as the recorded one, from 0; None if the claim may choose.

    It is the one that reaches or, if nothing must be reached, the one that starts.
    """
    if task.reach is not None:
        named = task.reach.effector
    elif isinstance(task.start, ir.StartAt):
        named = 1
    else:
        named = task.start.effector
    return None if named is None else named - 1


def missing_effector(task: ir.Task, effectors: int) -> int | None:
    """An effector, from 1, that a task names and a robot with ``effectors`` lacks; None if none.

    Such a robot is not a candidate, whatever is required of the effector.
    """
    named = [atom.effector for atom in atoms(*(clause.formula for clause in task.demanded))]
    if task.reach is not None and task.reach.effector is not None:
        named.append(task.reach.effector)
    if isinstance(task.start, ir.StartIn) and task.start.effector is not None:
        named.append(task.start.effector)
    return max((number for number in named if number > effectors), default=None)


# --- Demands of a task on paths through the cells -------------------------------------------------
#
# Source: Section 4.2 (the set of runs from the initial region to the target that avoid obstacles),
# with correction 4.18: ``reach`` concerns the last instant only, the target may be entered early;
# ``satisfy`` as a formula about samples (:mod:`compiler.tasks.sampled_formula`).


@dataclass(frozen=True, slots=True)
class PlannedEffector:
    """Where one effector (from 0) may begin, be and end; ascending indices of cells.

    ``start`` and ``end`` may contain forbidden cells, which stay forbidden; ``end`` None: anywhere.
    """

    effector: int
    start: tuple[int, ...]
    forbidden: tuple[int, ...] = ()
    end: tuple[int, ...] | None = None


@dataclass(frozen=True, slots=True)
class PlanningProblem:
    """Find paths of adjacent cells for some effectors.

    Attributes:
        neighbours: the neighbours of each cell, ascending.
        propositions: the regions that each cell lies in.
        effectors: the planned effectors, by ascending number.
        formula: the formula that the paths satisfy together, or None.
        timed: whether it matters at which samples cells are entered.
        steps: the last sample; a path has at most this many changes of cell.
        changes: the bound on the changes of all paths together.
        settled: the last sample at which a cell is entered, if timed; None for any sample.
        names: the name of each cell, for people; if empty, cells are named by number.
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
        """The name of a cell."""
        return self.names[cell] if self.names else f"cell {cell}"


def planning_problem(
    abstraction: Abstraction,
    task: Task,
    effector: int,
    start_cells: Mapping[int, Sequence[int]] | None = None,
) -> PlanningProblem:
    """The path problem of a task.

    Cells inside a region that ``avoid ... with effector`` names are forbidden. ``with body`` does
    not constrain the effector's own point, and neither does a margin: they are left to the control
    synthesis and the proof, so that the path problem has every path that a robot can follow.

    Args:
        abstraction: the cells of the task's workspace.
        task: the task.
        effector: the recorded effector, from 0; those that atoms name are planned as well.
        start_cells: for each effector (from 0) the cells to start in, if these depend on the robot;
            an effector that is not named, and does not start in a region, may start anywhere.
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
    """Whether a load may be put down in the cell in which it is picked up."""
    pairs = ((abstraction.within([c.source]), abstraction.within([c.target])) for c in task.carries)
    return any(set(source) & set(target) for source, target in pairs)


def _avoided(task: Task) -> list[str]:
    return [name for avoid in task.avoid if avoid.subject == "effector" for name in avoid.regions]


def _conjunction(formulas: Sequence[ir.Formula]) -> ir.Formula:
    return formulas[0] if len(formulas) == 1 else ir.And(tuple(formulas))


def _named(formula: SampledFormula) -> set[int]:
    """The effectors, from 0, that a formula names."""
    return {node.effector - 1 for node in nodes(formula) if isinstance(node, Literal)}


# --- `robust` clauses by coordinate, rate and input -----------------------------------------------


def joint_radii(radii: ir.Radii, model: RobotModel) -> list[Fraction]:
    """For each joint's coordinate, then for each rate, the radius of its kind, in SI units."""
    turning = [dof.kind == "revolute" for dof in model.dofs]
    places = [radii.angle if turns else radii.length for turns in turning]
    return places + [radii.angular_rate if turns else radii.speed for turns in turning]


def disturbance_radii(task: ir.Task, model: RobotModel) -> list[Fraction]:
    """For each coordinate, then each rate, how far the start may be from the planned one, in SI."""
    return joint_radii((task.robust or ir.Robust()).start, model)


def measurement_radii(task: ir.Task, model: RobotModel) -> list[Fraction]:
    """For each coordinate, then each rate, the largest error of its measurement, in SI."""
    return joint_radii((task.robust or ir.Robust()).measured, model)


@dataclass(frozen=True, slots=True)
class UncertainMass:
    """Bodies of a robot, by number, whose masses share one unknown factor in 1 +- ``part``."""

    part: Fraction
    bodies: tuple[int, ...]


def uncertain_masses(task: ir.Task, model: RobotModel) -> tuple[UncertainMass, ...]:
    """The uncertain factors of masses: of all bodies, for each occurrence, and for each load.

    Raises:
        ValueError: the task refers to owners of bodies, and the model does not give all of them.
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
    """How far inputs may be from the commands: a fraction of the input, and an absolute error.

    Both have one value per input (m,), the second, a fraction of its bound, in its unit. Loads have
    no errors.
    """
    robust, inputs = task.robust or ir.Robust(), robot_inputs(model)
    parts = tuple(Fraction(0) if item.is_load else robust.effort for item in inputs)
    most = [Fraction(0)] * len(inputs)
    for bound in input_bounds(model, task):
        size = max(abs(bound.lower), abs(bound.upper))
        for place in bound.inputs:
            most[place] = max(most[place], robust.effort_of_bound * size)
    return parts, tuple(most)
