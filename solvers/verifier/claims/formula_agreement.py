"""What ``design.json`` says of the formulas of a found robot's task."""

from __future__ import annotations

import json
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any

from compiler.tasks.formula_text import formula_text
from grammar_lang import ir
from solvers.verifier.claims.spec_copy import bounded_bytes
from solvers.verifier.proofs.checked_condition import CheckedCondition

CLOSELY = 1e-9
"""How far a stated robustness may be from the proved one, in metres: balls depend on libraries."""


def satisfied_formulas(task: ir.Task, findings: Sequence[CheckedCondition]) -> list[dict[str, Any]]:
    """Per ``satisfy`` its text and a lower bound of its robustness in metres.

    The bound is None where the formula holds wherever the effectors are.
    """
    bounds = {finding.clause: finding.margin for finding in findings}
    return [
        {
            "formula": formula_text(clause.formula),
            "robustness": bounds[number] if bounds[number] < inf else None,
        }
        for number, clause in enumerate(task.satisfy)
    ]


def misstated_formula(
    folder: Path, task: ir.Task, findings: Sequence[CheckedCondition]
) -> str | None:
    """Why the folder's ``design.json`` misstates a proved formula, or None.

    Args:
        folder: the result folder, whose ``design.json``, if there is one, is a JSON object.
        task: the task.
        findings: the proof of the claim, which holds.
    """
    path = folder / "design.json"
    if not path.is_file():
        return None
    stated = json.loads(bounded_bytes(path)).get("satisfy", [])
    proved = satisfied_formulas(task, findings)
    if not isinstance(stated, list) or len(stated) != len(proved):
        return "design.json states other formulas than the task in `satisfy`"
    for number, (said, true) in enumerate(zip(stated, proved, strict=True), 1):
        if not isinstance(said, dict) or said.get("formula") != true["formula"]:
            return f"design.json states another formula than the task's `satisfy` {number}"
        if not _near(said.get("robustness"), true["robustness"]):
            return (
                f"the robustness of `satisfy` {number} is {true['robustness']}, "
                f"not {said.get('robustness')} as in design.json"
            )
    return None


def _near(stated: object, proved: float | None) -> bool:
    if stated is None or proved is None:
        return stated is proved
    number = isinstance(stated, float | int) and not isinstance(stated, bool)
    return number and abs(float(str(stated)) - proved) <= CLOSELY
