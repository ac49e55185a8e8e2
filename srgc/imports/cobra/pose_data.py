"""Read poses with tolerances, and the frames that they are relative to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from srgc.imports.json_place import Place
from srgc.imports.timor.geometry_data import IDENTITY

MOST_FRAMES = 1000
WORLD, NOMINAL = "world", "nominal"


@dataclass(frozen=True, slots=True)
class Tolerance:
    """The interval for one projection of a pose; ``axes`` (3, 3) are its frame in the world."""

    projection: str
    low: float
    high: float
    axes: NDArray[np.float64]
    place: Place


@dataclass(frozen=True, slots=True)
class ToleratedPose:
    """A pose in the world (4, 4), and intervals for deviations from it."""

    nominal: NDArray[np.float64]
    tolerances: Sequence[Tolerance]
    place: Place

    @property
    def at(self) -> NDArray[np.float64]:
        """The position (3,) in m."""
        return self.nominal[:3, 3]


class Frames:
    """The frames of a task by name, in the world."""

    def __init__(self, place: Place) -> None:
        self.known: dict[str, NDArray[np.float64]] = {WORLD: np.eye(4)}
        if place.value == []:
            return
        waiting: Mapping[str, Place] = dict(place.items())
        if len(waiting) > MOST_FRAMES:
            raise place.fault(f"{len(waiting):,} frames; at most {MOST_FRAMES:,} are read")
        while waiting:
            left = dict[str, Place]()
            for name, entry in waiting.items():
                entry.keys(("parent", "transformation"))
                parent = self.known.get(entry.get("parent", WORLD).text())
                if parent is None:
                    left[name] = entry
                else:
                    pose = entry.get("transformation", IDENTITY).pose()
                    self.known[name] = parent @ pose
            if len(left) == len(waiting):
                raise next(iter(left.values()))["parent"].fault("it leads to no frame of the world")
            waiting = left

    def pose(self, place: Place) -> ToleratedPose:
        """Read a pose with its tolerances.

        Raises:
            UsageFault: the pose violates the schema, or names an unknown frame.
        """
        place.keys(
            ("nominal", "nominalParent", "toleranceProjection", "tolerance", "toleranceFrame")
        )
        parent = self._named(place.get("nominalParent", WORLD))
        nominal = parent @ place["nominal"].pose()
        projections = place.get("toleranceProjection", []).entries()
        intervals = place.get("tolerance", []).entries()
        frames = place.get("toleranceFrame", [NOMINAL] * len(projections)).entries()
        if not len(projections) == len(intervals) == len(frames):
            raise place["tolerance"].fault(
                f"{len(projections)} projections, {len(intervals)} tolerances and {len(frames)} "
                "frames; there has to be one of each"
            )
        found = list[Tolerance]()
        for projection, interval, frame in zip(projections, intervals, frames, strict=True):
            low, high = (entry.limit() for entry in _two(interval))
            if low > high:
                raise interval.fault(f"{high:g} is below {low:g}")
            named = nominal if frame.text() == NOMINAL else self._named(frame)
            found.append(Tolerance(projection.text(), low, high, named[:3, :3], projection))
        return ToleratedPose(nominal, found, place)

    def _named(self, place: Place) -> NDArray[np.float64]:
        name = place.text()
        if name not in self.known:
            raise place.fault(f"there is no frame {name[:40]!r}")
        return self.known[name]


def _two(place: Place) -> Sequence[Place]:
    entries = place.entries()
    if len(entries) != 2:
        raise place.fault(f"expected a lower and an upper bound, found {len(entries)} numbers")
    return entries
