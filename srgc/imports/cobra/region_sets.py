"""Convert tolerances of poses to regions for positions and clauses for orientations."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from srgc.imports.cobra.pose_data import Tolerance, ToleratedPose
from srgc.imports.module_set import Turn, turns_of
from srgc.imports.quantities import Quantities, placed_text

DEFAULT_LENGTH, DEFAULT_ANGLE = 1e-3, math.radians(0.5)
"""Timor's default tolerances of a pose: 1 mm along each axis, and half a degree."""
THIN = 1e-4
"""An interval of no width becomes twice this wide (m), since a region needs an interior."""
ALIGNED = 1e-9
"""A direction lies along an axis if its other entries are at most this."""
HALF_TURN = math.pi - 1e-6
POSITIONS = {"x": 0, "y": 1, "z": 2}
ROTATIONS = {"N_x": 0, "N_y": 1, "N_z": 2}


@dataclass(frozen=True, slots=True)
class Slab:
    """The points whose coordinate along a direction (3,) in the world lies in an interval (m)."""

    direction: NDArray[np.float64]
    low: float
    high: float


@dataclass(slots=True)
class RegionSets:
    """Writes sets of positions and orientations; ``remarks`` say how they differ from the task.

    ``bounds`` (3, 2) of the workspace bound what a tolerance leaves unbounded.
    """

    bounds: NDArray[np.float64]
    remarks: list[str]
    write: Quantities = field(default_factory=Quantities)

    # --- Positions --------------------------------------------------------------------------------

    def region(self, pose: ToleratedPose, *, flat: bool) -> str:
        """The set of positions; a polytope if ``flat``, as formulas require."""
        balls = _bounded(pose, "r_sph")
        tubes = _bounded(pose, "r_cyl")
        self._unsaid(pose)
        slabs = list(self._slabs(pose))
        if balls and not tubes and not slabs:
            return self._ball(pose, min(balls, key=lambda each: each.high), flat=flat)
        if tubes and not balls and not flat and _along(tubes[0].axes[:, 2], slabs):
            return self._cylinder(pose, tubes, slabs)
        for each in balls:
            slabs += self._cube(pose, each)
        for each in tubes:
            slabs += self._square(pose, each)
        if not slabs and not any(each.projection in POSITIONS for each in pose.tolerances):
            slabs = self._default(pose)
        return self._slabs_text(slabs)

    def _unsaid(self, pose: ToleratedPose) -> None:
        for each in pose.tolerances:
            if each.projection in ("r_sph", "r_cyl") and each.low > 0:
                self.remarks.append(f"{each.place.path}: positions nearer than {each.low:g} m")
            known = (*POSITIONS, *ROTATIONS, "r_sph", "r_cyl", "Theta_R")
            if each.projection not in known:
                self.remarks.append(f"{each.place.path}: a tolerance of {each.projection[:40]}")

    def _slabs(self, pose: ToleratedPose) -> Iterator[Slab]:
        for each in pose.tolerances:
            if each.projection not in POSITIONS:
                continue
            direction = each.axes[:, POSITIONS[each.projection]]
            low, high = each.low, each.high
            if high - low < 2 * THIN / 10:
                low, high = low - THIN, high + THIN
                self.remarks.append(f"{each.place.path}: a tolerance of no width became 0.2 mm")
            if math.isfinite(low) or math.isfinite(high):
                at = float(direction @ pose.at)
                yield Slab(direction, at + low, at + high)

    def _default(self, pose: ToleratedPose) -> list[Slab]:
        if pose.tolerances:
            return []
        self.remarks.append(
            f"{pose.place.path}: a pose without tolerances has 1 mm and 0.5 deg, as in Timor"
        )
        return _box_around(pose, pose.nominal[:3, :3], DEFAULT_LENGTH)

    def _ball(self, pose: ToleratedPose, of: Tolerance, *, flat: bool) -> str:
        if flat:
            return self._slabs_text(self._cube(pose, of))
        return f"ball {self._point(pose.at)} radius {self.write.length(self._radius(of))}"

    def _radius(self, of: Tolerance) -> float:
        """The radius of a ball or a tube, which needs an interior."""
        if of.high < THIN / 10:
            self.remarks.append(f"{of.place.path}: a radius of 0 became 0.1 mm")
            return THIN
        return of.high

    def _cube(self, pose: ToleratedPose, of: Tolerance) -> list[Slab]:
        self.remarks.append(f"{of.place.path}: a cube within the ball of {of.high:g} m")
        return _box_around(pose, np.eye(3), inner(self._radius(of) / math.sqrt(3)))

    def _square(self, pose: ToleratedPose, of: Tolerance) -> list[Slab]:
        self.remarks.append(f"{of.place.path}: a square within the circle of {of.high:g} m")
        return _box_around(pose, of.axes[:, :2], inner(self._radius(of) / math.sqrt(2)))

    def _cylinder(self, pose: ToleratedPose, tubes: Sequence[Tolerance], slabs: list[Slab]) -> str:
        axis, far = tubes[0].axes[:, 2], float(np.ptp(self.bounds, axis=1).max())
        at = float(axis @ pose.at)
        low = max([each.low for each in _towards(axis, slabs)], default=at - far)
        high = min([each.high for each in _towards(axis, slabs)], default=at + far)
        ends = (
            pose.at + (height - at) * axis for height in (max(low, at - far), min(high, at + far))
        )
        radius = self._radius(min(tubes, key=lambda each: each.high))
        points = ", ".join(self._point(end) for end in ends)
        return f"cylinder {points} radius {self.write.length(radius)}"

    def _slabs_text(self, slabs: Sequence[Slab]) -> str:
        """A box if all directions lie along axes of the world, otherwise a polytope."""
        box = self.bounds.copy()
        skew = list[Slab]()
        for each in slabs:
            axis = int(np.argmax(np.abs(each.direction)))
            if np.abs(np.delete(each.direction, axis)).max() > ALIGNED:
                skew.append(each)
                continue
            low, high = (
                (each.low, each.high) if each.direction[axis] > 0 else (-each.high, -each.low)
            )
            box[axis] = max(box[axis, 0], low), min(box[axis, 1], high)
        if not skew:
            return self.box(box)
        closed = [each.direction for each in slabs if math.isfinite(each.high - each.low)]
        spans = np.linalg.matrix_rank(np.array([*closed, np.zeros(3)]), 1e-6) == 3
        sides = [
            Slab(axis, low, high)
            for axis, (low, high), kept in zip(
                np.eye(3), box.tolist(), self.bounds.tolist(), strict=True
            )
            if not spans or [low, high] != kept
        ]
        rows = [row for each in (*skew, *sides) for row in _inequalities(each)]
        return f"polytope {{ {'; '.join(rows)} }} m"

    def box(self, sides: NDArray[np.float64]) -> str:
        """The text of a box with these bounds (3, 2) in m."""
        texts, unit = self.write.lengths(sides.ravel().tolist())
        pairs = zip(texts[::2], texts[1::2], strict=True)
        return f"box {' x '.join(f'[{low}, {high}]' for low, high in pairs)} {unit}"

    def _point(self, at: NDArray[np.float64]) -> str:
        return self.write.vector(at.tolist())

    # --- Orientations -----------------------------------------------------------------------------

    def turned(self, pose: ToleratedPose) -> str:
        """The clauses on orientation, as written after a region; empty if there are none."""
        found = [each for each in pose.tolerances if each.projection == "Theta_R"]
        most = min([each.high for each in found], default=math.pi)
        clauses = [] if most > HALF_TURN else [self._oriented(pose, most)]
        clauses += self._axes(pose)
        if not pose.tolerances:
            clauses.append(self._oriented(pose, DEFAULT_ANGLE))
        return "".join(f" {clause}" for clause in clauses)

    def _oriented(self, pose: ToleratedPose, angle: float) -> str:
        turns = [
            f"rot({turn.axis}, {text})"
            for turn in turns_of(pose.nominal[:3, :3])
            if isinstance(turn, Turn) and (text := self.write.angle(turn.angle)) != "0 rad"
        ]
        frame = " * ".join(turns) or "rot(z, 0 deg)"
        return f"oriented {frame} within {self.write.angle(angle)}"

    def _axes(self, pose: ToleratedPose) -> Iterator[str]:
        """Clauses for bounds on the entries of the rotation vector: on all three, or on two."""
        bounds = dict[int, float]()
        for each in pose.tolerances:
            if each.projection not in ROTATIONS or min(-each.low, each.high) >= HALF_TURN:
                continue
            if each.low >= 0 or each.high <= 0 or not np.allclose(each.axes, pose.nominal[:3, :3]):
                self.remarks.append(f"{each.place.path}: turns about an axis, of another form")
                continue
            number = ROTATIONS[each.projection]
            bounds[number] = min(bounds.get(number, math.pi), -each.low, each.high)
        if len(bounds) == 3:
            self.remarks.append(f"{pose.place.path}: turns within the least of three bounds")
            yield self._oriented(pose, min(bounds.values()))
        elif len(bounds) == 2:
            (free,) = {0, 1, 2} - set(bounds)
            # If the free axis tilts by t, the rest of the rotation vector is at most pi sin(t / 2)
            # long, whatever the rotation about that axis.
            tilt = 2 * math.asin(min(1.0, min(bounds.values()) / math.pi))
            direction = ", ".join(map(placed_text, pose.nominal[:3, free].tolist()))
            self.remarks.append(f"{pose.place.path}: a tilt within two bounds of turns")
            yield f"aligned {'xyz'[free]} to ({direction}) within {self.write.angle(tilt)}"
        elif bounds:
            self.remarks.append(f"{pose.place.path}: one bound of turns alone")


