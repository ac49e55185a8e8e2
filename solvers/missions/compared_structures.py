"""The structures that are compared with each other if robots are rebuilt."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import islice

from compiler.missions.chains import ChainCosts, word_costs
from compiler.words.derivation import Derivation
from compiler.words.language import Language
from compiler.words.structures import structures
from grammar_lang import ir
from solvers.conclusion import DEFAULT_MODULES, module_bound
from solvers.missions.mission_result import Existing
from solvers.missions.task_robots import TaskRobots
from solvers.missions.undecided_robots import Ended

MOST_ROBOTS = 1000
"""The most structures that are compared with each other."""


MOST_PRICE = 2**40
"""From this price on, sums use integers of arbitrary size."""
MOST_LISTED = 20_000
"""The most structures searched for those nearest to the existing robot."""


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Why some structures are not compared, and how to reduce their number."""

    reason: str
    ended: Ended


@dataclass(frozen=True, slots=True)
class Compared:
    """Structures of at most ``modules`` modules; ``by_default`` says that this is a default bound.

    If some are ``left_out``, nothing is known about all robots.
    """

    structures: list[Derivation]
    modules: int
    by_default: bool
    left_out: LeftOut | None = None


def compared_structures(
    tasks: Sequence[TaskRobots], prices: ir.Prices, existing: Existing | None
) -> Compared:
    """The structures of the family of some tasks.

    If there are too many, those with the shortest words are compared, or those that are cheapest to
    build from the existing robot.

    Args:
        tasks: the tasks.
        prices: the prices of changes.
        existing: the robot before the first task, if there is one.
    """
    family = tasks[0].family
    most = max(module_bound(family, each.task) for each in tasks)
    unbounded = any(each.task.modules is None for each in tasks)
    by_default = unbounded and most == DEFAULT_MODULES and not family.language.is_finite()
    found = _first(family.language, most)
    if len(found) <= MOST_ROBOTS:
        return Compared(found, most, by_default)
    which = "those of the shortest words"
    if existing is None:
        found = found[:MOST_ROBOTS]
    else:
        listed = list(islice(structures(family.language, most), MOST_LISTED))
        found = _nearest(listed, frozenset(family.program.modules), prices, existing)
        which = "those nearest to the existing robot"
    reason = (
        f"of more than {MOST_ROBOTS:,} structures of at most {most} modules {MOST_ROBOTS:,} were "
        f"compared, {which}"
    )
    ended = Ended("structures", _fewer(family.language, most))
    return Compared(found, most, by_default, LeftOut(reason, ended))


def _first(language: Language, modules: int) -> list[Derivation]:
    """All structures, or one more than can be compared."""
    return list(islice(structures(language, modules), MOST_ROBOTS + 1))


def _nearest(
    listed: Sequence[Derivation], modules: Collection[str], prices: ir.Prices, existing: Existing
) -> list[Derivation]:
    """The structures cheapest to build from a robot, judged by their words, in order."""
    costs = ChainCosts(prices, frozenset())
    add, remove = costs.whole(prices.add), costs.whole(prices.remove)
    old = tuple(module.name for module in existing.robot)
    new = [tuple(symbol for symbol in each.word if symbol in modules) for each in listed]
    wide = max(add, remove) >= MOST_PRICE
    (steps,) = word_costs([old], new, add, remove, wide=wide).tolist()
    nearest = sorted(range(len(listed)), key=steps.__getitem__)[:MOST_ROBOTS]
    return [listed[place] for place in sorted(nearest)]


def _fewer(language: Language, most: int) -> str:
    """Advice on how to reduce the structures to a number that can be compared."""
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
