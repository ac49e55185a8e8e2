"""The content of the animation as numbers: shapes, points over time, cells and the tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from srgc.render.robot_drawing import DrawnRobot, MotionSamples, drawn_robot, motion_samples
from srgc.render.svg import View, fitted
from srgc.render.workspace_drawing import WorkspaceShape, workspace_shapes
from srgc.report.evidence import Evidence
from srgc.report.nearest_robot import NearestRobot
from srgc.report.tables import Trajectory
from srgc.results.found_design import FoundDesign

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube


MOST_BOXES, MOST_WIDTHS = 240, 90
"""For a tube, the most boxes of intervals, and the most instants with a width."""
MOST_NUMBERS = 40_000
"""The most coordinates of points on a page; the number of instants depends on it."""
MOST_INSTANTS = 900
FEWEST_INSTANTS = 40
MOST_CELLS = 400
ROOM_IN_SPACE = 0.12
"""In space, the room around regions and motion, as a share of their extent."""
VAST = 4.0
"""Planar bounds this many times as wide as their content are not shown completely."""


@dataclass(frozen=True, slots=True)
class TubeBoxes:
    """Boxes that contain the effectors.

    Shapes: ``times`` (m + 1,) are the ends of m intervals of time; ``boxes`` (m, e, d, 2) contain
    the effectors throughout each; ``instants`` (i,); ``half_widths`` (i, e, d) are half the sides
    of the boxes at the instants, in metres.  ``segments`` is the number of intervals in the proof.
    """

    times: Array
    boxes: Array
    instants: Array
    half_widths: Array
    segments: int
    disturbed: bool


@dataclass(frozen=True, slots=True)
class CellVisit:
    """From sample ``since`` on, an effector is in the cell with this name."""

    since: int
    cell: str


@dataclass(frozen=True)
class RobotMotion:
    """A robot in motion.

    Shapes: ``times`` (K,) in seconds, ``q`` (K, n), ``points`` (K, P, d) in metres.  ``visits`` has
    the cells of every effector.  ``steps`` is the number of steps of the task, each ``step`` s
    long.
    """

    robot: DrawnRobot
    times: Array
    q: Array
    points: Array
    visits: tuple[tuple[CellVisit, ...], ...]
    steps: int
    step: float
    tube: TubeBoxes | None

    @property
    def tips(self) -> Array:
        """The effectors' positions, shape (K, e, d)."""
        found: Array = self.points[:, list(self.robot.effectors)]
        return found


@dataclass(frozen=True)
class MotionScene:
    """The workspace, the moving robot if there is one, and a view in which both fit."""

    dimension: int
    shapes: tuple[WorkspaceShape, ...]
    motion: RobotMotion | None
    view: View

    @property
    def beyond(self) -> bool:
        """Whether the bounds of the workspace extend beyond the picture."""
        corners = self.view.project(self.shapes[0].corners)
        size = np.array([self.view.width, self.view.height])
        return bool((corners < -0.5).any() or (corners > size + 0.5).any())


def motion_scene(evidence: Evidence, most: int = MOST_NUMBERS) -> MotionScene:
    """The scene of the animation of a result; only the workspace if there is no robot.

    ``most`` is about the largest number of coordinates of points in it.
    """
    motion = None
    if evidence.found is not None and evidence.trajectory is not None:
        tube = None
        if evidence.tube is not None:
            tube = tube_boxes(evidence.tube, len(evidence.found.model.effectors))
        motion = robot_motion(evidence.found, evidence.trajectory, tube, most=most)
    if evidence.verdict == "unknown":
        motion = nearest_motion(evidence, most)
    shapes = _shapes(evidence, motion)
    return MotionScene(
        evidence.workspace.dimension, shapes, motion, fitted(seen_corners(shapes, motion))
    )


def _shapes(evidence: Evidence, motion: RobotMotion | None) -> tuple[WorkspaceShape, ...]:
    """Bounds, cells and regions; if there are many cells, only those that are visited."""
    shapes = workspace_shapes(evidence.workspace, evidence.cells.cells)
    if len(evidence.cells.cells) <= MOST_CELLS:
        return shapes
    visits = () if motion is None else motion.visits
    visited = {visit.cell for each in visits for visit in each}
    return tuple(shape for shape in shapes if shape.kind != "cell" or shape.name in visited)


