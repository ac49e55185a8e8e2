"""Why no robot with less was designed, as text with source excerpts and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

from compiler.objectives.objective_text import (
    amount_text,
    objective_name,
    objective_unit,
    value_text,
)
from grammar_lang.diagnostics.wording import counted
from solvers.explanation.conflict import Conflicts
from solvers.explanation.explanation import Explanation, Tried
from srgc.comparisons.next_cheaper import CheaperRobot, NextCheaper
from srgc.results.stated_objectives import Objective
from srgc.text_reports.why_report import (
    conflict_blocks,
    conflict_entries,
    lemma_blocks,
    lemma_entries,
)

MOST_UNDECIDED = 10
"""The number of undecided robots to print for people; JSON has all of them."""


def cheaper_text(
    cheaper: NextCheaper, conflicts: Conflicts, ended: str | None, *, colour: bool = False
) -> str:
    """What the next cheaper robots lack; ends with a line break."""
    objective = cheaper.amount.objective
    blocks = [f"verdict: found ({amount_text(objective, cheaper.value)})", _head(cheaper)]
    blocks += lemma_blocks(cheaper.posed, cheaper.lemmas, colour=colour)
    explained = Explanation(cheaper.posed, Tried("impossible", "", ()), conflicts)
    blocks += conflict_blocks(explained, colour=colour)
    blocks += _listed(cheaper, cheaper.found, "Found, but with more of what comes behind")
    blocks += _listed(cheaper, cheaper.other, "Found; other parameters may give less")
    blocks += _listed(cheaper, cheaper.undecided, "Not decided, and perhaps with less")
    if ended is not None:
        blocks.append(f"not all was tried: {ended}")
    return "\n\n".join(blocks) + "\n"


def _head(cheaper: NextCheaper) -> str:
    name = objective_name(cheaper.amount.objective)
    if cheaper.refuted:
        value = _least_text(cheaper, cheaper.refuted[0])
        robots = "\n  ".join(" ".join(each.derivation.word) for each in cheaper.refuted)
        return f"Nearest below the design, and refuted: {value}\n  {robots}"
    if cheaper.undecided or cheaper.found:
        return f"Nothing below the design is refuted: robots with less {name} may exist."
    least = min((each.value for each in cheaper.other), default=cheaper.value)
    if least < cheaper.value:
        return f"No robot has less {name} than {value_text(cheaper.amount.objective, least)}."
    return f"There is no robot with less {name} in the family."


def _least_text(cheaper: NextCheaper, robot: CheaperRobot) -> str:
    """What a robot would have; "or more" if that depends on its parameters."""
    value = amount_text(cheaper.amount.objective, robot.value)
    return f"{value} or more" if robot.varies else value


def _listed(cheaper: NextCheaper, robots: Sequence[CheaperRobot], title: str) -> Iterator[str]:
    if not robots:
        return
    lines = [f"{title}:"]
    for each in robots[:MOST_UNDECIDED]:
        value = _least_text(cheaper, each)
        reason = "" if each.verdict == "found" else f"\n    {each.reason}"
        lines.append(f"  {' '.join(each.derivation.word)}, {value}{reason}")
    more = len(robots) - MOST_UNDECIDED
    if more > 0:
        lines.append(f"  and {counted(more, 'other')}; `srgc why --json` prints them all")
    yield "\n".join(lines)


def cheaper_json(cheaper: NextCheaper, conflicts: Conflicts, ended: str | None) -> str:
    """What the next cheaper robots lack, as JSON; ends with a line break."""
    posed, objective = cheaper.posed, cheaper.amount.objective
    content = {
        "verdict": "found",
        "task": posed.task.name,
        "objective": cheaper.amount.text,
        "unit": objective_unit(objective),
        "value": float(cheaper.value),
        "refuted": [_robot(each) for each in cheaper.refuted],
        "lemmas": lemma_entries(posed, cheaper.lemmas),
        "conflicts": conflict_entries(posed, conflicts),
        "unexplained": conflicts.left,
        "undecided": [_robot(each) | {"reason": each.reason} for each in cheaper.undecided],
        "found": [_robot(each) for each in (*cheaper.found, *cheaper.other)],
        "ended": ended,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def stated_text(stated: Sequence[Objective]) -> str:
    """What is claimed about the objectives, if no robot is known to have less before it moves."""
    if not stated:
        return "verdict: found\nThere is nothing to explain: `srgc verify` checks the design.\n"
    lines = [
        f"  {each.name} {each.amount(each.value)}: {each.claim(first=number == 0)}"
        for number, each in enumerate(stated)
    ]
    end = "Beyond that there is nothing to explain: `srgc verify` checks it."
    return "\n".join(["verdict: found", *lines, end]) + "\n"


def stated_json(stated: Sequence[Objective]) -> str:
    """The claims about the objectives as JSON; ends with a line break."""
    objectives = [
        {"objective": e.objective, "value": e.value, "least": e.least, "unit": e.unit}
        for e in stated
    ]
    return json.dumps({"verdict": "found", "objectives": objectives}, indent=1) + "\n"


def _robot(one: CheaperRobot) -> dict[str, Any]:
    return {"word": list(one.derivation.word), "value": float(one.value)}
