"""The numbers of effectors: off the names of regions, off effectors and off each other."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import combinations, product
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from srgc.cli import run
from srgc.render.effector_numbers import HALF, RING, number_places
from srgc.render.pose_picture import pose_picture

SVG = "{http://www.w3.org/2000/svg}"
SIZE = 400.0, 300.0
LETTER = 0.8
"""More than the mean width of a bold letter, as a share of its size."""

Box = tuple[float, float, float, float]


def apart(a: Box, b: Box) -> bool:
    return a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


def about(point: np.ndarray, half: float) -> Box:
    x, y = point
    return float(x - half), float(y - half), float(x + half), float(y + half)


@pytest.mark.parametrize("seed", range(30))
def test_numbers_overlap_nothing_and_stay_in_the_picture(seed: int) -> None:
    random = np.random.default_rng(seed)
    tips = random.uniform([20, 20], [380, 280], (random.integers(2, 6), 2))
    tips[1] = tips[0] + random.uniform(-6, 6, 2)
    corners = tips[random.integers(0, len(tips), 4)] - random.uniform(0, 60, (4, 2))
    names = np.concatenate([corners, corners + np.array([60, 16])], axis=1)
    middles = number_places(tips, SIZE, names)
    discs = [about(middle, HALF) for middle in middles]
    for disc in discs:
        assert disc[0] >= 0 <= disc[1]
        assert disc[2] <= SIZE[0]
        assert disc[3] <= SIZE[1]
        assert all(apart(disc, (a, b, c, d)) for a, b, c, d in names)
    for middle, tip in product(middles, tips):
        assert np.hypot(*(middle - tip)) >= HALF + RING
    for one, other in combinations(middles, 2):
        assert np.hypot(*(one - other)) >= 2 * HALF


def test_a_number_stands_beside_its_effector_where_there_is_room() -> None:
    tips = np.array([[100.0, 100.0], [250.0, 200.0]])
    for tip, middle in zip(tips, number_places(tips, SIZE), strict=True):
        assert np.hypot(*(middle - tip)) < 2 * (HALF + RING)
        assert middle[0] > tip[0]
        assert middle[1] < tip[1]


def moves(element: ElementTree.Element) -> np.ndarray:
    found = re.fullmatch(r"translate\((\S+) (\S+)\)", element.get("transform", ""))
    return np.zeros(2) if found is None else np.array([float(v) for v in found.groups()])


def of_class(root: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    return (each for each in root.iter() if name in each.get("class", "").split())


def name_boxes(root: ElementTree.Element) -> list[Box]:
    """Rectangles that hold the names of regions, which are written about their middles."""
    found = []
    for mark in (text for group in of_class(root, "names") for text in group.iter(f"{SVG}text")):
        x, y, half = float(mark.get("x", 0)), float(mark.get("y", 0)), 6.5 * LETTER
        across = half * len(mark.text or "")
        found.append((x - across, y - 11, x + across, y + 3))
    return found


def test_no_number_touches_a_name_in_any_instant_of_a_picture(
    made: Callable[[str], Path], tmp_path: Path
) -> None:
    """The first pen is on the names of the regions at the start and at the end."""
    moving = tmp_path / "moving.svg"
    folder = made("plotter") / "out"
    assert run(["export", str(folder), "--to", "svg", "-o", str(moving)]) == 0
    for file, least in ((moving, 24), (folder / "figures" / "workspace.svg", 1)):
        root = ElementTree.parse(file).getroot()
        names, frames = name_boxes(root), list(of_class(root, "robot"))
        assert len(names) == 3
        assert len(frames) >= least
        for frame in frames:
            effectors = list(of_class(frame, "effector"))
            discs = [
                about(moves(each) + moves(number), float(number[0].get("r", 0)))
                for each in effectors
                for number in of_class(each, "number")
            ]
            assert [number[1].text for number in of_class(frame, "number")] == ["1", "2"]
            assert all(apart(disc, name) for disc in discs for name in names)
            assert apart(*discs)


def test_a_robot_alone_has_its_numbers_beside_the_names_of_its_joints(
    made: Callable[[str], Path],
) -> None:
    from srgc.results.found_design import found_design

    found = found_design(made("plotter") / "out")
    root = ElementTree.fromstring(pose_picture(found.model, found.theta))
    assert [number[1].text for number in of_class(root, "number")] == ["1", "2"]
