"""The effect of feedback: the width of the proved tube over time, and the controller's gains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from compiler.arrays import Array
from compiler.robots.state_and_input import input_bounds, robot_inputs
from solvers.verifier.proofs.effort_bounds import bound_name
from srgc.render.charts import Curve, colour_class, lines_chart, thinned
from srgc.render.html_text import text, with_unit
from srgc.report.evidence import Evidence
from srgc.report.tables import Trajectory
from srgc.results.found_design import Feedback, FoundDesign

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube

MOST_VALUES, FEWEST = 10_000, 20
"""The most values drawn of all gains together, and the fewest of each gain."""
UNITS = {"revolute": ("rad", "rad/s"), "prismatic": ("m", "m/s")}
LAW = (
    "At each sample the controller measures coordinates and rates, and holds the planned inputs, "
    "less the gains times the deviations from the planned motion, until the next. A chart shows "
    "what one unit of a deviation takes away from an input."
)


def width_section(evidence: Evidence) -> str:
    """The width of the tube of all motions; empty if there is only one motion."""
    found, motion = evidence.found, evidence.trajectory
    if found is None or motion is None or evidence.tube is None or not evidence.tube.disturbed:
        return ""
    charts = "".join(
        _figure(title, curves, name)
        for name, title, curves in _widths(evidence.tube, found, motion)
    )
    motions = "rounds of any motions" if evidence.task.repeat else "disturbed motions"
    return (
        f'<section id="width"><h2>Width of the tube</h2><p>How far any two {motions} can '
        "be apart at a sample, by the proof: the width of the box that holds all of them; of an "
        "effector, its longest side.</p>"
        f'<div class="charts">{charts}</div></section>'
    )


def gains_section(evidence: Evidence) -> str:
    """The gains of a controller; empty for open loop."""
    found, motion = evidence.found, evidence.trajectory
    if found is None or motion is None or found.feedback is None:
        return ""
    charts = "".join(
        _figure(title, curves, name)
        for name, title, curves in _gains(found, found.feedback, motion)
    )
    return (
        f'<section id="gains"><h2>The controller</h2><p>{LAW}</p>'
        f'<div class="charts">{charts}</div></section>'
    )


def commanded_peak(evidence: Evidence, found: FoundDesign) -> Iterator[tuple[str, str]]:
    """The greatest effort of each kind that feedback commands anywhere in the proved tube."""
    if evidence.report is None or found.claim.controller is None or evidence.task.robust is None:
        return
    margins = {each.name: each.margin for each in evidence.report.conditions}
    bounds = input_bounds(found.model, found.task)
    most = [
        with_unit(float(bound.upper) - margins[bound_name(bound)], bound.unit)
        for bound in bounds
        if bound.effort and bound_name(bound) in margins
    ]
    if most:
        yield "peak effort in the tube", " and ".join(most)


def _figure(title: str, curves: Sequence[Curve], name: str) -> str:
    legend = " ".join(
        f'<span class="key {colour_class(curve)}">{text(curve.title)}</span>' for curve in curves
    )
    return (
        f"<figure><figcaption><span>{text(title)}</span><span>{legend}</span>"
        f"</figcaption>{lines_chart(curves, name)}</figure>"
    )


# --- Widths ---------------------------------------------------------------------------------------


def _widths(
    tube: CertifiedTube, found: FoundDesign, motion: Trajectory
) -> Iterator[tuple[str, str, list[Curve]]]:
    """Name, title and curves for each unit of coordinates and of rates, and for all effectors."""
    bounds, n = tube.samples, len(found.model.dofs)
    widths: Array = bounds[..., 1] - bounds[..., 0]
    for rank, (mark, kind) in enumerate((("q", "coordinates"), ("q̇", "rates"))):
        for unit, places in _by_unit(found, rank):
            curves = [
                Curve(f"width-{mark}{i + 1}", f"{mark}{i + 1}", unit, motion.t,
                      widths[:, rank * n + i], series=i + 1)
                for i in places
            ]  # fmt: skip
            yield f"width-{kind}-{unit}", f"{kind} ({unit})", curves
    boxes = tube.sample_points[:, : len(found.model.effectors)]
    sides: Array = (boxes[..., 1] - boxes[..., 0]).max(axis=-1)
    curves = [
        Curve(f"width-e{e + 1}", f"effector {e + 1}", "m", motion.t, sides[:, e], series=e + 1)
        for e in range(sides.shape[1])
    ]
    yield "width-effectors", "effectors (m)", curves


def _by_unit(found: FoundDesign, rank: int) -> list[tuple[str, list[int]]]:
    """The joints grouped by the unit of their coordinates (rank 0) or rates (rank 1)."""
    units = [UNITS[dof.kind][rank] for dof in found.model.dofs]
    return [
        (unit, [i for i, own in enumerate(units) if own == unit]) for unit in dict.fromkeys(units)
    ]


# --- Gains ----------------------------------------------------------------------------------------


def _gains(
    found: FoundDesign, feedback: Feedback, motion: Trajectory
) -> Iterator[tuple[str, str, list[Curve]]]:
    """Name, title and curves for each input and each unit of the measured quantities."""
    n = len(found.model.dofs)
    most = max(FEWEST, MOST_VALUES // max(1, feedback.gains[0].size))
    for j, item in enumerate(robot_inputs(found.model)):
        if item.is_load:
            continue
        for rank, mark in enumerate(("q", "q̇")):
            for unit, places in _by_unit(found, rank):
                curves = [
                    thinned(
                        Curve(f"gain-{j + 1}-{mark}{i + 1}", f"{mark}{i + 1}", "1", motion.t,
                              feedback.gains[:, j, rank * n + i], held=True, series=i + 1),
                        most,
                    )
                    for i in places
                ]  # fmt: skip
                yield f"gain-{j + 1}-{unit}", f"of u{j + 1} ({item.unit} per {unit})", curves
