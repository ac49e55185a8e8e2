"""Coordinates, rates, own states and inputs over time."""

from __future__ import annotations

from typing import Any

from srgc.render.html_text import json_script, number, text
from srgc.render.line_chart import Curve, line_chart, sampled
from srgc.report.evidence import Evidence
from srgc.report.motion_curves import CurveGroup, motion_curves, widest


def charts_section(evidence: Evidence) -> str:
    """The charts with their data; nothing for a robot that was not found or cannot move."""
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
        '<span class="screen-only">Tap a chart to go to that time.</span>'
    )
    width = widest(evidence)
    if width is None:
        return drawn
    motions = (
        "The tube holds all disturbed motions; at"
        if evidence.tube is not None and evidence.tube.disturbed
        else "Where no band is drawn, the proved tube is too narrow to be seen; at"
    )
    wide = f"it is up to about {number(width, 2)} (rad or m) wide"
    return f"{drawn} {motions} the instants that are drawn {wide}."


def _group(group: CurveGroup) -> str:
    figures = "".join(map(_figure, group.curves))
    return f'<h3>{text(group.title)}</h3><div class="charts">{figures}</div>'


def _figure(curve: Curve) -> str:
    unit = "" if curve.unit == "1" else f" ({text(curve.unit.replace('*', '·'))})"
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
