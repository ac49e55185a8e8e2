"""From a task and a cell path to the control problem that the search of parameters evaluates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.word_formula import SampledFormula
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.motions.path_following import LEAST_MARGIN, SUBSTEPS, Follower
from solvers.motions.stiffness import stable_parts
from solvers.planner import EffectorPath


@dataclass(frozen=True, slots=True)
class PathTask:
    """A robot in a task; ``formula`` is what the task's formulas ask of the samples.

    ``solver`` is that of the convex steps, by its name in cvxpy; None: our own.
    """

    program: ir.Program
    task: ir.Task
    numeric: NumericRobot
    formula: SampledFormula | None
    seed: int
    solver: str | None = None

    def follower(
        self, cells: Abstraction, recorded: int, leader: int, path: tuple[int, ...]
    ) -> Follower:
        """The follower of a path of ``leader`` at the first margin; ``recorded`` reaches."""
        return Follower(
            self.numeric,
            self.program.workspaces[self.task.workspace],
            self.task,
            cells,
            leader,
            path,
            LEAST_MARGIN,
            self.seed,
            substeps=stable_parts(self.numeric, float(self.task.step), SUBSTEPS),
            recorded=recorded,
            formula=self.formula,
            solver=self.solver,
        )

    def along(
        self, cells: Abstraction, recorded: int, leader: int, names: Sequence[Sequence[str]]
    ) -> Follower | None:
        """The follower of the path of a design, entered as the design enters it.

        None where what ``names``, the cells of every effector by sample, says of the leader is no
        path.
        """
        paths = [entered(cells, effector, each) for effector, each in enumerate(names)]
        own = paths[leader]
        if own is None or own.entries is None:
            return None
        others = tuple(path for path in paths if path is not None and path is not own)
        follower = self.follower(cells, recorded, leader, own.cells)
        return replace(follower, timing=own.entries, others=() if self.formula is None else others)


def entered(cells: Abstraction, effector: int, names: Sequence[str]) -> EffectorPath | None:
    """The path of an effector whose cell at every sample is given; None where it is none."""
    known = {cell.name: index for index, cell in enumerate(cells.cells)}
    path, entries = list[int](), list[int]()
    for sample, name in enumerate(names):
        cell = known.get(name)
        if cell is None:
            return None
        if path and path[-1] == cell:
            continue
        if path and cell not in cells.neighbours[path[-1]]:
            return None
        path.append(cell)
        entries.append(sample)
    return EffectorPath(effector, tuple(path), tuple(entries)) if path else None
