"""How much more room a motion is given where a proof did not go through."""

from __future__ import annotations

import numpy as np
import pytest

from solvers.search.constraint_tightening import MARGINS, WIDEST, Room, lacking_room
from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.verifier.proofs.checked_condition import Finding
from solvers.verifier.proofs.tube_checks import Status

SPREAD = DisturbanceSpread(np.array([[0.0], [0.01], [0.04]]), np.array([[0.02, 0.1]]))


def finding(margin: float, unit: str = "m", status: Status = Status.UNDECIDED) -> Finding:
    return Finding("something", status, margin, unit)


def test_the_largest_lack_counts_as_a_part_of_the_room() -> None:
    held = finding(0.5, status=Status.HOLDS)
    assert lacking_room([finding(-0.01), finding(-0.03), held], SPREAD) == pytest.approx(0.75)
    assert lacking_room([held], SPREAD) == 0
    assert lacking_room([finding(float("-inf"), "")], SPREAD) == float("inf")
    # Limits of coordinates and rates are held against the spread of those.
    assert lacking_room([finding(-0.05, "rad")], SPREAD) == pytest.approx(0.5)


def test_what_the_disturbances_do_not_move_is_given_a_wider_margin() -> None:
    none = DisturbanceSpread(np.zeros((3, 1)), np.zeros((1, 2)))
    lacking = lacking_room([finding(-0.01)], none)
    assert Room().wider(lacking, none) == Room(MARGINS[1])
    assert lacking_room([finding(float("-inf"), "")], none) == float("inf")


def test_the_room_gets_as_wide_as_was_lacking() -> None:
    room = Room().wider(0.75, SPREAD)
    assert room is not None
    assert room.margin == MARGINS[0]
    assert room.spreads >= 1.75
    again = room.wider(1e-9, SPREAD.scaled(room.spreads))
    assert again is not None
    assert again.spreads > 1.1 * room.spreads


def test_without_disturbances_margins_grow_step_by_step() -> None:
    room, seen = Room(), [Room().margin]
    while (following := room.wider(0.0, None)) is not None:
        room = following
        seen.append(room.margin)
    assert tuple(seen) == MARGINS
    assert room.is_last


def test_it_ends() -> None:
    assert Room().wider(float("inf"), SPREAD) is None
    room: Room | None = Room()
    for _ in range(100):
        if room is None:
            break
        assert room.spreads * SPREAD.widest <= WIDEST
        room = room.wider(0.3, SPREAD.scaled(room.spreads))
    assert room is None
