"""Places labels on or beside the things they name, inside the picture, without overlap.

Labels are placed one after the other, in the given order, each at the free place with the least
cost.  Candidates are the requested place, rings around the named thing, and, if all of these are
taken, a grid over the whole picture.  A place is free if it lies within the picture and overlaps no
label; distance costs, and so does covering the drawing.  The scripts of a report's page place
labels of spatial scenes in the same way (``report/assets/labels.js``). Source: greedy placement
over candidates, as in J. Christensen, J. Marks, S. Shieber: An Empirical Study of Algorithms for
Point-Feature Label Placement, ACM Transactions on Graphics 14 (1995).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from srgc.render.svg import line_path
from srgc.render.text_size import block_size

GAP = 2.0
"""The least distance between labels."""
RINGS = (4.0, 12.0, 24.0, 40.0, 60.0)
"""Distances between the named thing and its label."""
DIRECTIONS = 16
NEAR = 12.0
"""A label within this distance of what it names needs no leader line."""
COVERED, CROSSED = 8.0, 40.0
"""The costs of a point of the drawing under a label, and of a point of its leader under a label."""
CONFUSED, BESIDE = 30.0, 6.0
"""The cost of a label at most so far from another thing, whose name it seems to be."""
PROBES = 12
"""The number of points checked on a leader."""
_GRID = 4_000


@dataclass(frozen=True, slots=True)
class Label:
    """A text to place.

    Attributes:
        at: the point (2,) that it names.
        size: its width and height.
        home: the preferred centre (2,); None for a place beside the point.
        reach: half the width and height of the named thing, which a label beside it avoids.
        others: rectangles (m, 4) of things with other names: left, top, right, bottom.
    """

    at: Array
    size: tuple[float, float]
    home: Array | None = None
    reach: tuple[float, float] = (0.0, 0.0)
    others: Array = field(default_factory=lambda: np.zeros((0, 4)))


class LabelPlacer:
    """Places labels in a picture of a given size; ``drawn`` (m, 2) are points to keep visible."""

    def __init__(self, size: tuple[float, float], drawn: Array | None = None) -> None:
        self.size = np.array(size)
        self.drawn: Array = np.zeros((0, 2)) if drawn is None else drawn
        self.taken: Array = np.zeros((0, 4))

    def take(self, boxes: Array) -> None:
        """Keep labels off rectangles (m, 4): left, top, right, bottom."""
        self.taken = np.concatenate([self.taken, boxes])

    def place(self, label: Label) -> Array | None:
        """Place a label and return its centre (2,); None if no place is free.

        Things outside the picture get no label.
        """
        if not ((label.at >= 0) & (label.at <= self.size)).all():
            return None
        half = np.array(label.size) / 2
        if label.home is not None and self._free(label.home[None, :], half)[0]:
            return self._taken(label.home, label, half)
        for candidates in self._candidates(label, half):
            free = candidates[self._free(candidates, half)]
            if len(free):
                best: Array = free[int(self._cost(free, label, half).argmin())]
                return self._taken(best, label, half)
        return None

    def _candidates(self, label: Label, half: Array) -> Iterator[Array]:
        """Centres to choose from, nearer ones first."""
        yield _rings(label, half)
        yield self._grid(half)

    def _taken(self, middle: Array, label: Label, half: Array) -> Array:
        self.take(np.concatenate([middle - half, middle + half])[None, :])
        ends = leader_ends(label, middle)
        if ends is not None:
            self.drawn = np.concatenate([self.drawn, _between(ends[0], ends[1][None, :])[0]])
        return middle

    def _free(self, middles: Array, half: Array) -> NDArray[np.bool_]:
        """Which labels with these centres (k, 2) lie in the picture and overlap no other."""
        low, high = middles - half, middles + half
        inside = np.all((low >= 0) & (high <= self.size), axis=1)
        left, top, right, bottom = self.taken.T
        meets = (
            (low[:, :1] < right + GAP) & (high[:, :1] > left - GAP)
            & (low[:, 1:] < bottom + GAP) & (high[:, 1:] > top - GAP)
        )  # fmt: skip
        free: NDArray[np.bool_] = inside & ~np.any(meets, axis=1)
        return free

    def _cost(self, middles: Array, label: Label, half: Array) -> Array:
        off = np.maximum(np.abs(middles - label.at) - half - np.array(label.reach), 0.0)
        inside = (np.abs(self.drawn[None] - middles[:, None]) < half + 2).all(axis=2).sum(axis=1)
        ends = np.clip(label.at, middles - half, middles + half)
        probes = _between(label.at, ends)[:, :, None, :]
        within = (probes > self.taken[:, :2]) & (probes < self.taken[:, 2:])
        crossed = within.all(axis=3).sum(axis=(1, 2))
        low, high = middles[:, None] - half - BESIDE, middles[:, None] + half + BESIDE
        near = (low < label.others[:, 2:]) & (high > label.others[:, :2])
        confused = near.all(axis=2).sum(axis=1)
        cost: Array = np.hypot(*off.T) + COVERED * inside + CROSSED * crossed + CONFUSED * confused
        return cost

    def _grid(self, half: Array) -> Array:
        """Centres over the whole picture, half a label apart, or farther to limit their number."""
        room = np.maximum(self.size - 2 * half, 0.0)
        step = half * max(1.0, float(np.sqrt((room / half).prod() / _GRID)))
        xs, ys = (
            np.arange(h, s - h + 1e-9, d) for h, s, d in zip(half, self.size, step, strict=True)
        )
        return np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1).reshape(-1, 2)


def _rings(label: Label, half: Array) -> Array:
    """Centres of labels around the named thing, nearest first."""
    angles = 2 * np.pi * (np.arange(DIRECTIONS) - DIRECTIONS / 4) / DIRECTIONS
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = half + np.array(label.reach)
    # At distance ``scale`` the label touches the named thing; the rings add to that.
    scale = (1 / np.maximum(np.abs(ways) / reach, 1e-9)).min(axis=1)
    return np.concatenate([label.at + ways * (scale + ring)[:, None] for ring in RINGS])


def _between(start: Array, ends: Array) -> Array:
    """Points (k, PROBES, 2) on the lines from a point to others (k, 2)."""
    parts = np.linspace(0, 1, PROBES)[None, :, None]
    points: Array = start + parts * (ends[:, None, :] - start)
    return points


def leader_ends(label: Label, middle: Array) -> Array | None:
    """The ends (2, 2) of the line from the named point to its label; None if they are near."""
    half = np.array(label.size) / 2
    end = np.clip(label.at, middle - half, middle + half)
    off = np.maximum(np.abs(middle - label.at) - half - np.array(label.reach), 0.0)
    return None if float(np.hypot(*off)) < NEAR else np.stack([label.at, end])


def leader(label: Label, middle: Array) -> str:
    """The leader line from the named point to a label at ``middle`` (2,); empty if it is near."""
    ends = leader_ends(label, middle)
    return "" if ends is None else f'<path class="leader" d="{line_path(ends)}"/>'


def along(line: Array, apart: float = 4.0) -> Array:
    """Points (k, 2) on a line (m, 2), about ``apart`` from one to the next, to keep visible."""
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.linspace(0.0, ends[-1], 1 + int(ends[-1] / apart))
    return np.stack([np.interp(at, ends, line[:, i]) for i in (0, 1)], axis=1)


def sized(at: Array, lines: Sequence[str], size: float, *, bold: bool = False) -> Label:
    """A label for a point (2,), with the size of its lines of text."""
    return Label(at, block_size(lines, size, bold=bold))
