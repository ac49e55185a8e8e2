"""The outcome of a synthesis as plain text."""

from __future__ import annotations

from fractions import Fraction

from compiler.candidates.reconfiguration import Reconfiguration
from compiler.robots.state_and_input import robot_inputs
from solvers.design import Design
from solvers.synthesis import OUT_OF_TIME, Synthesis
from srgc.text_reports.reconfiguration_report import change_lines


def _declared_inputs(design: Design) -> list[str]:
    """The range that each declared input uses."""
    lines = []
    for place, item in enumerate(robot_inputs(design.model)):
        if item.domain is not None:
            values = [float(Fraction(row[place])) for row in design.inputs]
            used = f"{min(values):.4f} to {max(values):.4f} {_shown(item.unit)}".rstrip()
            lines.append(f"input:   {item.module}.{item.name} {used} (symbol {item.symbol})")
    return lines


def _shown(unit: str) -> str:
    """A unit as it is written behind a number: nothing where there is none."""
    return "" if unit == "1" else unit


def synthesis_text(
    result: Synthesis, folder: str, table: str = "", change: Reconfiguration | None = None
) -> str:
    """The outcome of a synthesis in a few lines.

    ``table`` is about all designs, ``change`` about what becomes of the existing robot.
    """
    lines = [f"verdict: {result.verdict}" + (f" ({result.reason})" if result.reason else "")]
    design = result.design
    if design is not None:
        lines.append(f"robot:   {' '.join(design.derivation.word)}")
        for p, claim in zip(design.model.parameters, design.parameters, strict=True):
            value = f"{float(Fraction(claim.value)):.4f} {_shown(p.unit)}".rstrip()
            lines.append(f"         {p.module}.{p.name} = {value} (symbol {p.symbol})")
        if change is not None:
            lines += change_lines(change)
        outcome = design.configuration.outcome
        lines.append(
            f"effort:  peak {outcome.effort_peak:.4f}, robustness {outcome.robustness:.4f}"
        )
        lines += _declared_inputs(design)
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
