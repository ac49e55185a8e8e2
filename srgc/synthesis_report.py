"""The outcome of a synthesis as plain text."""

from __future__ import annotations

from fractions import Fraction

from solvers.synthesis import Synthesis


def synthesis_text(result: Synthesis, folder: str) -> str:
    """The outcome of a synthesis in a few lines."""
    lines = [f"verdict: {result.verdict}" + (f" ({result.reason})" if result.reason else "")]
    design = result.design
    if design is not None:
        lines.append(f"robot:   {' '.join(design.derivation.word)}")
        for p, claim in zip(design.model.parameters, design.parameters, strict=True):
            value = f"{float(Fraction(claim.value)):.4f} {p.unit}".rstrip()
            lines.append(f"         {p.module}.{p.name} = {value} (symbol {p.symbol})")
        outcome = design.configuration.outcome
        lines.append(
            f"effort:  peak {outcome.effort_peak:.4f}, robustness {outcome.robustness:.4f}"
        )
    refuted = sum(1 for r in result.records if r.verdict == "refuted")
    same = sum(1 for r in result.records if r.same_robot_as is not None)
    lines.append(
        f"tried:   {len(result.records)} structures, {refuted} robots refuted, "
        f"{same} equal to an earlier one"
    )
    lines.append(f"results: {folder}")
    return "\n".join(lines)
