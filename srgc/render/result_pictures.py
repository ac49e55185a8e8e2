"""The pictures of a result: the workspace with its motion or the nearest motion, and the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_inputs
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.search.path_task import Design
from solvers.search.search_state import NearestMotion
from solvers.search.synthesis import Synthesis
from srgc.render.charts import Curve, colour_class, curve_marks, plot_of, thinned
from srgc.render.html_text import number, with_unit
from srgc.render.region_names import name_boxes, shape_names
from srgc.render.robot_drawing import (
    DrawnRobot,
    drawn_robot,
    ghost_marks,
    motion_samples,
    pose_marks,
)
from srgc.render.svg import SAMPLE, View, document, from_above, label, line_path, moved, symbol
from srgc.render.workspace_drawing import (
    AXES_ROOM,
    CELL_SAMPLE,
    KIND_SAMPLES,
    WorkspaceShape,
    cell_path,
    plane_axes,
    shape_marks,
    workspace_shapes,
)

GHOSTS = 11
"""The number of poses that are drawn faintly before the last one."""
LEAST_INSTANTS, MOST_INSTANTS = 120, 600
"""The number of points on an effector's curve, so many that chords do not cut corners."""
PANEL, WIDE, HEADING = 200.0, 720.0, 20.0
"""Height, width and heading of a chart of inputs."""


@dataclass(frozen=True, slots=True, eq=False)
class _DrawnMotion:
    """A motion to draw: ``theta`` (p,), states ``x`` (k + 1, N) and the cells of the ``leader``.

    If ``stuck`` is given, it is drawn only up to that sample.
    """

    model: RobotModel
    theta: Array
    x: Array
    abstraction: Abstraction
    cells: tuple[int, ...]
    leader: int
    title: str
    stuck: int | None = None


def workspace_figure(
    result: Synthesis, design: Design, workspace: ir.Workspace, task: ir.Task
) -> str:
    """Regions, cell path, effector trajectory and ghost poses (case study, figure (a)).

    Spatial scenes are seen along z.
    """
    theta = np.array([float(value) for value in design.parameters])
    robustness = design.configuration.outcome.robustness
    drawn = _DrawnMotion(
        design.model,
        theta,
        design.configuration.outcome.trajectory.x,
        result.abstraction,
        tuple(result.abstraction.index(name) for name in design.path[design.leader]),
        design.leader,
        f"{task.name}: robot {' '.join(design.derivation.word)}\n"
        f"{_caption(design.model, task, theta, robustness)}",
    )
    return _motion_figure(drawn, workspace, task)


def nearest_figure(nearest: NearestMotion, workspace: ir.Workspace, task: ir.Task) -> str:
    """The figure of the motion that came nearest to a design, up to where it is stuck."""
    theta = nearest.trajectory.theta
    title = (
        f"{task.name}: robot {' '.join(nearest.derivation.word)}, the nearest motion, not proved"
    )
    caption = _caption(nearest.model, task, theta, nearest.robustness)
    stuck = nearest.stuck
    if stuck is not None:
        caption += f"; it is stuck at {number(float(stuck * task.step))} s"
    drawn = _DrawnMotion(
        nearest.model, theta, nearest.trajectory.x, nearest.abstraction, nearest.cells,
        nearest.leader, f"{title}\n{caption}", stuck,
    )  # fmt: skip
    return _motion_figure(drawn, workspace, task)


def _motion_figure(drawn: _DrawnMotion, workspace: ir.Workspace, task: ir.Task) -> str:
    robot = drawn_robot(drawn.model, drawn.theta)
    n, dimension = len(drawn.model.dofs), workspace.dimension
    x = drawn.x if drawn.stuck is None else drawn.x[: drawn.stuck + 1]
    poses = robot.points(x[:, :n])
    cells = [drawn.abstraction.cells[cell] for cell in sorted(set(drawn.cells))]
    names = {cell.name for cell in cells}
    shapes = workspace_shapes(workspace, cells)
    seen = np.concatenate([shapes[0].corners, robot.own(poses).reshape(-1, dimension)])
    view = from_above(seen)
    way = cell_path(drawn.abstraction, list(drawn.cells))
    line = view.project(_effector_line(drawn.model, drawn.leader, robot, x, float(task.step)))
    last = symbol("finish", "star", *line[-1])
    drawing = np.concatenate([line, view.project(way)])
    boxes = name_boxes(shapes, view, drawing)
    marks = (
        plane_axes(view)
        + shape_marks(shapes, view, names)
        + f'<path class="way" d="{line_path(view.project(way))}"/>'
        + _ghosts(robot, poses, view)
        + f'<path class="trace" d="{line_path(line)}"/>{symbol("begin", "disc", *line[0])}'
        + f'<g class="robot">{pose_marks(robot, poses[-1], view, boxes)}</g>'
        + (last if drawn.stuck is None else symbol("stuck", "cross", *line[-1]))
        + shape_names(shapes, view, drawing)
    )
    left, below = AXES_ROOM
    along = ", seen along z" if dimension == 3 else ""
    size = left + view.width, view.height + below
    kind = "scene space" if dimension == 3 else "scene"
    legend = _legend(shapes, stuck=drawn.stuck is not None)
    return document(moved(left, 0, marks), size, kind, f"{drawn.title}{along}", legend)


