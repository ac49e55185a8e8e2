"""The robots that remain for the tasks of a mission; their cheapest chain is a bound."""

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
    """The state of knowledge about the robots of one task.

    ``most`` bounds their modules, None if nothing does; ``is_refuted`` says whether a structure is
    refuted for all parameters; ``trees`` are the boxes of structures that are refuted for some
    parameters. ``fixed``: parameters affect costs, as the robot before has known ones.
    """

    most: int | None
    is_refuted: Callable[[Derivation], bool]
    trees: Mapping[Labels, BoxTree]
    model: Callable[[Derivation], RobotModel | None]
    fixed: bool = False


def fixes(task: ir.Task) -> bool:
    """Whether a task fixes the values of some parameters of kept modules."""
    return task.origin is not None and bool(task.origin.fixed)


def open_links(
    structures: Sequence[Derivation], modules: Collection[str], robots: OpenRobots
) -> list[Link]:
    """The remaining robots of a task, each with the ranges of its parameters."""
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
