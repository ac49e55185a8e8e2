"""The robots that are left for the tasks of a mission, of which the cheapest chain is a bound."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from compiler.missions.chains import Link
from compiler.missions.parameter_boxes import BoxTree
from compiler.missions.parameter_ranges import Ranges
from compiler.missions.robot_changes import built
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation

Labels = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class OpenRobots:
    """What is known of the robots of one task.

    ``most`` bounds their modules, None: nothing does; ``is_refuted`` tells of a structure whatever
    its parameters are; ``trees`` are the boxes of those structures that are refuted in some.
    """

    most: int | None
    is_refuted: Callable[[Derivation], bool]
    trees: Mapping[Labels, BoxTree]
    model: Callable[[Derivation], RobotModel | None]


def open_links(
    structures: Sequence[Derivation], modules: Collection[str], robots: OpenRobots
) -> list[Link]:
    """The robots of a task that are left, each with where its parameters are."""
    found: list[Link] = []
    for rank, derivation in enumerate(structures):
        count = sum(symbol in modules for symbol in derivation.word)
        if (robots.most is not None and count > robots.most) or robots.is_refuted(derivation):
            continue
        tree = robots.trees.get(derivation.labels)
        if tree is None:
            found.append(Link(built(derivation.word, modules, {}), rank))
            continue
        model = robots.model(derivation)
        parameters = () if model is None else model.parameters
        for leaf in tree.open_leaves():
            values: dict[tuple[int, str], Ranges] = {
                (parameter.symbol, parameter.name): ranges
                for parameter, ranges in zip(parameters, leaf.ranges(), strict=True)
            }
            found.append(Link(built(derivation.word, modules, values), rank, narrow=True))
    return found
