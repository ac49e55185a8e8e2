"""The structures that are compared with each other where robots are rebuilt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

from compiler.words.derivation import Derivation
from compiler.words.language import Language
from compiler.words.structures import structures
from solvers.conclusion import DEFAULT_MODULES, module_bound
from solvers.missions.task_robots import TaskRobots
from solvers.missions.undecided_robots import Ended

MOST_ROBOTS = 1000
"""So many structures are compared with each other."""


@dataclass(frozen=True, slots=True)
class Compared:
    """Structures of at most so many ``modules``; ``by_default``: nobody asked for that bound."""

    structures: list[Derivation]
    modules: int
    by_default: bool


@dataclass(frozen=True, slots=True)
class TooMany:
    """Why structures are not compared, and what makes them fewer."""

    reason: str
    ended: Ended


def compared_structures(tasks: Sequence[TaskRobots]) -> Compared | TooMany:
    """The structures of the family of some tasks."""
    family = tasks[0].family
    most = max(module_bound(family, each.task) for each in tasks)
    unbounded = any(each.task.modules is None for each in tasks)
    by_default = unbounded and most == DEFAULT_MODULES and not family.language.is_finite()
    found = _first(family.language, most)
    if len(found) <= MOST_ROBOTS:
        return Compared(found, most, by_default)
    reason = f"the grammar has more than {MOST_ROBOTS:,} structures of at most {most} modules"
    return TooMany(reason, Ended("structures", _fewer(family.language, most)))


def _first(language: Language, modules: int) -> list[Derivation]:
    """All structures, or one more than are compared."""
    return list(islice(structures(language, modules), MOST_ROBOTS + 1))


def _fewer(language: Language, most: int) -> str:
    """What would make the structures so few that all are compared, in words."""
    bound = left = 0
    for modules in range(1, most):
        count = len(_first(language, modules))
        if count > MOST_ROBOTS:
            break
        if count:
            bound, left = modules, count
    if not left:
        return "a narrower `accept`"
    return f"`modules <= {bound}` in all tasks, which leaves {left:,}, or a narrower `accept`"
