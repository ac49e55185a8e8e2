"""The picture of a robot module by module: a shape per role, its name and its index in the word."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from compiler.arrays import Array
from srgc.render.html_text import name_in_picture, text
from srgc.render.label_placement import LabelPlacer, leader, sized
from srgc.render.module_drawing import DrawnModule, ModuleDrawing
from srgc.render.robot_drawing import axis_ends
from srgc.render.svg import View, fitted, line_path, place
from srgc.render.text_size import BASELINE, LINE

STEP = 8.0
"""The distance between points of the drawing that names avoid."""
SMALL, LARGE = 13.0, 21.0
"""The sizes of names, on a page and on a phone; pictures as wide as a page have room for both."""
GROUND = np.array([[0.0, 0.0], [-14, 12], [14, 12], [-14, 24], [0, 24], [14, 24]])
HERE = np.array([[0.0, 0.0], [-7, 0], [7, 0], [0, -7], [0, 7]])
"""The areas, relative to its place, that the shape of a base covers and that of other modules."""
ROOM = 0.14
"""The free space around a robot for names, as a share of its size."""
ORDER = {"link": 0, "base": 1, "joint": 2, "effector": 3}
"""Modules that are drawn later lie above."""


SIGNS = {"added": "+", "removed": "\N{MINUS SIGN}", "changed": "\N{GREEK CAPITAL LETTER DELTA}"}
"""The sign before the name of a module by what happens to it; the key is a class of its mark."""


def robot_picture(
    drawing: ModuleDrawing,
    values: Mapping[int, Sequence[str]],
    fates: Mapping[int, Collection[str]] = MappingProxyType({}),
    beside: Sequence[ModuleDrawing] = (),
    width: float | None = None,
) -> str:
    """The picture as SVG.

    Args:
        drawing: the robot.
        values: by index in the word, the lines below the name: parameters with their units.
        fates: by index in the word, the keys of ``SIGNS`` that apply.
        beside: robots whose pictures must have the same scale.
        width: the width of the picture, in units in which letters have size 13; by default that of
            a page, with room for the larger letters on a phone.
    """
    view = _view(drawing, beside)
    view = view if width is None else view.scaled(width)
    others = "".join(
        f'<path class="other" d="{line_path(view.project(line))}"/>' for line in drawing.others
    )
    ordered = sorted(drawing.modules, key=lambda module: (ORDER[module.role], module.place))
    size = LARGE if width is None else SMALL
    names = _Names(view, _obstacles(drawing, view), size)
    labels = {
        module.place: names.label(
            module, values.get(module.place, ()), signs_of(fates.get(module.place, ()))
        )
        for module in drawing.modules
    }
    shapes = "".join(
        f'<g class="{_classes(module, fates)}" data-symbol="{module.place}" tabindex="-1">'
        f"<title>{text(module.name)}, symbol {module.place}: {module.role}"
        f"{_said(fates.get(module.place, ()))}</title>"
        f"{_shape(module, view)}</g>"
        for module in ordered
    )
    marks = "".join(labels[module.place] for module in ordered)
    return (
        f'<svg class="modules" viewBox="0 0 {view.width:.0f} {view.height:.0f}" role="img" '
        f'aria-label="The robot, module by module">{others}{shapes}{marks}</svg>'
    )


def signs_of(fates: Collection[str]) -> str:
    """The signs of what happens to a module, in the order of ``SIGNS``."""
    return " ".join(sign for fate, sign in SIGNS.items() if fate in fates)


def _classes(module: DrawnModule, fates: Mapping[int, Collection[str]]) -> str:
    return " ".join(["module", module.role, *sorted(fates.get(module.place, ()))])


def _said(fates: Collection[str]) -> str:
    return "".join(f", {fate}" for fate in SIGNS if fate in fates)


def _view(drawing: ModuleDrawing, beside: Sequence[ModuleDrawing]) -> View:
    corners = drawing.corners()
    found = [corners, *(_about(_middle(corners), each.corners()) for each in beside)]
    size = max(float(np.ptp(each, axis=0).max()) for each in found)
    room = ROOM * (size if size > 0 else 1.0)
    return fitted([each + way for each in found for way in (-room, room)], turning=False)


def _middle(points: Array) -> Array:
    middle: Array = (points.min(axis=0) + points.max(axis=0)) / 2
    return middle


def _about(middle: Array, points: Array) -> Array:
    """Points (m, d), moved so that ``middle`` is their middle."""
    return points - _middle(points) + middle


def _shape(module: DrawnModule, view: View) -> str:
    """The shape of a module."""
    parts = [f'<path class="length" d="{line_path(view.project(line))}"/>' for line in module.lines]
    parts += [_body(view.project(line)) for line in module.bodies]
    if module.at is None:
        return "".join(parts)
    at = view.project(module.at)
    if module.joint is not None:
        parts.append(_joint(module, at, view))
    elif module.role == "base":
        parts.append(
            _moved(
                at, "ground", "M0 0L-10 17H10ZM-18 17H18M-17 25l6-8M-8 25l6-8M1 25l6-8M10 25l6-8"
            )
        )
    elif module.role == "effector":
        parts.append(_moved(at, "tool", "M0 0H5M14-8H5V8H14", _turned(module, at, view)))
    elif not parts:
        parts.append(f'<circle class="still" cx="{place(at[0])}" cy="{place(at[1])}" r="3.5"/>')
    return "".join(parts)


def _body(ends: Array) -> str:
    """A rod, or the centre of mass of another body."""
    if float(np.hypot(*(ends[1] - ends[0]))) > 1:
        return f'<path class="rod" d="{line_path(ends)}"/>'
    x, y = ends[0]
    return f'<circle class="mass" cx="{place(x)}" cy="{place(y)}" r="3"/>'


def _joint(module: DrawnModule, at: Array, view: View) -> str:
    """A circle for a revolute joint and a box for a prismatic one; its axis if it is visible."""
    x, y = at
    if module.joint == "prismatic":
        angle = _turned(module, at, view)
        return (
            f'<g transform="translate({place(x)} {place(y)}) rotate({place(angle)})">'
            '<path class="slide" d="M-13-7H13V7H-13Z"/>'
            '<path class="arrow" d="M-8 0H8M4-3L8 0L4 3"/></g>'
        )
    mark = f'<circle class="turn" cx="{place(x)}" cy="{place(y)}" r="8"/>'
    mark += f'<circle class="pin" cx="{place(x)}" cy="{place(y)}" r="2"/>'
    if module.axis is not None and module.at is not None and len(module.at) == 3:
        ends = axis_ends(at, view.project(module.at + module.axis))
        mark = f'<path class="axis" d="{line_path(at + 1.4 * (ends - at))}"/>{mark}'
    return mark


def _turned(module: DrawnModule, at: Array, view: View) -> float:
    """The angle in the picture, in degrees, of a joint's axis or of an effector's direction."""
    direction = module.axis if module.axis is not None else module.pointing
    if direction is None or module.at is None:
        return 0.0
    along = view.project(module.at + direction) - at
    return float(np.degrees(np.arctan2(along[1], along[0])))


def _moved(at: Array, kind: str, data: str, angle: float = 0.0) -> str:
    turn = f" rotate({place(angle)})" if angle else ""
    shift = f"translate({place(at[0])} {place(at[1])}){turn}"
    return f'<path class="{kind}" transform="{shift}" d="{data}"/>'


def _obstacles(drawing: ModuleDrawing, view: View) -> Array:
    """Points (m, 2) along everything drawn, which names avoid."""
    found = [
        _along(ends)
        for module in drawing.modules
        for ends in (view.project(line) for line in (*module.lines, *module.bodies))
    ]
    found += [
        view.project(module.at) + (GROUND if module.role == "base" else HERE)
        for module in drawing.modules
        if module.at is not None
    ]
    return np.concatenate(found)


def _along(ends: Array) -> Array:
    """Points on a line, too close together for a name to fit between them."""
    length = float(np.hypot(*(ends[1] - ends[0])))
    steps = np.linspace(0, 1, 2 + int(length / STEP))[:, None]
    found: Array = ends[0] + steps * (ends[1] - ends[0])
    return found


class _Names:
    """Places names clear of the drawing, all in one size."""

    def __init__(self, view: View, drawn: Array, size: float) -> None:
        self.view, self.size = view, size
        self.placer = LabelPlacer((view.width, view.height), drawn)

    def label(self, module: DrawnModule, values: Sequence[str], signs: str = "") -> str:
        """The name of a module with its signs and its index, and the values below it."""
        anchor = module.anchor()
        if anchor is None:
            return ""
        lines = [f"{signs} {name_in_picture(module.name)} {module.place}".lstrip(), *values]
        wanted = sized(self.view.project(anchor), lines, self.size, bold=True)
        middle = self.placer.place(wanted)
        if middle is None:
            return ""
        x, y = place(middle[0]), place(middle[1])
        name, *rest = (text(line) for line in lines)
        below = "".join(
            f'<tspan class="value" x="{x}" dy="{LINE}em">{line}</tspan>' for line in rest
        )
        first = f"{BASELINE - LINE * len(rest) / 2:.3f}em"
        rows = f'<tspan x="{x}" y="{y}" dy="{first}">{name}</tspan>{below}'
        return (
            f'<g class="name {module.role}" data-symbol="{module.place}">{leader(wanted, middle)}'
            f"<text>{rows}</text></g>"
        )
