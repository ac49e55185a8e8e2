"""The names of cells in a picture: in the cell if there is room, else beside it or omitted."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.views.workspace_view import cell_label
from compiler.workspaces.abstraction import Cell
from srgc.render.html_text import name_in_picture, text
from srgc.render.label_placement import Label, LabelPlacer, leader, sized
from srgc.render.svg import View, moved, place
from srgc.render.text_size import LINE, block_size

LARGEST, SMALLEST = 12.0, 9.0
"""Sizes of a name in units of the picture, about pixels; smaller names cannot be read."""
PLACES, ROUNDS = 9, 4
"""Places per row to try for a name, and how often the search narrows around the best."""
STOP = 9.0
"""Half the size of the mark at an end of a path."""
MOST_IN_SPACE = 60


@dataclass(frozen=True, slots=True)
class _Spot:
    """Lines of text centred at ``middle`` (2,) in the picture."""

    middle: Array
    size: float
    lines: tuple[str, ...]
    upright: bool = False

    @property
    def box(self) -> Array:
        """Its rectangle (1, 4): left, top, right, bottom."""
        half = np.array(block_size(self.lines, self.size)) / 2
        half = half[::-1] if self.upright else half
        return np.concatenate([self.middle - half, self.middle + half])[None, :]

    def mark(self) -> str:
        """The text as SVG."""
        first = -(len(self.lines) - 1) / 2
        rows = "".join(
            f'<tspan x="0" y="{place(LINE * self.size * (first + k))}">{text(line)}</tspan>'
            for k, line in enumerate(self.lines)
        )
        turned = ' transform="rotate(-90)"' if self.upright else ""
        x, y = self.middle.tolist()
        return moved(x, y, f'<text style="font-size:{self.size:.1f}px"{turned}>{rows}</text>')


class CellNames:
    """The names of cells in a view; ``paths`` are lines (m, 2) in the picture."""

    def __init__(self, cells: Sequence[Cell], view: View, paths: Sequence[Array]) -> None:
        self.cells, self.view = cells, view
        self.drawn = np.concatenate([_sampled(line) for line in paths] or [np.zeros((0, 2))])
        self.placer = LabelPlacer((view.width, view.height), self.drawn)
        ends = [line[k] for line in paths for k in (0, -1)]
        boxes = [[x - STOP, y - STOP, x + STOP, y + STOP] for x, y in ends]
        self.stops = np.array(boxes).reshape(-1, 4)
        self.placer.take(self.stops)

    def in_plane(self, needed: Container[int]) -> tuple[str, int]:
        """The names, and the number of cells without one; ``needed`` cells may get one outside."""
        spots = {number: self._spot(cell) for number, cell in enumerate(self.cells)}
        for spot in spots.values():
            if spot is not None:
                self.placer.take(spot.box)
        marks, unnamed = [], 0
        for number, spot in spots.items():
            if spot is not None:
                marks.append(spot.mark())
            elif number not in needed or not (mark := self._beside(self.cells[number], SMALLEST)):
                unnamed += 1
            else:
                marks.append(mark)
        return f'<g class="fitted">{"".join(marks)}</g>', unnamed

    def in_space(self, size: float) -> tuple[str, int]:
        """The names of the cells of regions, unless there are too many; and the number omitted."""
        named = [cell for cell in self.cells if cell.kind != "free"]
        if len(named) > MOST_IN_SPACE:
            return "", 0
        marks = [self._beside(cell, size) for cell in named]
        return f'<g class="fitted">{"".join(marks)}</g>', marks.count("")

    def _beside(self, cell: Cell, size: float) -> str:
        """A name on or beside its cell, with a leader line if it is far away."""
        at = self.view.project(np.array(cell.polytope.centre, dtype=float))
        name = name_in_picture(cell.name)
        label = sized(at, [name], size)
        middle = self.placer.place(Label(at, label.size, home=at))
        if middle is None:
            return ""
        return leader(label, middle) + _Spot(middle, size, (name,)).mark()

    def _spot(self, cell: Cell) -> _Spot | None:
        """The place for the longer or the short label in its cell; None if there is no room."""
        room = _Room(cell, self.view, self.drawn, self.stops)
        for says in dict.fromkeys((cell_label(cell), cell.name)):
            lines = tuple(says.split("\n"))
            flat, upright = (room.fitted(lines, upright=turned) for turned in (False, True))
            best = flat if flat.size >= min(upright.size, LARGEST) else upright
            if best.size >= SMALLEST:
                return best
        return None


class _Room:
    """A cell of the plane in the picture, as half-planes, with the points and boxes to avoid."""

    def __init__(self, cell: Cell, view: View, drawn: Array, stops: Array) -> None:
        self.corners = view.project(np.array(cell.polytope.vertices, dtype=float))
        ends = np.roll(self.corners, -1, axis=0) - self.corners
        normals = np.stack([ends[:, 1], -ends[:, 0]], axis=1)
        middle = self.corners.mean(axis=0)
        outwards = np.sign(((self.corners - middle) * normals).sum(axis=1))
        self.normals = normals * outwards[:, None]
        self.bounds = (self.corners * self.normals).sum(axis=1)
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        self.drawn = drawn[((drawn >= low) & (drawn <= high)).all(axis=1)]
        near = (stops[:, :2] < high).all(axis=1) & (stops[:, 2:] > low).all(axis=1)
        self.stops = stops[near]

    def fitted(self, lines: tuple[str, ...], *, upright: bool) -> _Spot:
        """The largest text that fits, off the paths if there is room."""
        half = np.array(block_size(lines, 1.0)) / 2
        half = half[::-1] if upright else half
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        best, size = (low + high) / 2, 0.0
        for _ in range(ROUNDS):
            middles = _lattice(low, high)
            sizes = self._sizes(middles, half)
            # If there is room to spare, the middle of the room is best.
            kept = np.minimum(sizes, LARGEST) + 0.02 * sizes
            if len(self.drawn):
                kept -= self._covered(middles, half, sizes)
            first = int(kept.argmax())
            best, size = middles[first], float(sizes[first])
            around = (high - low) / (PLACES - 1)
            low, high = best - around, best + around
        return _Spot(best, min(size, LARGEST), lines, upright)

    def _sizes(self, middles: Array, half: Array) -> Array:
        """The largest sizes of a text with centres (k, 2); ``half`` is its half-size at size 1."""
        slack = self.bounds - middles @ self.normals.T
        sizes: Array = (slack / (np.abs(self.normals) @ half)).min(axis=1)
        return sizes

    def _covered(self, middles: Array, half: Array, sizes: Array) -> Array:
        """The cost of covering a path, and the far higher cost of covering the mark at its end."""
        size = half * np.clip(sizes, SMALLEST, LARGEST)[:, None]
        off = np.abs(self.drawn[None] - middles[:, None])
        on = (off < size[:, None] + 1).all(axis=2).any(axis=1)
        low, high = middles - size, middles + size
        left, top, right, bottom = self.stops.T
        apart = (low[:, :1] >= right) | (high[:, :1] <= left)
        apart |= (low[:, 1:] >= bottom) | (high[:, 1:] <= top)
        cost: Array = 2.0 * on + 100.0 * (~apart).any(axis=1)
        return cost


def _lattice(low: Array, high: Array) -> Array:
    """Points (k, 2) of a regular grid in a box."""
    xs, ys = (np.linspace(a, b, PLACES) for a, b in zip(low, high, strict=True))
    return np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1).reshape(-1, 2)


def _sampled(line: Array) -> Array:
    """Points along a line (m, 2), a few units apart."""
    lengths = np.hypot(*np.diff(line, axis=0).T) if len(line) > 1 else np.zeros(0)
    parts = [
        line[k] + np.linspace(0, 1, int(length / 4) + 2)[:, None] * (line[k + 1] - line[k])
        for k, length in enumerate(lengths)
    ]
    return np.concatenate([line, *parts])
