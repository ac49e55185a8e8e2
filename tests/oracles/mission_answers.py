"""The verdict and the least values of a mission, from all robots of its family."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

from tests.oracles.mission_robots import Robot, cheapest, rebuilding

if TYPE_CHECKING:
    from tests.oracles.mission_families import MissionFamily

Wanted = Literal["impossible", "changes", "shared", "any"]
Least = tuple[Fraction, ...] | None


@dataclass(frozen=True)
class Answer:
    """What is true of a mission: ``least`` of each objective, None where it is impossible.

    ``blind`` is the least where the values of parameters do not matter; ``alone`` says whether
    every task is possible on its own.
    """

    verdict: Literal["found", "impossible"]
    least: Least
    blind: Least
    alone: bool


def is_wanted(found: Answer, wanted: Wanted) -> bool:
    """Whether a mission is of a class: hopeless, not for nothing, or decided by shared values."""
    match wanted:
        case "impossible":
            return found.verdict == "impossible" and found.alone
        case "changes":
            return found.least is not None and found.least[0] > 0
        case "shared":
            return found.alone and found.least != found.blind
        case "any":
            return True


def answer(family: MissionFamily) -> Answer:
    """What is true of a mission without a bound on changes.

    Raises:
        Unclear: a robot is at the border of what it can do.
    """
    if family.style == "interval":
        every = family.continuous()
        alone = every.alone()
        least = _least_words(family, every.shared()) if family.one_robot else every.least()
        blind = _least_words(family, every.each()) if family.one_robot else every.blind()
        return Answer("impossible" if least is None else "found", least, blind, alone)
    able = [family.able(number) for number in range(len(family.tasks))]
    if family.one_robot:
        common = set(able[0]).intersection(*able[1:])
        words = set(map(_word, able[0])).intersection(*(map(_word, some) for some in able[1:]))
        least, blind = _least_words(family, set(map(_word, common))), _least_words(family, words)
    else:
        least, blind = _chain(family, able, blind=False), _chain(family, able, blind=True)
    return Answer("impossible" if least is None else "found", least, blind, all(able))


def _word(robot: Robot) -> tuple[str, ...]:
    return tuple(name for name, _ in robot)


def _least_words(family: MissionFamily, words: set[tuple[str, ...]]) -> Least:
    """The least of each objective, among words within what those before leave."""
    left, found = list(words), list[Fraction]()
    if not left:
        return None
    for wish in family.wishes:
        text, _, rest = wish.partition(" within ")
        percent = int(rest.split()[0]) if rest else 0

        def value(word: tuple[str, ...], text: str = text) -> Fraction:
            priced = text == "sum(price)"
            return family.price(tuple((n, None) for n in word)) if priced else Fraction(len(word))

        found.append(min(map(value, left)))
        most = found[-1] * (100 + percent) / 100
        left = [word for word in left if value(word) <= most]
    return tuple(found)


def _chain(family: MissionFamily, able: list[list[Robot]], *, blind: bool) -> Least:
    """The least cost of a chain; ``blind``: as if no length were known."""
    existing = family.existing
    if blind:
        able = [list(dict.fromkeys(map(_blank, layer))) for layer in able]
        existing = None if existing is None else _blank(existing)
    cost = cheapest(able, lambda a, b: rebuilding(a, b, family.prices), existing)
    return None if cost is None else (cost,)


def _blank(robot: Robot) -> Robot:
    return tuple((name, None) for name, _ in robot)
