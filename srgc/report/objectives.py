"""The objectives of the task: the design's values, what is proved, and the front of designs."""

from __future__ import annotations

from fractions import Fraction

from compiler.objectives.objective_text import gap_text
from solvers.verifier.report import Outcome
from srgc.render.html_text import text
from srgc.report.compared_designs import compared_designs
from srgc.report.evidence import Evidence
from srgc.report.front import front_part
from srgc.results.stated_objectives import Objective

HEADS = ("objective", "value", "proved least", "gap", "undecided", "what is claimed")


def objectives_section(evidence: Evidence) -> str:
    """The objectives with the claims about them, and the front; empty without objectives."""
    if not evidence.objectives:
        return ""
    heads = "".join(
        f'<th class="figure">{head}</th>' if 0 < place < 5 else f"<th>{head}</th>"
        for place, head in enumerate(HEADS)
    )
    rows = "".join(_row(each, first=k == 0) for k, each in enumerate(evidence.objectives))
    designs = compared_designs(evidence)
    front = "" if designs is None or not designs.named else front_part(evidence, designs)
    return (
        f'<section id="objectives"><h2>Objectives</h2><p>{_checked(evidence)}</p>'
        f'<div class="scroll"><table class="folded"><thead><tr>{heads}</tr></thead>'
        f"<tbody>{rows}</tbody></table>"
        f"</div>{front}</section>"
    )


def _checked(evidence: Evidence) -> str:
    """Whether the claims are proved."""
    asked = (
        "The task asks for the least of each, in turn: each among the robots that are within what "
        "those before leave."
    )
    if evidence.report is None:
        return f"{asked} The claims were not checked for this page."
    if evidence.report.outcome is Outcome.VALID:
        return f"{asked} The claims were checked with the rest of the certificate, and hold."
    return f"{asked} The certificate was not found valid: nothing is proved of them."


def _row(one: Objective, *, first: bool) -> str:
    nothing = not one.least > 0 and not one.is_least
    least = "" if nothing else text(one.amount(one.least))
    gap = "" if nothing or one.gap is None else gap_text(Fraction(one.gap))
    claim = one.claim(first=first)
    says = "; ".join(part for part in (claim, one.open) if part)
    figures = text(one.amount(one.value)), least, gap, str(one.undecided)
    cells = "".join(
        f'<td class="figure" data-head="{head}">{figure}</td>'
        for head, figure in zip(HEADS[1:5], figures, strict=True)
    )
    return (
        f'<tr data-objective="{text(one.objective)}"><td>{text(one.name)}</td>{cells}'
        f"<td>{text(says[0].upper() + says[1:])}.</td></tr>"
    )
