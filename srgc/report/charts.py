"""Charts of coordinates, rates, own states and inputs over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from compiler.arrays import Array
from compiler.robots.state_and_input import (
    InputBound,
    RobotInput,
    input_bounds,
    robot_inputs,
    robot_states,
)
from compiler.tasks.obstacle_pieces import expanded
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from srgc.render.charts import Curve, line_chart, sampled, thinned
from srgc.render.html_text import json_script, number, text
from srgc.report.evidence import Evidence
from srgc.report.tables import Trajectory
from srgc.results.found_design import FoundDesign

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube

POINTS = 160
"""The least number of points of a curve, if a tube gives values between the samples."""


def charts_section(evidence: Evidence) -> str:
    """The charts with their data; empty without a design, or if it cannot move."""
    groups = motion_curves(evidence)
    if not groups:
        return ""
    data = {curve.name: _data(curve) for group in groups for curve in group.curves}
    body = "".join(map(_group, groups))
    return (
        '<section id="charts"><h2>Over time</h2>'
        f"<p>{_legend(evidence)}</p>{body}{json_script('chart-data', data)}</section>"
    )


def _legend(evidence: Evidence) -> str:
    drawn = (
        "Curves are drawn to their own scale. Dashed lines are bounds; the bar on the right of a "
        "chart goes from one bound to the other, and its dark part is what the motion uses. "
        '<span class="screen-only">Click a chart to go to that time.</span>'
    )
    width = widest(evidence)
    if width is None:
        return drawn
    all_motions = "all rounds of all motions" if evidence.task.repeat else "all disturbed motions"
    motions = (
        f"The tube holds {all_motions}; at"
        if evidence.tube is not None and evidence.tube.disturbed
        else "Where no band is drawn, the proved tube is too narrow to be seen; at"
    )
    wide = f"it is up to about {number(width, 2)} (rad or m) wide"
    fed_back = evidence.found is not None and evidence.found.feedback is not None
    commanded = " The band of an input holds all that is commanded in the tube." if fed_back else ""
    return f"{drawn} {motions} the instants that are drawn {wide}.{commanded}"


def _group(group: CurveGroup) -> str:
    figures = "".join(map(_figure, group.curves))
    return f'<h3>{text(group.title)}</h3><div class="charts">{figures}</div>'


def _figure(curve: Curve) -> str:
    unit = "" if curve.unit == "1" else f" ({text(curve.unit)})"
    return (
        f"<figure><figcaption><span>{text(curve.title)}{unit}</span>"
        f'<output class="screen-only" data-for="{text(curve.name)}">'
        f"{number(float(curve.values[0]))}</output></figcaption>{line_chart(curve)}</figure>"
    )


def _data(curve: Curve) -> dict[str, Any]:
    return {
        "t": sampled(curve.times),
        "v": sampled(curve.values),
        "held": curve.held,
        "turns": curve.unit == "rad",
    }


# --- Curves ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class CurveGroup:
    """Curves under a common heading."""

    title: str
    curves: tuple[Curve, ...]


def motion_curves(evidence: Evidence) -> tuple[CurveGroup, ...]:
    """All groups of curves of a design; empty without a design."""
    found, motion = evidence.found, evidence.trajectory
    if found is None or motion is None:
        return ()
    groups = _groups(found, motion, _state_lines(evidence, motion), evidence.tube)
    return tuple(CurveGroup(group.title, tuple(map(thinned, group.curves))) for group in groups)


def planned_curves(found: FoundDesign, motion: Trajectory) -> tuple[CurveGroup, ...]:
    """All groups of curves of a motion at its samples, without a tube."""
    lines = _StateLines(motion.t, np.hstack([motion.q, motion.qd]), None)
    return _groups(found, motion, lines, None)


def _groups(
    found: FoundDesign, motion: Trajectory, lines: _StateLines, tube: CertifiedTube | None
) -> tuple[CurveGroup, ...]:
    groups = (
        CurveGroup("Coordinates", tuple(_coordinates(found, lines))),
        CurveGroup("Rates", tuple(_rates(found, lines))),
        CurveGroup("States of the modules’ own", tuple(_states(found, motion))),
        CurveGroup("Inputs", tuple(_inputs(found, motion, tube))),
    )
    return tuple(group for group in groups if group.curves)


def widest(evidence: Evidence) -> float | None:
    """The greatest width of the tube of coordinates at an instant, in rad or m; None if no tube."""
    found, motion = evidence.found, evidence.trajectory
    if found is None or motion is None:
        return None
    bands, n = _state_lines(evidence, motion).bands, len(found.model.dofs)
    if bands is None or not n:
        return None
    return float((bands[:, :n, 1] - bands[:, :n, 0]).max())


@dataclass(frozen=True, slots=True)
class _StateLines:
    """Coordinates and rates: times (k,), values (k, 2 n), and bounds of the tube (k, 2 n, 2)."""

    times: Array
    values: Array
    bands: Array | None


def _state_lines(evidence: Evidence, motion: Trajectory) -> _StateLines:
    """The middle of the tube, also between the samples; without a tube, the samples.

    In a tube of disturbed motions the planned motion need not be in the middle, so the samples are
    interpolated instead.
    """
    tube, times, samples = evidence.tube, motion.t, np.hstack([motion.q, motion.qd])
    if tube is None:
        return _StateLines(times, samples, None)
    parts = -(-POINTS // (len(times) - 1))
    fine = np.interp(np.arange((len(times) - 1) * parts + 1) / parts, np.arange(len(times)), times)
    end = float(tube.times[-1])
    bands = np.array([tube.at(min(float(time), end)) for time in fine])
    values = bands.mean(axis=-1)
    if tube.disturbed:
        # a robot without joints has no columns
        rows = [np.interp(fine, times, column) for column in samples.T]
        values = np.reshape(rows, (len(rows), len(fine))).T
    return _StateLines(fine, values, bands)


def modules_of(word: Sequence[str], symbols: Sequence[int]) -> str:
    """The modules at the given places of a word, such as ``JO at symbol 2``."""
    names = " and ".join(dict.fromkeys(word[symbol] for symbol in symbols))
    places = " and ".join(str(symbol) for symbol in symbols)
    return f"{names} at symbol {places}"


def _ends(interval: ir.Interval | None) -> tuple[float | None, float | None]:
    if interval is None:
        return None, None
    return to_float(interval.lower), to_float(interval.upper)


def _coordinates(found: FoundDesign, lines: _StateLines) -> Iterator[Curve]:
    for i, dof in enumerate(found.model.dofs):
        yield Curve(
            f"q{i + 1}",
            f"q{i + 1}, {modules_of(found.claim.word, dof.symbols)}",
            "rad" if dof.kind == "revolute" else "m",
            lines.times,
            lines.values[:, i],
            bounds=_ends(dof.range),
            band=None if lines.bands is None else lines.bands[:, i],
            series=i + 1,
        )


def _rates(found: FoundDesign, lines: _StateLines) -> Iterator[Curve]:
    n = len(found.model.dofs)
    for i, dof in enumerate(found.model.dofs):
        yield Curve(
            f"qd{i + 1}",
            f"q̇{i + 1}, {modules_of(found.claim.word, dof.symbols)}",
            "rad/s" if dof.kind == "revolute" else "m/s",
            lines.times,
            lines.values[:, n + i],
            bounds=_ends(dof.rate),
            band=None if lines.bands is None else lines.bands[:, n + i],
            series=i + 1,
        )


def _states(found: FoundDesign, motion: Trajectory) -> Iterator[Curve]:
    for i, state in enumerate(robot_states(found.model)):
        name = f"{state.module}.{state.name} at symbol {state.symbol}"
        yield Curve(f"s{i + 1}", name, state.unit, motion.t, motion.s[:, i], series=i + 1)


def _inputs(found: FoundDesign, motion: Trajectory, tube: CertifiedTube | None) -> Iterator[Curve]:
    """The planned inputs, with the range that a controller may command in the proved tube."""
    _, task = expanded(found.program, found.task)
    bounds = input_bounds(found.model, task)
    bands = tube.commanded if tube is not None and found.feedback is not None else None
    for i, item in enumerate(robot_inputs(found.model)):
        bound = next((each for each in bounds if i in each.inputs), None)
        low, high = (None, None) if bound is None else (float(bound.lower), float(bound.upper))
        yield Curve(
            f"u{i + 1}", f"u{i + 1}, {_input_name(found, item)}", item.unit, motion.t,
            motion.u[:, i], held=True, bounds=(low, high),
            band=None if bands is None else bands[:, i], series=i + 1,
        )  # fmt: skip
    for place, bound in enumerate(bounds, 1):
        if bound.norm2:
            yield _norm(bound, place, motion, bands)


def _norm(bound: InputBound, place: int, motion: Trajectory, bands: Array | None) -> Curve:
    names = ", ".join(f"u{i + 1}" for i in bound.inputs)
    values = np.linalg.norm(motion.u[:, list(bound.inputs)], axis=1)
    if bands is not None:
        own = bands[:, list(bound.inputs)]
        least = np.maximum(np.maximum(own[..., 0], -own[..., 1]), 0.0)
        most = np.abs(own).max(axis=-1)
        bands = np.stack([np.linalg.norm(each, axis=1) for each in (least, most)], axis=-1)
    return Curve(
        f"norm{place}", f"norm of {names}", bound.unit, motion.t, values, held=True,
        bounds=(0.0, float(bound.upper)), band=bands, series=place,
    )  # fmt: skip


def _input_name(found: FoundDesign, item: RobotInput) -> str:
    if item.is_load:
        return f"{item.name}, 1 where it is there"
    if item.dof is None:
        return f"{item.module}.{item.name} at symbol {item.symbol}"
    return modules_of(found.claim.word, found.model.dofs[item.dof].symbols)
