"""The two pictures of a result, as SVG: the workspace with the motion, and the inputs over time."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from compiler.discretisation.float_reading import Array, FloatReading
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.geometry.polytope import polytope_of
from compiler.robots.input_bounds import input_bounds
from compiler.robots.robot import WORLD
from grammar_lang import ir
from solvers.design import Design
from solvers.synthesis import Synthesis
from srgc.render.svg import ARM, COLOURS, INK, PATH, figure_settings, svg_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GHOSTS = 12
MOST_INSTANTS = 120
"""Of a trace; from 128 on, matplotlib leaves out points of a line as it sees fit."""


def workspace_figure(
    result: Synthesis, design: Design, workspace: ir.Workspace, task: ir.Task
) -> str:
    """Regions, cell path, effector trajectory and ghost poses (case study, figure (a)).

    In space the picture is the projection to the first two axes.
    """
    trajectory = design.configuration.outcome.trajectory
    n = len(design.model.dofs)
    reading = FloatReading(robot_graph(design.model, task.gravity))
    points = reading.points(trajectory.x[:, :n], trajectory.theta).value[..., :2]
    with figure_settings():
        figure = Figure(figsize=(6.6, 6.2))
        figure.subplots_adjust(left=0.09, right=0.98, bottom=0.08, top=0.92)
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        _draw_cells(axes, result, design)
        _draw_regions(axes, workspace)
        _draw_skeleton(axes, _skeletons(design, task))
        _draw_ghosts(axes, points, design, reading)
        tips = _effector_line(design, reading, float(task.step))
        axes.plot(*tips.T, color=INK, lw=2.0, label="effector", zorder=6)
        axes.plot(*tips[0], "o", color=INK, ms=5, zorder=7)
        axes.plot(*tips[-1], "*", color=INK, ms=11, zorder=7)
        _frame(axes, workspace, points.reshape(-1, 2))
        seen = ", seen along z" if workspace.dimension == 3 else ""
        word = " ".join(design.derivation.word)
        axes.set_title(f"{task.name}: {word}\n{_caption(design)}{seen}", fontsize=9, loc="left")
        axes.legend(loc="upper left", fontsize=8, framealpha=0.85)
        return svg_text(figure)


def _caption(design: Design) -> str:
    lengths = ", ".join(
        f"{p.name} {float(Fraction(claim.value)):.3g} {p.unit}".strip()
        for p, claim in zip(design.model.parameters, design.parameters, strict=True)
    )
    margin = f"robustness {design.configuration.outcome.robustness:.4g}"
    return f"{lengths}; {margin}" if lengths else margin


def _frame(axes: Axes, workspace: ir.Workspace, points: Array) -> None:
    """The bounds as a rectangle, and a view that holds them and the whole motion."""
    box = polytope_of(workspace.bounds.shape, workspace.dimension).box[:, :2]
    (x0, y0), (x1, y1) = box
    axes.plot([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], color=INK, lw=0.8, zorder=1)
    seen = np.concatenate([box, points])
    low, high = seen.min(axis=0), seen.max(axis=0)
    pad = 0.02 * float(np.max(high - low))
    axes.set_xlim(low[0] - pad, high[0] + pad)
    axes.set_ylim(low[1] - pad, high[1] + pad)
    axes.set_aspect("equal")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")


def _outline(vertices: Array) -> Array:
    """The corners of a projected polytope in counter-clockwise order (its convex hull)."""
    order = sorted({(float(x), float(y)) for x, y in vertices[:, :2]})

    def half(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for p in points:
            while len(chain) >= 2 and _turn(chain[-2], chain[-1], p) <= 0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return np.array(half(order) + half(order[::-1]))


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _draw_cells(axes: Axes, result: Synthesis, design: Design) -> None:
    """The cells of the path, lightly, and the path through their shared facets."""
    names = design.path[design.leader]
    visited = [names[0]]
    for name in names[1:]:
        if name != visited[-1]:
            visited.append(name)
    cells = result.abstraction
    line = []
    for name in visited:
        index = cells.index(name)
        polytope = cells.cells[index].polytope
        corners = _outline(np.array([[float(x) for x in v] for v in polytope.vertices]))
        axes.fill(*corners.T, facecolor=PATH, alpha=0.07, edgecolor=PATH, lw=0.6, zorder=1)
    for i, name in enumerate(visited):
        index = cells.index(name)
        if i:
            before = cells.index(visited[i - 1])
            line.append(cells.facet_centre(before, index)[:2])
        if i in (0, len(visited) - 1):
            line.append(np.array([float(x) for x in cells.cells[index].polytope.centre])[:2])
    axes.plot(*np.array(line).T, color=PATH, lw=1.4, ls="--", label="cell path", zorder=5)


def _draw_regions(axes: Axes, workspace: ir.Workspace) -> None:
    """The regions with their names; the pieces of a map (`yard.1`, ...) have one name together."""
    named: set[str] = set()
    for region in workspace.regions:
        polytope = polytope_of(region.shape, workspace.dimension)
        if not polytope.is_bounded:
            continue
        corners = _outline(np.array([[float(x) for x in v] for v in polytope.vertices]))
        colour = COLOURS[region.kind]
        axes.fill(*corners.T, facecolor=colour, alpha=0.35, edgecolor=colour, lw=1.2, zorder=2)
        name = region.name.partition(".")[0]
        if name in named:
            continue
        named.add(name)
        tops = corners[corners[:, 1] == corners[:, 1].max()]
        axes.annotate(
            name, tops[tops[:, 0].argmin()], (0, 3), ha="left" if len(tops) > 1 else "center",
            textcoords="offset points", color=INK, weight="bold", zorder=8,
        )  # fmt: skip


def _effector_line(design: Design, reading: FloatReading, step: float) -> Array:
    """The way of the leading effector, (K, 2), between the samples by Hermite's cubic.

    Chords would cut corners, and with few samples go through obstacles that the motion avoids.
    """
    from scipy.interpolate import CubicHermiteSpline

    trajectory, n = design.configuration.outcome.trajectory, len(design.model.dofs)
    samples = np.arange(len(trajectory.x))
    parts = max(1, MOST_INSTANTS // samples[-1])
    instants = np.arange(parts * samples[-1] + 1) / parts
    q, slopes = trajectory.x[:, :n], trajectory.x[:, n : 2 * n] * step
    between = np.asarray(CubicHermiteSpline(samples, q, slopes)(instants))
    line: Array = reading.points(between, trajectory.theta).value[:, design.leader, :2]
    return line


def _skeletons(design: Design, task: ir.Task) -> list[Array]:
    """Per effector and body the origins of its frames from the base on, each (k + 1, f, 2)."""
    model, trajectory = design.model, design.configuration.outcome.trajectory
    # The same robot with every frame as an effector: its points are the origins.
    jointed = replace(model, effectors=tuple(range(len(model.frames))))
    reading = FloatReading(robot_graph(jointed, task.gravity))
    q = trajectory.x[:, : len(model.dofs)]
    origins = reading.points(q, trajectory.theta).value[..., :2]
    ends = dict.fromkeys([*model.effectors, *(body.frame for body in model.bodies)])
    return [origins[:, [WORLD, *model.chain(frame)]] for frame in ends]


def _ghost_samples(count: int) -> list[tuple[int, float]]:
    """Equally spaced samples with their opacity, the last one strong."""
    samples = np.unique(np.linspace(0, count - 1, GHOSTS).round().astype(int))
    last = len(samples) - 1
    return [
        (int(sample), 1.0 if number == last else 0.15 + 0.35 * number / len(samples))
        for number, sample in enumerate(samples)
    ]


def _draw_skeleton(axes: Axes, chains: list[Array]) -> None:
    """Thin lines from the base through all joints, for robots whose bodies are no rods."""
    for chain in chains:
        for sample, alpha in _ghost_samples(len(chain)):
            axes.plot(*chain[sample].T, color=ARM, alpha=alpha, lw=0.7, zorder=3)


def _draw_ghosts(axes: Axes, points: Array, design: Design, reading: FloatReading) -> None:
    """Poses of the robot at equally spaced samples, the last one strong."""
    effectors = len(design.model.effectors)
    for sample, alpha in _ghost_samples(len(points)):
        last = sample == len(points) - 1
        for hull in reading.graph.hulls:
            body = points[sample, [effectors + i for i in hull]]
            axes.plot(
                *body.T, color=ARM, alpha=alpha, lw=2.6 if last else 1.6,
                marker="o", ms=3, solid_capstyle="round", zorder=4,
                label="robot" if last and hull == reading.graph.hulls[0] else None,
            )  # fmt: skip


def input_figure(design: Design, task: ir.Task) -> str:
    """Inputs over time with their bounds (case study, figure (b))."""
    trajectory = design.configuration.outcome.trajectory
    time: Array = np.arange(task.steps + 1, dtype=np.float64) * float(task.step)
    with figure_settings():
        bounds = input_bounds(design.model, task)
        height = 2.6 * max(1, len(bounds)) + 0.6
        figure = Figure(figsize=(7.2, height))
        figure.subplots_adjust(
            left=0.11, right=0.98, bottom=0.5 / height, top=1 - 0.35 / height, hspace=0.3
        )
        FigureCanvasSVG(figure)
        panels = figure.subplots(max(1, len(bounds)), 1, squeeze=False)[:, 0]
        for axes, bound in zip(panels, bounds, strict=False):
            low, high = float(bound.lower), float(bound.upper)
            unit = bound.unit.replace("*", " ")
            for i in bound.inputs:
                values = np.append(trajectory.u[:, i], trajectory.u[-1:, i])
                axes.step(time, values, where="post", lw=1.4, label=f"u{i + 1}")
            label = f"bound ±{high:g} {unit}" if low == -high else f"{low:g} to {high:g} {unit}"
            for value, shown in ((low, None), (high, label)):
                axes.axhline(value, color=COLOURS["obstacle"], lw=1.0, ls="--", label=shown)
            axes.axhline(0, color=INK, lw=0.5, alpha=0.4)
            axes.set_ylabel(f"{'effort' if bound.effort else 'input'} ({unit})")
            axes.set_xlim(time[0], time[-1])
            margin = 0.075 * (high - low)
            axes.set_ylim(low - margin, high + margin)
            if bound.effort:
                _magnified(axes, time, trajectory.u[:, list(bound.inputs)], high, unit)
            axes.legend(
                loc="lower right", bbox_to_anchor=(1, 1), fontsize=8, frameon=False, ncols=4
            )
        if not bounds:
            panels[0].set_title("the robot has no inputs", fontsize=10, loc="left")
            panels[0].set_xlim(time[0], time[-1])
        panels[-1].set_xlabel("time (s)")
        return svg_text(figure)


def _magnified(axes: Axes, time: Array, u: Array, bound: float, unit: str) -> None:
    """An inset with the inputs on their own scale, where they use little of the bound."""
    peak = float(np.max(np.abs(u), initial=0.0))
    if not 0 < peak < 0.25 * bound:
        return
    inset = axes.inset_axes((0.08, 0.58, 0.5, 0.36))
    for column in u.T:
        inset.step(time, np.append(column, column[-1]), where="post", lw=1.0)
    inset.set_xlim(time[0], time[-1])
    inset.set_ylim(-1.1 * peak, 1.1 * peak)
    inset.set_title(f"peak {peak:.3g} {unit}", fontsize=7, pad=2)
    inset.tick_params(labelsize=6)
