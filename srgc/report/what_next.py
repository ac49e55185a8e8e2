"""What to do next with a result, by its verdict."""

from __future__ import annotations

from collections.abc import Iterator

from solvers.verifier.report import Outcome
from srgc.render.html_text import text
from srgc.report.evidence import Evidence


def next_section(evidence: Evidence) -> str:
    """A few commands, and the purpose of each."""
    items = "".join(
        f"<li><code>{text(command)}</code> {text(what)}</li>" for command, what in _steps(evidence)
    )
    advice = "".join(f"<p>{text(each)}</p>" for each in _advice(evidence))
    return (
        f'<section id="next"><h2>What next</h2>{advice}'
        f"<p>In the folder of this page:</p><ul>{items}</ul></section>"
    )


def _advice(evidence: Evidence) -> Iterator[str]:
    nearest = evidence.design.get("nearest")
    first = nearest.get("try_first") if isinstance(nearest, dict) else None
    if evidence.verdict == "unknown" and isinstance(first, str):
        yield f"Try first {first.replace('`', '')}."
    report = evidence.report
    if report is not None and report.outcome in (Outcome.REFUTED, Outcome.DISAGREEMENT):
        yield "Do not use this result: its certificate is refuted."


def _steps(evidence: Evidence) -> Iterator[tuple[str, str]]:
    if evidence.verdict == "found":
        yield "srgc verify .", "checks the proof again"
        yield "srgc view .", "shows the motion from all sides"
        yield "srgc export . --to urdf", "writes the robot for other tools"
        return
    yield "srgc why .", "says which lines stand in the way, and what would help"
    if evidence.verdict == "impossible":
        yield "srgc verify .", "checks the proof again"
