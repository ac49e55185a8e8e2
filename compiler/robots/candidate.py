"""The structures of a family as robots, in order: what a search tries and a refutation covers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from compiler.robots.alignment import alignment
from compiler.robots.attributes import SemanticsError
from compiler.robots.family import RobotFamily
from compiler.robots.robot import RobotModel
from compiler.robots.words_by_distance import words_by_distance
from compiler.time_limits.time_limit import check_time
from compiler.words.derivation import Derivation
from compiler.words.structures import structures, structures_of
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Candidate:
    """A structure, ``number`` in order from 0, and its robot; None with the ``fault`` in words."""

    number: int
    derivation: Derivation
    model: RobotModel | None
    fault: str = ""


def candidates(family: RobotFamily, modules: int, origin: ir.Origin | None) -> Iterator[Candidate]:
    """All structures of at most so many modules, lazily, in the order of section 2.

    With an existing robot (``origin``, Example 2) in the order of the number of modules added to
    it or removed from it; its own word first, then the order of section 2.

    Raises:
        InfiniteAmbiguityError: at once, where the grammar has a useful derivation A =>+ A.
    """
    language = family.language
    if origin is None:
        return _robots(family, structures(language, modules), None)
    nearest = words_by_distance(language, origin.word, modules)
    return _robots(family, structures_of(language, nearest), origin)


def _robots(
    family: RobotFamily, derivations: Iterator[Derivation], origin: ir.Origin | None
) -> Iterator[Candidate]:
    for number, derivation in enumerate(derivations):
        check_time()
        try:
            yield Candidate(number, derivation, robot_in_task(family, origin, derivation))
        except SemanticsError as error:
            yield Candidate(number, derivation, None, str(error))


# --------------------------------------------------------------------------------------------------
# The robot of a structure in a task: what the task fixes of a module that is kept is one value.


def robot_in_task(
    family: RobotFamily, origin: ir.Origin | None, derivation: Derivation
) -> RobotModel:
    """The robot of a derivation; every fixed parameter of a kept module has its one value only.

    Args:
        family: the family of the task.
        origin: the existing robot of the task, None without one.
        derivation: the structure.

    Raises:
        SemanticsError: the derivation defines no robot.
    """
    model = family.robot(derivation)
    if origin is None or not origin.fixed:
        return model
    kept = dict(alignment(origin.word, derivation.word, family.language.srg.modules).kept)
    values = {(kept[f.symbol], f.name): f.value for f in origin.fixed if f.symbol in kept}
    parameters = (
        replace(p, domain=ir.Choices((values[p.symbol, p.name],)))
        if (p.symbol, p.name) in values
        else p
        for p in model.parameters
    )
    return replace(model, parameters=tuple(parameters))
