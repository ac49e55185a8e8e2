"""What a task asks of paths through the cells.

Source: Section 4.2 (the set of runs from the initial region to the target that avoid obstacles),
with correction 4.18: ``reach`` is about the last instant only, the target may be entered early;
``satisfy`` as a formula about samples (:mod:`compiler.tasks.sampled_formula`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from compiler.tasks.sampled_formula import (
    Literal,
    SampledFormula,
    is_timed,
    nodes,
    sampled,
)
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from grammar_lang.ir import StartAt, StartIn, Task


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
    clauses = [clause.formula for clause in task.satisfy]
    formula = sampled(_conjunction(clauses), task.step, task.steps) if clauses else None
    known = {} if start_cells is None else start_cells
    planned = {effector} | (set() if formula is None else _named(formula))
    forbidden = abstraction.within(_avoided(task))
    end = None if task.reach is None else abstraction.within([task.reach.region])
    timed = any(map(is_timed, clauses))
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


def _avoided(task: Task) -> list[str]:
    return [name for avoid in task.avoid if avoid.subject == "effector" for name in avoid.regions]


def _conjunction(formulas: Sequence[ir.Formula]) -> ir.Formula:
    return formulas[0] if len(formulas) == 1 else ir.And(tuple(formulas))


def _named(formula: SampledFormula) -> set[int]:
    """The effectors, from 0, that a formula names."""
    return {node.effector - 1 for node in nodes(formula) if isinstance(node, Literal)}
