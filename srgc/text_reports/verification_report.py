"""The verifier's answer as plain text, and as JSON."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite
from textwrap import wrap

from grammar_lang.files.file_tree import visible
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.energy_used import ENERGY
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, Report
from srgc.text_reports.next_step import HEAD, WHY, WIDTH, next_command

NAMES = 13
"""The least width of the column of names: a margin, a time and a planar position fit beside it."""
SHARE = "of the bound"
"""What stands after a margin that is a share."""
ORDER = (Status.FAILS, Status.UNDECIDED, Status.HOLDS)


def verification_text(report: Report) -> str:
    """The verifier's answer and what it is about, with all margins, the smallest first.

    No line has more than 80 columns, unless it contains a reason or a name from the file.
    """
    return "\n".join([answer(report), *detail_lines(report)])


def answer(report: Report) -> str:
    """The verifier's answer with its reason, in one line that programs can rely on."""
    head = report.outcome.value
    if report.verdict is not None and report.outcome in (Outcome.VALID, Outcome.UNCHECKED):
        level = f", level {report.level}" if report.level else ""
        head = f"{head}: {report.verdict}{level}"
    return f"{head}: {visible(report.reason)}" if report.reason else head


def detail_lines(report: Report) -> list[str]:
    """What the answer is about, and every condition."""
    about = list[str]()
    if report.task is not None:
        about += [f"task: {visible(report.task)}", f"spec: {visible(str(report.spec))}"]
        about.append(f"sha256: {visible(str(report.spec_sha256))}")
    if report.control is not None and report.outcome is Outcome.VALID:
        about.append(f"control: {report.control}")
    shown = by_map(in_order(report.conditions))
    return about + [line for condition in shown for line in _condition_lines(condition)]


def _condition_lines(condition: CheckedCondition) -> list[str]:
    """A condition in one line; if that is too long, its margin is on another line."""
    status, said = f"  {condition.status.value:<9} ", _said(condition)
    line = f"{status}{condition.name:<{NAMES}}  {said}".rstrip()
    if len(line) <= WIDTH:
        return [line]
    indent = " " * len(status)
    return [
        *_wrapped(condition.name, status, indent),
        *_wrapped(said, f"{indent}  ", f"{indent}  "),
    ]


def _wrapped(text: str, first: str, rest: str) -> list[str]:
    """A text in lines of 80 columns, without breaking words."""
    return wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip


def verification_json(report: Report) -> str:
    """The verifier's answer as JSON, with every condition separately."""
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
    """Violated conditions, then undecided ones, then those that hold; each group by margin."""
    return sorted(conditions, key=lambda f: (ORDER.index(f.status), f.margin))


def _said(condition: CheckedCondition) -> str:
    """The margin of a condition, its time and place, and ``exact`` if it is exact."""
    parts = list[str]()
    if condition.name == ENERGY and isfinite(condition.most):
        parts.append(f"{condition.least(6):.6g} to {condition.most:.6g} J")
    elif isfinite(condition.margin):
        unit = SHARE if condition.unit == "1" else condition.unit_text
        parts.append(f"margin {condition.least(6):.6g} {unit}")
    if condition.time is not None:
        place = ", ".join(f"{x:.4f}" for x in condition.place)
        parts.append(f"at {condition.time:.3f} s" + (f" ({place}) m" if place else ""))
    if condition.exact:
        parts.append("exact")
    return "  ".join(parts)


_PIECE = re.compile(r"(?P<what>.* to \w+)\.\d+")
"""A condition on one piece of an obstacle map: only these regions have a dot in their names."""


def by_map(conditions: Sequence[CheckedCondition]) -> Iterator[CheckedCondition]:
    """The conditions; for the pieces of one map, only the first condition of each status."""
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


# --- The next step --------------------------------------------------------------------------------


def after_verification(
    report: Report, folder: str, why: str = WHY, incomplete: str | None = None
) -> str:
    """The line about the next step, for results in a folder; ``why`` is what `srgc why` says.

    ``incomplete`` is the advice for a folder that lacks what `srgc report` and `srgc why` need.
    """
    if incomplete is not None and _goes_on(report):
        return f"{HEAD}{incomplete}"
    match report.outcome:
        case Outcome.VALID if report.verdict == "found":
            return next_command("srgc report", folder, "or srgc export")
        case Outcome.VALID:
            return next_command("srgc why", folder, why)
        case Outcome.UNCHECKED:
            return next_command("srgc verify --trust z3", folder)
        case Outcome.UNEXPECTED:
            return next_command("srgc verify", folder, "judges it, whatever it is about")
        case Outcome.UNDECIDED if report.verdict is None:
            return next_command("srgc why", folder)
        case Outcome.UNDECIDED if report.verdict == "found":
            return f"{HEAD}try shorter steps or wider margins, and `srgc synth` again"
        case Outcome.UNDECIDED:
            return next_command("srgc verify --trust cvc5", folder, "or another solver")
        case _:
            return f"{HEAD}do not rely on it; run `srgc synth` into another folder"


def _goes_on(report: Report) -> bool:
    """Whether the next step is to look at a result, or to ask why there is none."""
    return report.outcome is Outcome.VALID or (
        report.outcome is Outcome.UNDECIDED and report.verdict is None
    )
