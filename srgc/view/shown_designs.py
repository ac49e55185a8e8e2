"""The designs of result folders that a page shows side by side, with their tubes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from srgc.exports.scenes.design_scene import DesignScene, design_scene
from srgc.faults import NoAnswer
from srgc.report.motion_scene import TubeBoxes, tube_boxes
from srgc.results.found_design import found_design, found_tube
from srgc.results.mission_folder import mission_folder
from srgc.results.mission_refusal import is_mission_folder
from srgc.results.no_robot import no_robot

FREQUENCY = 60
"""The least number of instants per second between which the motion is interpolated."""
APART = 0.15
"""The gap between two designs, as a share of the extent of a design."""


@dataclass(frozen=True, slots=True, eq=False)
class ShownDesign:
    """A design with its label; the page shows it shifted by ``offset`` (3,) in metres."""

    label: str
    scene: DesignScene
    tube: TubeBoxes | None
    offset: Array

    @property
    def bounds(self) -> Array:
        """The lower and upper corner (2, 3) of what is shown, at its place on the page."""
        found: Array = self.scene.bounds + self.offset
        return found


@dataclass(frozen=True, slots=True, eq=False)
class ShownDesigns:
    """All designs of a page, and notes on what it does not show."""

    designs: tuple[ShownDesign, ...]
    notes: tuple[str, ...]


def shown_designs(folders: Sequence[Path], *, tubes: bool = True) -> ShownDesigns:
    """The designs of result folders, and of all tasks of missions, in order of increasing y.

    Args:
        folders: at least one folder.
        tubes: whether to enclose the motions, which takes as long as ``srgc verify``.

    Raises:
        UsageFault: a folder has no design, or its numbers are too large.
    """
    found, notes = list[ShownDesign](), list[str]()
    for label, folder in _labelled(folders):
        design = found_design(folder)
        scene = design_scene(design, FREQUENCY)
        notes += [f"{label}: {note}" for note in scene.notes]
        tube = None
        if tubes:
            try:
                tube = tube_boxes(found_tube(folder), len(design.model.effectors))
            except NoAnswer as answer:
                notes.append(f"{label} has no tube: {answer}")
        offset = np.zeros(3)
        if found:
            low, high = scene.bounds[:, 1]
            offset[1] = found[-1].bounds[1, 1] + APART * (high - low) - low
        found.append(ShownDesign(label, scene, tube, offset))
    return ShownDesigns(tuple(found), tuple(notes))


def _labelled(folders: Sequence[Path]) -> Iterator[tuple[str, Path]]:
    """The folders of single designs, each with a unique label."""
    names = [folder.resolve().name for folder in folders]
    for folder, name in zip(folders, names, strict=True):
        label = name if names.count(name) == 1 else str(folder)
        if not is_mission_folder(folder):
            yield label, folder
            continue
        mission = mission_folder(folder)
        if not mission.robots:
            raise no_robot(folder, mission.verdict)
        yield from ((f"{label}: {task}", mission.of_task(task)) for task in mission.mission.tasks)
