"""The legend of the animation, and what its marks of a robot mean: of all that is drawn."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from srgc.render.robot_drawing import is_thick
from srgc.render.workspace_drawing import CELL_SAMPLE, KIND_SAMPLES, set_sample
from srgc.report.motion_scene import MotionScene, RobotMotion

KIND_WORDS = {"obstacle": "obstacle", "target": "target", "region": "other region"}
TUBE_SAMPLE = '<path class="tube" d="M2 1h10v7h10v3h-10v-3h-10Z"/>'
"""The sample for the boxes of a tube."""
SHAPE_SAMPLE = '<path class="solid" stroke-width="10" d="M7 6h10Z"/>'
"""The sample for a shape of a robot."""
THICK_SAMPLE = (
    '<line class="capsule" stroke-width="10" x1="7" y1="6" x2="17" y2="6"/>'
    '<line class="rod" x1="7" y1="6" x2="17" y2="6"/>'
)
"""The sample for a rod that is drawn with its thickness."""


def legend(scenes: Sequence[MotionScene]) -> str:
    """The legend of the pictures: all that is in one of them, with or without a robot."""
    entries = [*_sets(scenes), *_motions(scenes), *_robots(scenes)]
    items = "".join(
        f'<li><svg class="scene" viewBox="0 0 24 12" aria-hidden="true">{sample}</svg>{says}</li>'
        for sample, says in entries
    )
    return f'<ul class="legend">{items}</ul>'


def _sets(scenes: Sequence[MotionScene]) -> Iterator[tuple[str, str]]:
    """The sets of the workspaces: samples of their marks, and what these are."""
    kinds = {shape.kind for scene in scenes for shape in scene.shapes}
    for kind, says in KIND_WORDS.items():
        if kind in kinds:
            yield KIND_SAMPLES[kind], says
    if "cell" in kinds:
        yield set_sample("cell"), "cell"
    yield set_sample("bounds"), "bounds of the workspace"


def _motions(scenes: Sequence[MotionScene]) -> Iterator[tuple[str, str]]:
    """What the effectors pass, and their paths."""
    motions = _moving(scenes)
    if any(any(motion.visits) for motion in motions):
        yield CELL_SAMPLE, "cell that an effector is in"
    if any(motion.tube is not None for motion in motions):
        yield TUBE_SAMPLE, "proved tube: the effector is in these boxes"
    if motions:
        yield '<path class="trail" d="M1 6h22"/>', "whole path of the effector"
        yield '<path class="trace" d="M1 6h22"/>', "path of the effector so far"


def _robots(scenes: Sequence[MotionScene]) -> Iterator[tuple[str, str]]:
    """The marks of robots for which the words of ``robot_caption`` are not enough."""
    if _with_shapes(scenes):
        yield SHAPE_SAMPLE, "collision shape of the robot"
    if _with_thick_rods(scenes):
        yield THICK_SAMPLE, "rod and its thickness"


def robot_caption(scenes: Sequence[MotionScene]) -> str:
    """The meanings of the marks of the robots in the pictures."""
    words = (
        "The robot at its real lengths: rods as thick lines, joints as circles (turning) and "
        "squares (sliding), effectors as rings, other bodies by their centres of mass as dots."
    )
    if _with_shapes(scenes):
        words += " Its collision shapes are grey areas."
    if _with_thick_rods(scenes):
        words += " Grey bands along rods are as wide as the rods are thick."
    if any(len(motion.robot.effectors) > 1 for motion in _moving(scenes)):
        words += " The numbers of effectors are on discs."
    if any(scene.dimension == 3 for scene in scenes):
        words += " A short line through a joint is its axis."
    return f"{words}{beyond_words(scenes)}"


def beyond_words(scenes: Sequence[MotionScene]) -> str:
    """A sentence if the bounds of a workspace are not within its picture, else nothing."""
    return " The bounds reach beyond the picture." if any(s.beyond for s in scenes) else ""


def _moving(scenes: Sequence[MotionScene]) -> list[RobotMotion]:
    return [scene.motion for scene in scenes if scene.motion is not None]


def _with_shapes(scenes: Sequence[MotionScene]) -> bool:
    return any(motion.robot.shapes for motion in _moving(scenes))


def _with_thick_rods(scenes: Sequence[MotionScene]) -> bool:
    return any(
        is_thick(rod, scene.view)
        for scene in scenes
        if scene.motion is not None
        for rod in scene.motion.robot.rods
    )
