"""The motions of a mission in sequence, in one animation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from srgc.render.html_text import json_script, text
from srgc.render.svg import fitted
from srgc.report.animation import (
    controls,
    magnified,
    motion_picture,
    poses,
    readings,
    tube_caption,
)
from srgc.report.evidence import Evidence
from srgc.report.legend import legend, robot_caption
from srgc.report.missions.mission_evidence import MissionEvidence
from srgc.report.missions.robots_section import change_words
from srgc.report.motion_data import scene_data
from srgc.report.motion_scene import (
    MOST_NUMBERS,
    MotionScene,
    RobotMotion,
    motion_scene,
    seen_corners,
)
from srgc.results.found_design import FoundDesign

FEWEST_NUMBERS = 8_000
"""The fewest coordinates for each of many motions, so that none has only a few instants."""
SMALLEST = 0.4
"""Scenes that would be scaled by less than this in a common view keep their own views."""


def motions_section(evidence: MissionEvidence) -> str:
    """The section of the page; empty if there is no robot."""
    if not evidence.tasks:
        return ""
    scenes = _scenes(evidence)
    moved = [
        (number, task, task.found, scene, scene.motion)
        for number, (task, scene) in enumerate(zip(evidence.tasks, scenes, strict=True))
        if task.found is not None and scene.motion is not None
    ]
    parts = "".join(_part(evidence, number, s, motion) for number, _, _, s, motion in moved)
    said = "".join(_said(*each[1:]) for each in moved)
    stills = "".join(
        f"<h3>{text(task.task.name)}</h3>{poses(scene, motion, f'pose-{number}')}"
        for number, task, _, scene, motion in moved
    )
    data = [{**scene_data(s), "factor": magnified(m.tube, s.view)} for _, _, _, s, m in moved]
    title = "The motion" if len(moved) == 1 else "The motions, one after the other"
    return (
        f'<section id="motion"><h2>{title}</h2><figure>{parts}{_jumps(evidence, scenes)}'
        f"{controls(scenes)}{said}{legend(scenes)}"
        f"<figcaption>{robot_caption(scenes)}</figcaption></figure>"
        f'<div class="stills">{stills}</div>{json_script("motion-data", data)}</section>'
    )


def _jumps(evidence: MissionEvidence, scenes: Sequence[MotionScene]) -> str:
    """Buttons that start a task, as wide as the task is long; empty for a single task."""
    if len(scenes) == 1:
        return ""
    buttons = "".join(
        f'<button type="button" data-part="{number}" style="flex-grow:{scene.motion.steps}" '
        f'aria-pressed="false">{text(task.task.name)}</button>'
        for number, (task, scene) in enumerate(zip(evidence.tasks, scenes, strict=True))
        if scene.motion is not None
    )
    return f'<div class="jumps screen-only" role="group" aria-label="Tasks">{buttons}</div>'


def _scenes(evidence: MissionEvidence) -> list[MotionScene]:
    """The scenes of the tasks, all in one view if that shows each of them well."""
    most = max(FEWEST_NUMBERS, MOST_NUMBERS // len(evidence.tasks))
    scenes = [motion_scene(task, most) for task in evidence.tasks]
    if len({scene.dimension for scene in scenes}) > 1:
        return scenes
    corners = [seen_corners(scene.shapes, scene.motion) for scene in scenes]
    view = fitted([each for some in corners for each in some])
    if any(view.scale < SMALLEST * scene.view.scale for scene in scenes):
        return scenes
    return [replace(scene, view=view) for scene in scenes]


def _part(evidence: MissionEvidence, number: int, scene: MotionScene, motion: RobotMotion) -> str:
    """A task with its picture, which a script shows when it is due."""
    task = evidence.tasks[number]
    name, word = text(task.task.name), () if task.found is None else task.found.derivation.word
    factor = magnified(motion.tube, scene.view)
    place = f", task {number + 1} of {len(evidence.tasks)}" if len(evidence.tasks) > 1 else ""
    return (
        f'<div class="part" data-task="{name}"><p class="at"><b>{name}</b>{place}'
        f"{_rebuilt(evidence, number)}</p>"
        f"{motion_picture(scene, motion, factor, word, task.workspace.name)}</div>"
    )


def _said(task: Evidence, found: FoundDesign, scene: MotionScene, motion: RobotMotion) -> str:
    """The values at the current time of the animation, and the meaning of the tube."""
    factor = magnified(motion.tube, scene.view)
    tube = tube_caption(motion.tube, factor, repeats=task.task.repeat)
    values = readings(found.derivation.word, found.model.dofs, motion)
    return f'<div class="said">{values}<p class="soft">{tube}</p></div>'


def _rebuilt(evidence: MissionEvidence, number: int) -> str:
    """The changes before the task."""
    mission = evidence.mission
    step = mission.steps[number]
    if step is None:
        return ""
    if number:
        old = mission.robots[number - 1].claim.word
    else:
        old = () if mission.before is None else mission.before.word
    new = mission.robots[number].claim.word
    said = "; ".join(change_words(step, old, new, mission.program.modules))
    return f'<span class="soft">: {text(said or "the robot is as before")}</span>'
