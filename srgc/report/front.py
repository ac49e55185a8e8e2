"""The Pareto front of the designs of a task: a chart, a table, and each design in motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from srgc.render.axes import Plot, Scale, axes, labelled, padded, titles
from srgc.render.html_text import json_script, many, text
from srgc.render.region_names import page_names
from srgc.render.robot_drawing import pose_marks
from srgc.render.svg import View, fitted, line_path
from srgc.render.workspace_drawing import WorkspaceShape, shape_marks, workspace_shapes
from srgc.report.animation import measure, scene_picture, seen_paths
from srgc.report.compared_designs import Axis, Compared, ComparedDesigns, shown
from srgc.report.evidence import Evidence
from srgc.report.front_motions import MOST_MOTIONS
from srgc.report.motion_data import Grid, motion_data
from srgc.report.motion_scene import MotionScene, RobotMotion, robot_motion, seen_corners

WIDTH, HEIGHT = 560, 300
LEFT, RIGHT, TOP, BOTTOM = 74, 14, 14, 50
MOST_DOMINATED = 200
"""The number of dominated designs to draw."""
MOST_NUMBERS = 60_000
"""The most coordinates of points that the motions of a front have together."""


def front_part(evidence: Evidence, designs: ComparedDesigns) -> str:
    """A chart for each pair of objectives, the table of the front, and its designs in motion.

    The table of all designs is in the part about the search.
    """
    count = many(len(designs.front), "design")
    left = f" Not all structures were tried: {text(designs.ended)}." if designs.ended else ""
    head = (
        f"<h3>The front</h3><p>{count} that none dominates, {len(designs.dominated)} dominated: "
        f"those that were found, one of a robot.{left}</p>"
    )
    motions, view, shapes = _motions(evidence)
    scene = _scene(evidence, motions, view, shapes)
    return (
        f'{head}<div class="front">{_charts(designs)}{scene}</div>'
        f"{_table(designs, {*motions})}{_left_out(designs, motions)}"
        f"{json_script('front-data', _data(designs, motions, view))}"
    )


# --- The chart ------------------------------------------------------------------------------------


def _charts(designs: ComparedDesigns) -> str:
    """A chart for each pair of objectives, the first one visible; a choice if there are several."""
    pairs = list(combinations(range(len(designs.axes)), 2))
    if not pairs:
        return ""
    choice = ""
    if len(pairs) > 1:
        options = "".join(
            f'<option value="{a}-{b}">{text(_title(designs.axes[b]))} over '
            f"{text(_title(designs.axes[a]))}</option>"
            for a, b in pairs
        )
        choice = (
            '<label class="axes-choice screen-only" hidden="">axes '
            f"<select>{options}</select></label>"
        )
    charts = "".join(_chart(designs, a, b, seen=k == 0) for k, (a, b) in enumerate(pairs))
    return f"<figure>{choice}{charts}<figcaption>{_caption(designs)}</figcaption></figure>"


def _caption(designs: ComparedDesigns) -> str:
    words = "Diamonds: none is nowhere worse and somewhere better."
    if designs.dominated:
        words += " Dots are dominated."
    return f"{words} The filled one is the design of this folder."


def _title(axis: Axis) -> str:
    name = axis.name.removeprefix("sum(").removesuffix(")")
    return f"{name} ({axis.unit})" if axis.unit else name


def _chart(designs: ComparedDesigns, a: int, b: int, *, seen: bool) -> str:
    others = designs.dominated[:MOST_DOMINATED]
    every = [*others, *designs.front]
    low, high = padded(*_ends([each.values[a] for each in every]))
    bottom, top = padded(*_ends([each.values[b] for each in every]))
    plot = Plot(Scale(low, high, LEFT, WIDTH - RIGHT), Scale(bottom, top, HEIGHT - BOTTOM, TOP))
    across, up = designs.axes[a], designs.axes[b]
    says = f"{_title(up)} over {_title(across)}: {len(designs.front)} designs that none dominates"
    marks = "".join(_mark(each, a, b, plot, designs) for each in every)
    hidden = "" if seen else ' hidden=""'
    return (
        f'<svg class="chart front-chart" data-axes="{a}-{b}"{hidden} '
        f'viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{text(says)}">'
        f"{axes(plot, labelled(plot.across), labelled(plot.up))}"
        f"{titles(plot, _title(across), _title(up), 56.0)}{marks}</svg>"
    )


def _ends(values: Sequence[float]) -> tuple[float, float]:
    return min(values), max(values)


def _mark(one: Compared, a: int, b: int, plot: Plot, designs: ComparedDesigns) -> str:
    x, y = plot.across(one.values[a]), plot.up(one.values[b])
    title = f"<title>{text(_says(one, designs.axes))}</title>"
    if one.dominated_by is not None:
        return f'<circle class="good" cx="{x:.1f}" cy="{y:.1f}" r="3.2">{title}</circle>'
    kind = "chosen" if one.structure == designs.chosen else "open"
    return (
        f'<path class="choice {kind}" data-front="{one.structure}" '
        f'd="M{x:.1f} {y - 7:.1f}l7 7l-7 7l-7 -7z">{title}</path>'
    )


def _says(one: Compared, columns: Sequence[Axis]) -> str:
    values = ", ".join(
        f"{axis.name.removeprefix('sum(').removesuffix(')')} {shown(value, axis)}"
        for value, axis in zip(one.values, columns, strict=True)
    )
    return f"{one.word}: {values}"


# --- The table, which also works without a pointer ------------------------------------------------


def _table(designs: ComparedDesigns, moving: set[int]) -> str:
    heads = "".join(f'<th class="figure">{text(_title(axis))}</th>' for axis in designs.axes)
    rows = "".join(
        _row(each, designs.axes, moves=each.structure in moving) for each in designs.front
    )
    return (
        '<div class="scroll"><table class="front-table"><thead><tr>'
        f'<td class="screen-only"></td>{heads}<th>word</th><th>folder</th></tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )


def _row(one: Compared, columns: Sequence[Axis], *, moves: bool) -> str:
    values = "".join(
        f'<td class="figure">{shown(value, replace(axis, unit=""))}</td>'
        for value, axis in zip(one.values, columns, strict=True)
    )
    label = f"Show {one.word}"
    button = (
        f'<button type="button" class="choice" data-front="{one.structure}" hidden="" '
        f'aria-pressed="false" aria-label="{text(label)}">show</button>'
        if moves
        else ""
    )
    return (
        f'<tr data-front-row="{one.structure}"><td class="screen-only">{button}</td>{values}'
        f'<td class="word">{text(one.word)}</td><td><code>{text(one.folder)}</code></td></tr>'
    )


def _left_out(designs: ComparedDesigns, motions: dict[int, RobotMotion]) -> str:
    missing = len(designs.front) - len(motions)
    if not missing:
        return ""
    cause = (
        f"a page holds the motions of the first {MOST_MOTIONS}"
        if len(designs.front) > MOST_MOTIONS
        else "their folders are missing or were altered"
    )
    return f'<p class="soft">{many(missing, "design")} cannot be shown moving: {cause}.</p>'


# --- The designs in motion ------------------------------------------------------------------------


def _motions(
    evidence: Evidence,
) -> tuple[dict[int, RobotMotion], View | None, tuple[WorkspaceShape, ...]]:
    """The motions by the numbers of their structures, and the view in which all of them fit."""
    found = evidence.front
    most = MOST_NUMBERS // max(len(found), 1)
    motions = {
        each.structure: robot_motion(each.found, each.trajectory, most=most) for each in found
    }
    shapes = workspace_shapes(evidence.workspace, ())
    corners = [corner for motion in motions.values() for corner in seen_corners(shapes, motion)]
    return motions, fitted(corners) if corners else None, shapes


def _scene(
    evidence: Evidence,
    motions: dict[int, RobotMotion],
    view: View | None,
    shapes: tuple[WorkspaceShape, ...],
) -> str:
    """The picture in which the chosen design moves; a script shows it."""
    if view is None:
        return ""
    scene = MotionScene(evidence.workspace.dimension, shapes, None, view)
    robots = "".join(_robot(number, motion, view) for number, motion in motions.items())
    names = page_names(shapes, view, seen_paths(list(motions.values()), view))
    content = shape_marks(shapes, view) + robots + names + measure(scene)
    picture = scene_picture(view, "The chosen design, moving", content, turned=False)
    return (
        f'<figure class="front-scene screen-only" hidden="">{picture}'
        '<figcaption><button type="button" class="front-play" aria-label="Pause">❚❚</button> '
        '<span class="front-name" aria-live="polite"></span></figcaption></figure>'
    )


def _robot(number: int, motion: RobotMotion, view: View) -> str:
    trails = "".join(
        f'<path class="trail" d="{line_path(view.project(tips))}"/>'
        for tips in np.swapaxes(motion.tips, 0, 1)
    )
    return (
        f'<g class="front-robot" data-robot="{number}" visibility="hidden">{trails}'
        f'<g class="robot">{pose_marks(motion.robot, motion.points[0], view)}</g></g>'
    )


def _data(
    designs: ComparedDesigns, motions: dict[int, RobotMotion], view: View | None
) -> dict[str, Any]:
    """The data for the script: the view of the picture, and the motion of each design."""
    if view is None:
        return {"designs": []}
    grid = Grid(view)
    return {
        "dimension": len(view.axes[0]),
        "grid": grid.unit * view.scale,
        "width": view.width,
        "height": view.height,
        "axes": view.axes.tolist(),
        "chosen": designs.chosen,
        "designs": list(_moving(designs, motions, grid, view)),
    }


def _moving(
    designs: ComparedDesigns, motions: dict[int, RobotMotion], grid: Grid, view: View
) -> Iterator[dict[str, Any]]:
    for one in designs.front:
        if one.structure in motions:
            motion = motion_data(motions[one.structure], grid, [], view)
            for name in ("q", "kinds", "cells", "visits", "tube"):
                del motion[name]
            yield {"structure": one.structure, "says": _says(one, designs.axes), "motion": motion}
