"""What joints with dry friction do in a segment of a tube, as ``dry_friction.py`` tells it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from flint import arb


@dataclass(frozen=True, slots=True)
class Leaving:
    """A joint goes from rest with a sign, its friction at most ``spare`` less than when it slides.

    In N m or N.
    """

    sign: Literal[1, -1]
    spare: arb


Mode: TypeAlias = Literal[1, -1, "sticking", "either"] | Leaving
Modes: TypeAlias = Mapping[int, Mode]
"""What each joint with friction does, by its number: it slides with a sign, for instance."""
Signs: TypeAlias = Mapping[int, Literal[1, -1]]
"""Joints whose rates are not of the other sign, by what they did before."""

GENEROUS = 2
"""What friction may lack is taken so many times larger than it is at first."""


def sign_of(mode: Mode) -> Literal[1, -1] | None:
    """The sign that a rate has, or none."""
    if isinstance(mode, Leaving):
        return mode.sign
    return mode if isinstance(mode, int) else None


def let_go(push: arb, size: arb) -> Mode:
    """What a joint at rest does that friction may not hold; ``size`` is the most it can."""
    if push > size:
        return 1
    if push < -size:
        return -1
    sign: Literal[1, -1] = 1 if push.mid() > 0 else -1
    spare = GENEROUS * (size - sign * push).upper()
    return Leaving(sign, spare) if bool(spare < 2 * size) else "either"


def sticking(modes: Modes) -> frozenset[int]:
    """The joints that stick."""
    return frozenset(joint for joint, mode in modes.items() if mode == "sticking")


def freed(mode: Mode, instead: Mode | None) -> Mode:
    """What a joint that may do something else is taken to do; ``instead`` is what seems so."""
    if instead is None or isinstance(instead, int):
        return "either"
    if isinstance(mode, Leaving) and isinstance(instead, Leaving):
        if instead.sign != mode.sign:
            return "either"
        return Leaving(mode.sign, instead.spare.max(GENEROUS * mode.spare))
    return instead
