"""The structures of a family as robots, in order: what a search tries and a refutation covers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from compiler.grammars.derivation import Derivation
from compiler.languages.structures import structures
from compiler.robots.robot import RobotModel
from compiler.semantics.attributes import SemanticsError
from compiler.semantics.family import RobotFamily


@dataclass(frozen=True, slots=True)
class Candidate:
    """A structure, ``number`` in order from 0, and its robot; None with the ``fault`` in words."""

    number: int
    derivation: Derivation
    model: RobotModel | None
    fault: str = ""


def candidates(family: RobotFamily, modules: int) -> Iterator[Candidate]:
    """All structures of at most so many modules, lazily, in the order of section 2.

    Raises:
        InfiniteAmbiguityError: at once, where the grammar has a useful derivation A =>+ A.
    """
    return _robots(family, structures(family.language, modules))


def _robots(family: RobotFamily, derivations: Iterator[Derivation]) -> Iterator[Candidate]:
    for number, derivation in enumerate(derivations):
        try:
            yield Candidate(number, derivation, family.robot(derivation))
        except SemanticsError as error:
            yield Candidate(number, derivation, None, str(error))