def robot_motion(
    found: FoundDesign,
    trajectory: Trajectory,
    tube: TubeBoxes | None = None,
    *,
    most: int = MOST_NUMBERS,
) -> RobotMotion:
    """The motion of a design at instants close enough to interpolate in a picture.

    Its points have about ``most`` coordinates at most.
    """
    robot, samples = _drawn(found.model, found.theta, trajectory, most)
    visits = tuple(_visits(path) for path in found.claim.path)
    return RobotMotion(
        robot,
        samples.times,
        samples.coordinates,
        robot.points(samples.coordinates),
        visits,
        len(trajectory.t) - 1,
        float(found.task.step),
        tube,
    )


def nearest_motion(evidence: Evidence, most: int = MOST_NUMBERS) -> RobotMotion | None:
    """The motion that came nearest to a design, or None; the cells that it visits are not known."""
    kept = evidence.nearest
    if kept is None:
        return None
    robot, samples = _drawn(kept.model, kept.theta, kept, most)
    return RobotMotion(
        robot,
        samples.times,
        samples.coordinates,
        robot.points(samples.coordinates),
        ((),) * len(kept.model.effectors),
        len(kept.t) - 1,
        float(evidence.task.step),
        None,
    )


def _drawn(
    model: RobotModel, theta: Array, motion: Trajectory | NearestRobot, most: int
) -> tuple[DrawnRobot, MotionSamples]:
    """The drawing of a robot, and the instants at which it is drawn."""
    robot = drawn_robot(model, theta)
    first = robot.points(motion.q[:1])
    instants = int(np.clip(most // max(first.size, 1), FEWEST_INSTANTS, MOST_INSTANTS))
    turning = np.array([dof.kind == "revolute" for dof in model.dofs], dtype=bool)
    return robot, motion_samples(motion.t, motion.q, motion.qd, turning=turning, most=instants)


def _visits(path: Sequence[str]) -> tuple[CellVisit, ...]:
    """The times at which the cell of a path changes."""
    found, sample = [], 0
    for cell, run in groupby(path):
        found.append(CellVisit(sample, cell))
        sample += len(list(run))
    return tuple(found)


def seen_corners(shapes: Sequence[WorkspaceShape], motion: RobotMotion | None) -> list[Array]:
    """Points (m, d) that a view has to contain: regions, motion, and bounds that are not vast."""
    bounds = shapes[0].corners
    inner = [shape.corners for shape in shapes if shape.kind not in ("bounds", "cell")]
    if motion is not None:
        inner.append(_moved(motion))
    if not inner:
        return [bounds]
    points = np.concatenate(inner)
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float((high - low).max())
    if len(low) == 2 and float(np.ptp(bounds, axis=0).max()) <= VAST * extent:
        return [*inner, bounds]
    room = extent * (1.0 if len(low) == 2 else ROOM_IN_SPACE)
    return [*inner, np.clip(bounds, low - room, high + room)]


def _moved(motion: RobotMotion) -> Array:
    """The extent of the whole motion, without the tips of axes, which are not part of the robot."""
    found = motion.robot.own(motion.points).reshape(-1, motion.points.shape[2])
    return np.stack([found.min(axis=0), found.max(axis=0)])


def tube_boxes(tube: CertifiedTube, effectors: int) -> TubeBoxes:
    """The boxes of a tube; intervals are merged if there are many."""
    points = tube.points[:, :effectors]
    count = len(points)
    groups = np.array_split(np.arange(count), min(count, MOST_BOXES))
    boxes = np.stack(
        [
            np.stack([points[group, ..., 0].min(axis=0), points[group, ..., 1].max(axis=0)], -1)
            for group in groups
        ]
    )
    ends = [0, *(int(group[-1]) + 1 for group in groups)]
    picked = np.unique(np.linspace(0, count, MOST_WIDTHS).round().astype(int))
    instants = tube.times[picked]
    widths = np.stack([_half_widths(tube, float(time), effectors) for time in instants])
    return TubeBoxes(tube.times[ends], boxes, instants, widths, count, tube.disturbed)


def _half_widths(tube: CertifiedTube, time: float, effectors: int) -> Array:
    bounds = tube.points_at(time)[:effectors]
    found: Array = (bounds[..., 1] - bounds[..., 0]) / 2
    return found
