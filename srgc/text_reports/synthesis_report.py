"""The outcome of a synthesis as plain text."""

from __future__ import annotations

from collections.abc import Iterator

from compiler.robots.reconfiguration import Reconfiguration
from grammar_lang import ir
from solvers.search.design import Design
from solvers.search.synthesis import OUT_OF_TIME, Synthesis
from srgc.text_reports.reconfiguration_report import change_lines
from srgc.text_reports.used_inputs import amount, used_inputs


def _inputs(design: Design, task: ir.Task) -> Iterator[str]:
    """What the motion uses of each bound on its inputs, and what it leaves."""
    used = used_inputs(design.model, task, design.inputs)
    for each in used:
        left = f"robustness {amount(each.margin, each.unit)}"
        if each.effort:
            yield f"effort:  peak {amount(each.peak, each.unit)}, {left}"
        else:
            name = each.name.removeprefix("input ")
            yield f"input:   {name} {each.low:.4g} to {amount(each.high, each.unit)}, {left}"
    if not used:
        yield "effort:  none, no joint is driven"


def synthesis_text(
    result: Synthesis,
    task: ir.Task,
    folder: str,
    table: str = "",
    change: Reconfiguration | None = None,
) -> str:
    """The outcome of the synthesis of a task in a few lines.

    ``table`` is about all designs, ``change`` about what becomes of the existing robot.
    """
    lines = [f"verdict: {result.verdict}" + (f" ({result.reason})" if result.reason else "")]
    design = result.design
    if design is not None:
        lines.append(f"robot:   {' '.join(design.derivation.word)}")
        for value in design.parameters:
            p, shown = value.parameter, amount(float(value), value.parameter.unit, 5)
            lines.append(f"         {p.module}.{p.name} = {shown} (symbol {p.symbol})")
        if change is not None:
            lines += change_lines(change)
        lines += _inputs(design, task)
        lines += [
            f"formula: {finding.name}, robustness {finding.margin:.4g} m"
            for finding in design.findings
            if finding.clause is not None
        ]
        if design.model.removed:
            gone = ", ".join(str(symbol) for symbol in design.model.removed)
            lines.append(f"removed: joints that move nothing (symbols {gone})")
    refuted = sum(1 for r in result.records if r.verdict == "refuted")
    same = sum(1 for r in result.records if r.same_robot_as is not None)
    lines.append(
        f"tried:   {len(result.records)} structures, {refuted} robots refuted, "
        f"{same} equal to an earlier one"
    )
    if table:
        lines.append(f"designs: {len(result.designs)}\n{table}")
    lines.append(f"results: {folder}")
    if design is not None and result.unfinished and result.ended is None:
        lines.append(f"         {OUT_OF_TIME} before it was drawn: the same command does that")
    return "\n".join(lines)
