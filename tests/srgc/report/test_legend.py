"""Whatever a picture of a motion or a workspace draws is in the legend below it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from srgc.render.robot_drawing import DrawnRobot, DrawnShape
from srgc.report.animation import motion_picture
from srgc.report.evidence import Evidence
from srgc.report.legend import legend, robot_caption
from srgc.report.motion_scene import MotionScene, RobotMotion, motion_scene
from tests.oracles.html_page import Page
from tests.oracles.nearest_folder import without_claim
from tests.srgc.report.conftest import page_of

Pages = Callable[[str], tuple[Path, Page]]
On = Callable[[str], Evidence]
Change = Callable[[DrawnRobot], DrawnRobot]

EXPLAINED = {
    "bounds", "cell", "obstacle", "target", "region", "tube", "trail", "trace", "solid", "capsule",
}  # fmt: skip
"""The classes of marks that are not said in words alone."""


def explained(marks: str) -> set[str]:
    """The classes of marks in SVG, of those that a legend explains."""
    names = {name for found in re.findall(r'class="([^"]*)"', marks) for name in found.split()}
    return names & EXPLAINED


def both(page: str) -> tuple[str, str]:
    """The first picture of the motion's section, and its legend."""
    section = page.partition('<section id="motion">')[2].partition("</section>")[0]
    picture, _, rest = section.partition("</svg>")
    return picture, rest.partition('<ul class="legend">')[2].partition("</ul>")[0]


@pytest.mark.parametrize("spec", ["turner", "spatial", "beyond_reach"])
def test_all_that_is_drawn_is_in_the_legend(pages: Pages, spec: str) -> None:
    _, page = pages(spec)
    picture, shown = both(page.source)
    assert {"bounds", "cell", "target", "region"} <= explained(picture)
    assert explained(shown) == explained(picture)


def test_the_page_of_an_unknown_task_has_a_legend(
    made: Callable[[str], Path], unknown: tuple[Path, Page], tmp_path: Path
) -> None:
    without_claim(made("turner") / "out", tmp_path / "out")
    for page in (page_of(tmp_path / "out"), unknown[1]):
        picture, shown = both(page.source)
        assert {"obstacle", "target", "cell"} <= explained(picture)
        assert explained(shown) == explained(picture)


def drawn_with(scene: MotionScene, change: Change) -> tuple[MotionScene, RobotMotion]:
    """The scene with another robot at the same points."""
    assert scene.motion is not None
    motion = replace(scene.motion, robot=change(scene.motion.robot))
    return replace(scene, motion=motion), motion


def with_shape(robot: DrawnRobot) -> DrawnRobot:
    return replace(robot, shapes=(DrawnShape((0, 1), 0.1),))


def with_radius(robot: DrawnRobot) -> DrawnRobot:
    return replace(robot, rods=tuple(replace(rod, radius=0.1) for rod in robot.rods))


@pytest.mark.parametrize(
    ("change", "mark", "words"),
    [
        (with_shape, "solid", "collision shapes are grey areas"),
        (with_radius, "capsule", "Grey bands along rods"),
    ],
)
def test_shapes_of_robots_are_explained_where_they_are(
    evidence_on: On, change: Change, mark: str, words: str
) -> None:
    scene = motion_scene(evidence_on("turner"))
    changed, motion = drawn_with(scene, change)
    picture = motion_picture(changed, motion, 1.0, ["B"], "Table")
    assert mark in explained(picture)
    assert explained(legend([changed])) == explained(picture)
    assert words in robot_caption([changed])
    assert words not in robot_caption([scene])
    # One robot of a mission with shapes is enough, whichever it is.
    assert mark in explained(legend([scene, changed]))
    assert words in robot_caption([scene, changed])
