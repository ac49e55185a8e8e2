"""The robots that are left for the tasks of a mission, of which the cheapest chain is a bound."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from compiler.missions.chains import Link
from compiler.missions.parameter_boxes import BoxTree, whole_box
from compiler.missions.parameter_ranges import Ranges
from compiler.missions.robot_changes import built
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation
from grammar_lang import ir

Labels = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class OpenRobots:
    """What is known of the robots of one task.

    ``most`` bounds their modules, None: nothing does; ``is_refuted`` tells of a structure whatever
    its parameters are; ``trees`` are the boxes of those structures that are refuted in some.
    ``fixed``: parameters decide on costs, as the robot that there is before has known ones.
    """

    most: int | None
    is_refuted: Callable[[Derivation], bool]
    trees: Mapping[Labels, BoxTree]
    model: Callable[[Derivation], RobotModel | None]
    fixed: bool = False


def fixes(task: ir.Task) -> bool:
    """Whether a task has one value for some parameters of modules that are kept before it."""
    return task.origin is not None and bool(task.origin.fixed)


def open_links(
    structures: Sequence[Derivation], modules: Collection[str], robots: OpenRobots
) -> list[Link]:
    """The robots of a task that are left, each with where its parameters are."""
    found: list[Link] = []
    for rank, derivation in enumerate(structures):
        count = sum(symbol in modules for symbol in derivation.word)
        if (robots.most is not None and count > robots.most) or robots.is_refuted(derivation):
            continue
        tree, model = robots.trees.get(derivation.labels), None
        if tree is not None or robots.fixed:
            model = robots.model(derivation)
        if model is None:
            found.append(Link(built(derivation.word, modules, {}), rank))
            continue
        tree, parameters = tree or BoxTree(whole_box(model)), model.parameters
        for leaf in tree.open_leaves():
            values: dict[tuple[int, str], Ranges] = {
                (parameter.symbol, parameter.name): ranges
                for parameter, ranges in zip(parameters, leaf.ranges(), strict=True)
            }
            found.append(Link(built(derivation.word, modules, values), rank, narrow=True))
    return found