def is_turned(pose: ToleratedPose) -> bool:
    """Whether the pose may restrict the orientation."""
    turns = (*ROTATIONS, "Theta_R")
    return not pose.tolerances or any(each.projection in turns for each in pose.tolerances)


def inner(length: float) -> float:
    """A length rounded down to tenths of a millimetre, or if it is small to micrometres."""
    parts = 1e4 if length >= 1e-3 else 1e6
    return math.floor(length * parts) / parts


def _box_around(pose: ToleratedPose, axes: NDArray[np.float64], half: float) -> list[Slab]:
    found = list[Slab]()
    for direction in axes.T:
        at = float(direction @ pose.at)
        found.append(Slab(direction, at - half, at + half))
    return found


def _bounded(pose: ToleratedPose, projection: str) -> list[Tolerance]:
    """The tolerances of a projection that have an upper limit."""
    return [
        each
        for each in pose.tolerances
        if each.projection == projection and math.isfinite(each.high)
    ]


def _along(axis: NDArray[np.float64], slabs: Sequence[Slab]) -> bool:
    return len(list(_towards(axis, slabs))) == len(slabs)


def _towards(axis: NDArray[np.float64], slabs: Sequence[Slab]) -> Iterator[Slab]:
    """The slabs parallel to an axis, with their directions along it."""
    for each in slabs:
        along = float(each.direction @ axis)
        if along > 1 - ALIGNED:
            yield each
        elif along < ALIGNED - 1:
            yield Slab(-each.direction, -each.high, -each.low)


def _inequalities(slab: Slab) -> Iterator[str]:
    terms = list[str]()
    for factor, name in zip(slab.direction.tolist(), "xyz", strict=True):
        text = placed_text(abs(factor))
        if text == "0":
            continue
        sign = "-" if factor < 0 else "+" if terms else ""
        terms.append(f"{sign} {name}" if text == "1" else f"{sign} {text} * {name}")
    left = " ".join(terms).strip()
    if math.isfinite(slab.low):
        yield f"{left} >= {placed_text(slab.low)}"
    if math.isfinite(slab.high):
        yield f"{left} <= {placed_text(slab.high)}"