def _legend(shapes: Sequence[WorkspaceShape], *, stuck: bool) -> list[tuple[str, str]]:
    kinds = {shape.kind for shape in shapes}
    found: list[tuple[str, str]] = [
        (sample, kind) for kind, sample in KIND_SAMPLES.items() if kind in kinds
    ]
    line = f"M0 6h{SAMPLE:g}"
    found += [
        (CELL_SAMPLE, "cell of the path"),
        (f'<path class="way" d="{line}"/>', "cell path"),
        (f'<path class="trace" d="{line}"/>', "effector"),
        (f'<line class="rod" x1="2" x2="{SAMPLE - 2:g}" y1="6" y2="6"/>', "robot"),
    ]
    if stuck:
        found.append((symbol("stuck", "cross", SAMPLE / 2, 6), "stuck here"))
    return found


def _caption(model: RobotModel, task: ir.Task, theta: Array, robustness: float) -> str:
    """The parameters and the robustness, in the unit of the inputs or, with several, as a share."""
    bounds = {(bound.unit, bound.widest_margin) for bound in input_bounds(model, task)}
    written = number(robustness)
    if len(bounds) == 1:
        ((unit, _),) = bounds
        written = with_unit(robustness, unit)
    elif bounds:
        widest = float(max(margin for _, margin in bounds))
        written = f"{number(100 * robustness / widest)} %" if widest > 0 else written
    values = [
        f"{p.name} {with_unit(float(value), p.unit, 3)}"
        for p, value in zip(model.parameters, theta, strict=True)
    ]
    return "; ".join([*filter(None, [", ".join(values)]), f"robustness {written}"])


def _effector_line(
    model: RobotModel, leader: int, robot: DrawnRobot, x: Array, step: float
) -> Array:
    """The curve of the leading effector, (K, d), interpolated by Hermite cubics between samples."""
    n = len(model.dofs)
    turning = np.array([dof.kind == "revolute" for dof in model.dofs], dtype=bool)
    found = motion_samples(
        np.arange(len(x), dtype=np.float64) * step, x[:, :n], x[:, n : 2 * n], turning=turning,
        most=MOST_INSTANTS, least=LEAST_INSTANTS,
    )  # fmt: skip
    line: Array = robot.points(found.coordinates)[:, robot.effectors[leader]]
    return line


def _ghosts(robot: DrawnRobot, poses: Array, view: View) -> str:
    """The robot at equal intervals of time, later poses stronger; without the last pose."""
    samples = np.unique(np.linspace(0, len(poses) - 1, GHOSTS + 1).round().astype(int))[:-1]
    return "".join(
        f'<g class="ghost" opacity="{0.15 + 0.35 * rank / len(samples):.2f}">'
        f"{ghost_marks(robot, poses[sample], view)}</g>"
        for rank, sample in enumerate(samples)
    )


def input_figure(design: Design, task: ir.Task) -> str:
    """Inputs over time with their bounds (case study, figure (b))."""
    u = design.configuration.outcome.trajectory.u
    times: Array = np.arange(task.steps + 1, dtype=np.float64) * float(task.step)
    panels = []
    for bound in input_bounds(design.model, task):
        low, high = float(bound.lower), float(bound.upper)
        curves = [
            thinned(
                Curve(
                    f"u{i + 1}",
                    "",
                    bound.unit,
                    times,
                    u[:, i],
                    held=True,
                    bounds=(low, high),
                    series=k,
                )
            )
            for k, i in enumerate(bound.inputs, 1)
        ]
        says = f"bound ±{number(high)}" if low == -high else f"{number(low)} to {number(high)}"
        title = f"{'effort' if bound.effort else 'input'} ({bound.unit}), {says} {bound.unit}"
        panels.append(_panel(curves, title))
    if not robot_inputs(design.model):
        panels.append(label(0, 14, "start", "the robot has no inputs", ' class="says"'))
    content = "".join(
        moved(0, (PANEL + HEADING) * number, panel) for number, panel in enumerate(panels)
    )
    height = (PANEL + HEADING) * len(panels)
    title = f"{task.name}: inputs of robot {' '.join(design.derivation.word)} over time"
    return document(content, (WIDE, height), "chart", title)


def _panel(curves: Sequence[Curve], title: str) -> str:
    """The chart of the inputs that share a bound, with a heading."""
    names = "".join(
        moved(
            WIDE - 60.0 * (len(curves) - rank), 0,
            f'<path class="line {colour_class(curve)}" d="M0 8h20"/>'
            + label(26, 12, "start", curve.name),
        )
        for rank, curve in enumerate(curves)
    )  # fmt: skip
    chart = curve_marks(curves, plot_of(curves, WIDE, PANEL))
    return f"{label(0, 12, 'start', title)}{names}{moved(0, HEADING, chart)}"
