"""``specs/cheapest_arm.srg``: the cheapest arm that is long enough, against all arms by hand."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import hypot
from pathlib import Path

import pytest

from tests.oracles import result_files
from tests.srgc.conftest import Ran

PRICES = {"Motor": 215, "Servo": 48, "Carbon": 64, "Steel": 12, "Stub": 9, "Sensor": 60}
LENGTHS = {"Carbon": 0.4, "Steel": 0.4, "Stub": 0.2}
MASSES = {"Motor": 0.9, "Servo": 0.2, "Carbon": 0.06, "Steel": 0.36, "Stub": 0.1, "Sensor": 0.3}
NEAREST = hypot(0.45, 0.25)
"""The corner of the shelf that is nearest to the base, in metres."""


def arms() -> list[tuple[str, ...]]:
    """All arms of at most six modules, one motor at most, that are long enough for the shelf."""
    pairs = list(product(("Motor", "Servo"), LENGTHS))
    found = [tuple(sum(some, ())) for n in (1, 2) for some in product(pairs, repeat=n)]
    return [
        (*arm, "Sensor")
        for arm in found
        if arm.count("Motor") <= 1 and sum(LENGTHS.get(name, 0) for name in arm) >= NEAREST
    ]


def price(arm: tuple[str, ...]) -> int:
    return sum(PRICES[name] for name in arm)


def mass(arm: tuple[str, ...]) -> float:
    return sum(MASSES[name] for name in arm)


def test_it_is_the_cheapest_arm_that_is_long_enough(
    srgc: Callable[..., Ran], made: Callable[[str], Path]
) -> None:
    folder = made("cheapest_arm") / "out"
    design = result_files.read(folder, "design.json")
    least = min(map(price, arms()))
    lightest = min(mass(arm) for arm in arms() if price(arm) == least)
    found = tuple(name for name in design["word"] if name not in ("Base", "screws"))
    assert found in arms()
    assert (price(found), mass(found)) == (least, pytest.approx(lightest))
    cost, weight = design["objectives"]
    assert (cost["value"], cost["least"], cost["undecided"]) == (least, least, 0)
    assert weight["value"] == weight["least"] == pytest.approx(lightest)
    ran = srgc("verify", folder)
    assert ran.status == 0
    assert f"price {least}: no robot has less" in ran.out
