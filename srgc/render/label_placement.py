"""Where labels stand: on or beside what they name, in the picture, and never on each other.

Labels are placed one after the other, in the order given: each where it costs least among the
places that are free.  Candidates are the place asked for, rings about what is named, and, where all
of these are taken, a grid over the whole picture.  Free is what lies within the picture and meets
no label; it costs to be far away, and to cover what is drawn.  The scripts of a report's page place
the labels of space in the same way (``report/assets/labels.js``).

Source: greedy placement over candidates, as in J. Christensen, J. Marks, S. Shieber: An Empirical
Study of Algorithms for Point-Feature Label Placement, ACM Transactions on Graphics 14 (1995).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from srgc.render.svg import line_path
from srgc.render.text_size import block_size

GAP = 2.0
"""Between labels, at least."""
RINGS = (4.0, 12.0, 24.0, 40.0, 60.0)
"""Between what is named and its label."""
DIRECTIONS = 16
NEAR = 12.0
"""A label within this distance of what it names needs no line to it."""
COVERED, CROSSED = 8.0, 40.0
"""The costs of a point of the drawing under a label, and of one of a label under its leader."""
PROBES = 12
"""Points of a leader that are looked at."""
_GRID = 4_000


@dataclass(frozen=True, slots=True)
class Label:
    """A text to be placed.

    Attributes:
        at: the point (2,) that it names.
        size: its width and height.
        home: where its middle should be; None: beside the point.
        reach: half the width and height of what is named, which a label beside it keeps off.
    """

    at: Array
    size: tuple[float, float]
    home: Array | None = None
    reach: tuple[float, float] = (0.0, 0.0)


class LabelPlacer:
    """Places labels in a picture of a width and a height; ``drawn`` (m, 2) is to stay seen."""

    def __init__(self, size: tuple[float, float], drawn: Array | None = None) -> None:
        self.size = np.array(size)
        self.drawn: Array = np.zeros((0, 2)) if drawn is None else drawn
        self.taken: Array = np.zeros((0, 4))

    def take(self, boxes: Array) -> None:
        """Keep labels off rectangles (m, 4): left, top, right, bottom."""
        self.taken = np.concatenate([self.taken, boxes])

    def place(self, label: Label) -> Array | None:
        """The middle (2,) of the label from now on; None where no place is free.

        What is named outside of the picture has no label.
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
        """Middles to choose from, the nearer ones first."""
        yield _rings(label, half)
        yield self._grid(half)

    def _taken(self, middle: Array, label: Label, half: Array) -> Array:
        self.take(np.concatenate([middle - half, middle + half])[None, :])
        ends = leader_ends(label, middle)
        if ends is not None:
            self.drawn = np.concatenate([self.drawn, _between(ends[0], ends[1][None, :])[0]])
        return middle

    def _free(self, middles: Array, half: Array) -> NDArray[np.bool_]:
        """Which labels with these middles (k, 2) are in the picture and meet no other."""
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
        cost: Array = np.hypot(*off.T) + COVERED * inside + CROSSED * crossed
        return cost

    def _grid(self, half: Array) -> Array:
        """Middles over the whole picture, half a label apart, or as many as are looked at."""
        room = np.maximum(self.size - 2 * half, 0.0)
        step = half * max(1.0, float(np.sqrt((room / half).prod() / _GRID)))
        xs, ys = (
            np.arange(h, s - h + 1e-9, d) for h, s, d in zip(half, self.size, step, strict=True)
        )
        return np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1).reshape(-1, 2)


def _rings(label: Label, half: Array) -> Array:
    """Middles of labels about what is named, the nearest first."""
    angles = 2 * np.pi * (np.arange(DIRECTIONS) - DIRECTIONS / 4) / DIRECTIONS
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = half + np.array(label.reach)
    # On the ring the rectangle of the label touches that of what is named, and then some.
    scale = (1 / np.maximum(np.abs(ways) / reach, 1e-9)).min(axis=1)
    return np.concatenate([label.at + ways * (scale + ring)[:, None] for ring in RINGS])


def _between(start: Array, ends: Array) -> Array:
    """Points (k, PROBES, 2) of the lines from a point to others (k, 2)."""
    parts = np.linspace(0, 1, PROBES)[None, :, None]
    points: Array = start + parts * (ends[:, None, :] - start)
    return points


def leader_ends(label: Label, middle: Array) -> Array | None:
    """The ends (2, 2) of the line from what is named to its label; None where it is near."""
    half = np.array(label.size) / 2
    end = np.clip(label.at, middle - half, middle + half)
    off = np.maximum(np.abs(middle - label.at) - half - np.array(label.reach), 0.0)
    return None if float(np.hypot(*off)) < NEAR else np.stack([label.at, end])


def leader(label: Label, middle: Array) -> str:
    """That line as a mark, or nothing."""
    ends = leader_ends(label, middle)
    return "" if ends is None else f'<path class="leader" d="{line_path(ends)}"/>'


def sized(at: Array, lines: Sequence[str], size: float, *, bold: bool = False) -> Label:
    """A label of lines of text of a size, beside a point (2,)."""
    return Label(at, block_size(lines, size, bold=bold))
