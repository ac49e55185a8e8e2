"""An untimed problem with one effector as clauses, one change of cell more at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.planning.cell_graph import UNREACHABLE
from compiler.planning.clauses import Clauses
from compiler.planning.effector_distances import EffectorDistances
from compiler.planning.formula_clauses import FormulaClauses, Layers
from compiler.planning.position_paths import PositionPaths
from compiler.planning.region_links import RegionLinks
from compiler.planning.specification import PlanningProblem
from compiler.planning.words import Word


class PositionEncoding:
    """Paths c_0 .. c_m of one effector; without a formula no cell comes twice.

    Attributes:
        clauses: what is to be solved, under ``assumptions``.
        least: no plan has fewer changes; None: there is none at all.
        limit: the largest number of changes.
        complete: whether the limit excludes no plan.
    """

    def __init__(self, problem: PlanningProblem) -> None:
        (planned,) = problem.effectors
        self.clauses = Clauses()
        distance = EffectorDistances(problem, planned)
        simple = problem.formula is None
        self._paths = PositionPaths(
            self.clauses,
            distance.edges,
            distance.from_start,
            distance.to_end,
            who=f"effector {planned.effector + 1}",
            cell_name=problem.name,
            simple=simple,
        )
        self.shortest = (distance.shortest,)
        self.least = distance.least
        usable = int((distance.from_start + distance.to_end < UNREACHABLE).sum())
        self.complete = simple and usable - 1 <= problem.changes
        self.limit = min(problem.changes, usable - 1) if simple else problem.changes
        self._effector = planned.effector
        self._formula: FormulaClauses | None = None
        if problem.formula is not None and self.least is not None:
            layers = Layers(self.limit, self._paths.exists, open_end=True)
            self._regions = RegionLinks(self.clauses, problem.propositions, self.limit)
            self._formula = FormulaClauses(self.clauses, problem.formula, layers, self._regions)
        self._pending: list[tuple[int, ...]] = []

    def extend(self, bound: int) -> None:
        """Lay out paths of ``bound`` changes; there are none left of fewer."""
        self._lay_out(bound)
        self.clauses.clause([self._paths.exists(bound)])
        waiting, self._pending = self._pending, []
        for prefix in waiting:
            self.block(self._effector, prefix)

    def _lay_out(self, bound: int) -> None:
        while self._paths.bound < bound:
            new = self._paths.extend()
            if self._formula is not None:
                self._formula.lay_out(self._paths.bound)
                self._regions.link(self._effector + 1, new)

    def assumptions(self, bound: int, *, distinct: bool) -> list[int]:
        """The literals of a bound that is laid out; they let nothing beyond it."""
        return [-self._paths.more, -self._paths.exists(bound + 1)]

    def decode(self, true: NDArray[np.bool_]) -> tuple[Word, ...]:
        """The path of a model."""
        return (Word(self._effector, self._paths.decode(true), None),)

    def exclude(self, words: Sequence[Word]) -> None:
        """Not this path again; longer ones may begin with it."""
        (word,) = words
        own = self._paths.beginning(word.cells)
        self.clauses.clause([*(-own).tolist(), self._paths.exists(len(own))])

    def block(self, effector: int, prefix: tuple[int, ...]) -> None:
        """No path that begins with these cells."""
        own = self._paths.beginning(prefix)
        if own.all():
            self.clauses.clause((-own).tolist())
        elif self._paths.may_begin(prefix):
            self._pending.append(prefix)

    def close(self) -> None:
        """Make the clauses those of all plans within the limit, without assumptions."""
        if self.least is None or self.least > self.limit:
            self.clauses.clause([])
            return
        self._lay_out(self.limit)
        self._paths.ends(self._paths.places)
        for literal in self.assumptions(self.limit, distinct=False):
            self.clauses.clause([literal])
