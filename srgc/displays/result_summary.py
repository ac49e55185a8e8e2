"""The outcome of a synthesis: verdict, robot, parameters, margins and the picture of its motion."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from solvers.verifier.report import Report
from srgc.displays.figure import image
from srgc.displays.verification_table import conditions_table
from srgc.render.html_block import block, code, head, lines, table
from srgc.render.html_text import text, with_unit
from srgc.text_reports.used_inputs import UsedInputs, amount

_COLOURS = {"found": "good", "impossible": "bad"}


def result_text(design: Mapping[str, Any], used: Sequence[UsedInputs]) -> str:
    """The outcome in a few lines; ``used``: what a motion uses of its inputs."""
    facts = _facts(design, used)
    rows = [("verdict", str(design["verdict"])), *facts, ("tried", _tried(design))]
    return "\n".join(f"{name + ':':<12} {said}" for name, said in rows)


def result_html(
    folder: Path, design: Mapping[str, Any], used: Sequence[UsedInputs], report: Report | None
) -> str:
    """The same as a display; ``report`` is what the verifier has said of the outcome."""
    verdict = str(design["verdict"])
    rows = [
        (text(name), code(said) if name == "robot" else text(said))
        for name, said in _facts(design, used)
    ]
    rows.append(("tried", text(_tried(design))))
    picture = folder / "figures" / "workspace.svg"
    shown = ""
    if design["word"] is not None and picture.is_file():
        shown = image(picture.read_text(encoding="utf-8"), "the motion of the robot")
    checked = lines("not verified yet") if report is None else _checked(report)
    return block(
        head(f"task {design['task']}", verdict, _COLOURS.get(verdict, "open")),
        f'<div class="side"><div>{table(("", ""), rows)}{checked}</div>{shown}</div>',
    )


def _checked(report: Report) -> str:
    level = f", level {report.level}" if report.level else ""
    return lines(f"verified: {report.outcome.value}{level}") + conditions_table(report)


def _facts(design: Mapping[str, Any], used: Sequence[UsedInputs]) -> Iterator[tuple[str, str]]:
    if design["reason"] is not None:
        yield "reason", str(design["reason"])
    if design["word"] is None:
        return
    yield "robot", " ".join(design["word"])
    for one in design["parameters"]:
        name = f"{one['symbol']}.{one['name']}"
        yield name, with_unit(float(one["value"]), str(one["unit"]), 6)
    for each in used:
        name = "effort" if each.effort else each.name.removeprefix("input ")
        peak, left = amount(each.peak, each.unit), amount(each.margin, each.unit)
        yield name, f"peak {peak}, robustness {left}"


def _tried(design: Mapping[str, Any]) -> str:
    tried = design["structures_tried"]
    counts = Counter(
        "same" if one["same_robot_as"] is not None else one["verdict"] for one in tried
    )
    return (
        f"{len(tried)} structures, {counts['refuted']} robots refuted, "
        f"{counts['same']} equal to an earlier one"
    )
