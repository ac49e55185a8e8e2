"""A planning problem as clauses."""

from __future__ import annotations

from typing import TypeAlias

from compiler.planning.position_encoding import PositionEncoding
from compiler.planning.sample_encoding import SampleEncoding
from compiler.planning.specification import PlanningProblem

PlanEncoding: TypeAlias = PositionEncoding | SampleEncoding


def plan_encoding(problem: PlanningProblem) -> PlanEncoding:
    """By changes of cell where one effector's path is not timed, else by samples."""
    return SampleEncoding(problem) if problem.by_samples else PositionEncoding(problem)
