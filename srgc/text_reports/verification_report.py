"""The verifier's answer as plain text, and as JSON."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite

from grammar_lang.files.file_tree import visible
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.energy_used import ENERGY
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, Report

LEAST_WIDTH = 34
"""Of the column of names."""
ORDER = (Status.FAILS, Status.UNDECIDED, Status.HOLDS)


def verification_text(report: Report) -> str:
    """The verifier's answer and what it is about, with all margins, the smallest first."""
    head = report.outcome.value
    if report.verdict is not None and report.outcome in (Outcome.VALID, Outcome.UNCHECKED):
        level = f", level {report.level}" if report.level else ""
        head = f"{head}: {report.verdict}{level}"
    if report.reason:
        head = f"{head}: {visible(report.reason)}"
    about = []
    if report.task is not None:
        spec = f"{report.spec}, sha256 {report.spec_sha256}"
        about = [f"task: {visible(report.task)}", f"spec: {visible(spec)}"]
    if report.control is not None and report.outcome is Outcome.VALID:
        about.append(f"control: {report.control}")
    shown = list(by_map(in_order(report.conditions)))
    width = max([LEAST_WIDTH, *(len(condition.name) for condition in shown)])
    lines = [
        f"  {condition.status.value:<9} {condition.name:<{width}} {_said(condition)}".rstrip()
        for condition in shown
    ]
    return "\n".join([head, *about, *lines])


def verification_json(report: Report) -> str:
    """The verifier's answer for other programs: every condition, none taken together."""
    content = {
        "outcome": report.outcome.value,
        "verdict": report.verdict,
        "task": report.task,
        "spec": report.spec,
        "spec_sha256": report.spec_sha256,
        "control": report.control,
        "level": report.level,
        "reason": report.reason,
        "findings": [
            {
                "name": condition.name,
                "status": condition.status.value,
                "margin": condition.margin if isfinite(condition.margin) else None,
                "unit": condition.unit,
                "time": condition.time,
                "place": list(condition.place) or None,
                "level": condition.level if condition.status is Status.HOLDS else None,
            }
            for condition in in_order(report.conditions)
        ],
    }
    return json.dumps(content, indent=1, ensure_ascii=False)


def in_order(conditions: Sequence[CheckedCondition]) -> list[CheckedCondition]:
    """What is violated, what is open, what holds; each by its margin, those without one last."""
    return sorted(conditions, key=lambda f: (ORDER.index(f.status), f.margin))


def _said(condition: CheckedCondition) -> str:
    """The margin of a condition, when and where it is, and that it is exact where it is."""
    parts = list[str]()
    if condition.name == ENERGY and isfinite(condition.most):
        parts.append(f"{condition.least(6):.6g} to {condition.most:.6g} J")
    elif isfinite(condition.margin):
        unit = "" if condition.unit == "1" else f" {condition.unit}"
        parts.append(f"margin {condition.least(6):.6g}{unit}")
    if condition.time is not None:
        place = ", ".join(f"{x:.4f}" for x in condition.place)
        parts.append(f"at {condition.time:.3f} s" + (f" ({place})" if place else ""))
    if condition.exact:
        parts.append("exact")
    return "  ".join(parts)


_PIECE = re.compile(r"(?P<what>.* to \w+)\.\d+")
"""A condition on one piece of a map of obstacles: of regions only these have names with a dot."""


def by_map(conditions: Sequence[CheckedCondition]) -> Iterator[CheckedCondition]:
    """The conditions, of those about the pieces of one map only the first of each status."""
    pieces = [_PIECE.fullmatch(condition.name) for condition in conditions]
    kinds = [
        None if piece is None else (piece["what"], condition.status)
        for piece, condition in zip(pieces, conditions, strict=True)
    ]
    counts, told = Counter(kinds), set[object]()
    for kind, condition in zip(kinds, conditions, strict=True):
        if kind is None or counts[kind] == 1:
            yield condition
        elif kind not in told:
            told.add(kind)
            yield replace(condition, name=f"{condition.name} and {counts[kind] - 1} more pieces")
