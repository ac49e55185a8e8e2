"""The modes of joints with dry friction in a segment of a tube (``dry_friction.py``)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from flint import arb


@dataclass(frozen=True, slots=True)
class Leaving:
    """A joint leaves rest with a sign; friction is at most ``spare`` less than while it slides.

    ``spare`` is in N m or N.
    """

    sign: Literal[1, -1]
    spare: arb


Mode: TypeAlias = Literal[1, -1, "sticking", "either"] | Leaving
Modes: TypeAlias = Mapping[int, Mode]
"""Maps each joint with friction to its mode: for example, it slides with a sign."""
Signs: TypeAlias = Mapping[int, Literal[1, -1]]
"""Joints whose rates do not have the other sign, according to their previous modes."""

GENEROUS = 2
"""``spare`` is this many times larger than needed at first."""


def sign_of(mode: Mode) -> Literal[1, -1] | None:
    """The sign of a rate in this mode, or None."""
    if isinstance(mode, Leaving):
        return mode.sign
    return mode if isinstance(mode, int) else None


def let_go(push: arb, size: arb) -> Mode:
    """The mode of a joint at rest that friction, of at most ``size``, may not hold."""
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
    """The mode for a joint that may leave its mode; ``instead`` is the likely next mode."""
    if instead is None or isinstance(instead, int):
        return "either"
    if isinstance(mode, Leaving) and isinstance(instead, Leaving):
        if instead.sign != mode.sign:
            return "either"
        return Leaving(mode.sign, instead.spare.max(GENEROUS * mode.spare))
    return instead
