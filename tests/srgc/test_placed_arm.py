"""``specs/placed_arm.srg``: the least tube, with the base placed as geometry has it."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot
from pathlib import Path

from scipy.optimize import minimize_scalar

from tests.oracles import result_files

NEAR = 1.01
"""The search of parameters is local: it ends so near the least at least."""
PROVED = 1.08
"""So near is what is proved of all robots."""


def radius(place: float) -> float:
    """The shortest tube that turns about a place on the bench from the tray to the shelf."""
    tray = [(x, y) for x in (-0.5, -0.4) for y in (0.3, 0.4)]
    shelf = [(x, y) for x in (0.3, 0.4) for y in (0.5, 0.6)]
    ends = [[hypot(x - place, y) for x, y in corners] for corners in (tray, shelf)]
    # One circle meets both: it is no smaller than the nearest point of each.
    least = max(min(one) for one in ends)
    return least if least <= min(max(one) for one in ends) else 10.0


def test_the_base_is_placed_for_the_least_tube(made: Callable[[str], Path]) -> None:
    design = result_files.read(made("placed_arm") / "out", "design.json")
    (tube,) = (each for each in design["parameters"] if each["name"] == "length")
    (place,) = (each for each in design["parameters"] if each["name"] == "place")
    least = minimize_scalar(radius, bounds=(-0.4, 0.3), method="bounded").fun
    (stated,) = design["objectives"]
    assert stated["value"] == tube["value"]
    # Two tubes reach no farther than one of the same length.
    assert least / PROVED <= stated["least"] <= least
    assert least <= tube["value"] <= NEAR * least
    assert radius(place["value"]) <= tube["value"]
