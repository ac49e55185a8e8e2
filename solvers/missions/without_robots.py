"""The verdict on a mission without a design, its reason, and what ended the search."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.missions.parameter_boxes import BoxTree
from solvers.missions.compared_structures import Compared
from solvers.missions.mission_result import CutRobot
from solvers.missions.one_robot import OneRobotSearch
from solvers.missions.rebuilt_robots import MOST_CUTS, RebuiltSearch
from solvers.missions.task_robots import TaskRobots
from solvers.missions.undecided_robots import (
    MANY_MOTIONS,
    NO_BOUND,
    OUT_OF_TIME,
    Ended,
    Undecided,
    UndecidedRobots,
)
from solvers.verdict import NotFound

TIME = "the time limit was reached"
DISAGREE = "the robots of no chain agree in their parameters"


@dataclass(frozen=True, slots=True)
class Conclusion:
    """A verdict without a design; ``ended`` is None if the search went through all robots."""

    verdict: NotFound
    reason: str
    ended: Ended | None = None


TOO_LATE = Conclusion("unknown", TIME, OUT_OF_TIME)


def without_one_robot(
    search: OneRobotSearch, open_robots: Sequence[UndecidedRobots], *, late: bool
) -> Conclusion:
    """The conclusion if no robot was found that does all tasks; ``late`` says that time ran out."""
    if late:
        return TOO_LATE
    tried, family, bound = len(search.words), search.tasks[0].family, search.task.modules
    if search.undecided or search.stopped is not None:
        parts = []
        if search.undecided:
            parts.append(
                f"{len(search.undecided)} of {tried} structures are neither found nor refuted; "
                f"the first is {_first(open_robots, search.tasks)}"
            )
        parts += [search.stopped] if search.stopped else []
        return Conclusion("unknown", "; ".join(parts), MANY_MOTIONS if search.stopped else None)
    if bound is None and not family.language.is_finite():
        reason = "every structure that was tried is refuted in a task, and nothing bounds them"
        return Conclusion("unknown", reason, NO_BOUND)
    within = "of the family" if bound is None else f"of at most {bound} modules"
    return Conclusion(
        "impossible", f"no robot {within} does all tasks: each is refuted in one of them"
    )


def without_chain(
    search: RebuiltSearch,
    least: Fraction | None,
    open_robots: Sequence[UndecidedRobots],
    compared: Compared,
    *,
    late: bool,
) -> Conclusion:
    """The conclusion if no chain of rebuilt robots was found.

    Args:
        search: the search.
        least: a lower bound on the cost of the remaining robots; None if there are none.
        open_robots: those that are neither found nor refuted.
        compared: the structures that were compared.
        late: whether time ran out.
    """
    if late:
        return TOO_LATE
    open_ = _open(search, open_robots)
    if compared.left_out is not None:
        ended = MANY_MOTIONS if search.stopped else compared.left_out.ended
        return Conclusion("unknown", "; ".join([compared.left_out.reason, *open_]), ended)
    most = search.mission.most
    if least is not None and (most is None or least <= most):
        return Conclusion("unknown", "; ".join(open_) or DISAGREE, _ended(search, open_robots))
    if compared.by_default:
        within = f"at most {compared.modules} modules, the default search bound"
        return Conclusion("unknown", f"every robot of {within}, is refuted", NO_BOUND)
    what = "no robots do the tasks" if most is None else f"no robots do the tasks within {most}"
    return Conclusion("impossible", f"{what}: every chain has one that is refuted, or costs more")


def _open(search: RebuiltSearch, open_robots: Sequence[UndecidedRobots]) -> list[str]:
    """The questions that a search left open, in words."""
    parts = [search.stopped] if search.stopped else []
    if open_robots:
        count = sum(each.robots for each in open_robots)
        are = "1 robot is" if count == 1 else f"{count} robots are"
        parts.append(
            f"{are} neither found nor refuted; the first is {_first(open_robots, search.tasks)}"
        )
    if search.wanted:
        parts.append(
            f"the search ended at its limit of {MOST_CUTS} boxes of parameters that are cut"
        )
    return parts


def _first(open_robots: Sequence[UndecidedRobots], tasks: Sequence[TaskRobots]) -> str:
    """The first undecided robot, and why it is undecided."""
    first = open_robots[0]
    named = "" if first.why.task is None else f" in `{tasks[first.why.task].task.name}`"
    return f"{' '.join(first.words[0])}{named}: {first.why.reason}"


def _ended(search: RebuiltSearch, open_robots: Sequence[UndecidedRobots]) -> Ended | None:
    """The limit that ended a search for rebuilt robots, or kept it from an answer."""
    if search.stopped:
        return MANY_MOTIONS
    named = ", ".join(f"`{name}`" for name in cut_parameters(search))
    which = f"a narrower range of {named}" if named else "narrower ranges of the parameters"
    if search.wanted:
        return Ended("cuts", which)
    if open_robots:
        return None
    return Ended("parameters", f"{which}, or `free` for what need not stay as it is")


def cut_parameters(search: RebuiltSearch) -> list[str]:
    """The parameters whose ranges were cut, as `M.p`, in order."""
    found: dict[str, None] = {}
    for (layer, _), cut in search.cut.items():
        found.update(dict.fromkeys(_parameters(cut, search.tasks[layer])))
    return sorted(found)


def _parameters(cut: CutRobot, robots: TaskRobots) -> Iterable[str]:
    model = robots.model(robots.family.replay(cut.labels))
    for number in _cut_numbers(cut.tree):
        if model is not None:
            yield f"{model.parameters[number].module}.{model.parameters[number].name}"


def _cut_numbers(tree: BoxTree) -> Iterator[int]:
    if tree.cut is not None and tree.parts is not None:
        yield tree.cut.parameter
        for part in tree.parts:
            yield from _cut_numbers(part)


def all_undecided(search: RebuiltSearch) -> Iterator[tuple[tuple[str, ...], Undecided]]:
    """The words of the undecided robots, and why they are undecided, task by task."""
    for layer in search.layers:
        for node in layer:
            if node.undecided is not None:
                yield node.derivation.word, node.undecided
