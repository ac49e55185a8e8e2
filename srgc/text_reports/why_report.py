"""An explanation as text with source excerpts, or as JSON."""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from compiler.time_limits.time_limit import OutOfTimeError
from grammar_lang import ir
from grammar_lang.diagnostics.render import marked_line
from grammar_lang.source import Source, Span
from solvers.explanation.conflict import Conflict, Conflicts
from solvers.explanation.explanation import Explanation, foremost, quick_conflict
from solvers.explanation.learnt_lines import Learnt, learnt
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.run import Suggestion
from solvers.explanation.suggestions import DRIVES
from solvers.explanation.task_line import TaskLine
from solvers.run_context import RunContext
from solvers.search.synthesis import OUT_OF_TIME, Synthesis
from srgc.text_reports.synthesis_report import after_synthesis

MOST_LEMMAS = 2
"""The number of lemmas to show at the end of a synthesis."""
MOST_CONFLICTS = 6
"""The number of conflicts to print for people; JSON has all of them."""

PROVED = "It is possible, as runs have found and proved,"
NO_SINGLE = "No change of a single line was found that makes it possible."
UNFINISHED = (
    "The search was not finished: the same `srgc synth` goes on with it, and may find a robot "
    "without a change."
)


def why_text(found: Explanation, *, colour: bool = False) -> str:
    """The explanation for people; ends with a line break."""
    head = f"verdict: {found.tried.verdict} ({found.tried.reason})"
    if OUT_OF_TIME in found.tried.reason:
        head += f"\n{UNFINISHED}"
    conflicts = [
        *lemma_blocks(found.posed, found.tried.lemmas, colour=colour),
        *conflict_blocks(found, colour=colour),
    ]
    suggested = _suggested(found)
    nearest = _nearest(found)
    unknown = found.tried.verdict == "unknown" and not found.all_refuted
    # If motions were searched without success, the conflicts of other robots matter less.
    told = [*nearest, suggested, *conflicts] if unknown else [*conflicts, suggested]
    blocks = [head, *told]
    if found.ended is not None:
        blocks.append(f"not all was tried: {found.ended}")
    return "\n\n".join(blocks) + "\n"


def lemma_blocks(posed: PosedTask, lemmas: Sequence[Learnt], *, colour: bool = False) -> list[str]:
    """The statement of each lemma, and the lines that it depends on."""
    blocks = []
    for lemma in lemmas:
        lines = [f"{lemma.says[0].upper()}{lemma.says[1:]}:"]
        lines += _marked(lemma.lines, posed.program.sources, (), colour=colour)
        blocks.append("\n".join(lines))
    return blocks


def conflict_blocks(found: Explanation, *, colour: bool = False) -> list[str]:
    """The conflicts; each line of the spec is shown once, where it is first needed."""
    sources = found.posed.program.sources
    shown: set[TaskLine] = set()
    blocks = []
    for conflict in found.conflicts.found[:MOST_CONFLICTS]:
        blocks.append(
            _conflict(conflict, sources, shown, colour=colour) + _amounts(found, conflict)
        )
        shown.update(conflict.lines)
    more = len(found.conflicts.found) - MOST_CONFLICTS
    if more > 0:
        blocks.append(f"and {more} more conflicts; `srgc why --json` prints them all")
    if found.conflicts.left:
        blocks.append(_unexplained(found))
    if found.bound is not None:
        lines = [f"Longer robots are ruled out by the bound, as {_robot(found.beyond)}:"]
        lines += marked_line(sources, found.bound.span, found.bound.says, colour=colour)
        blocks.append("\n".join(lines))
    return blocks


def _unexplained(found: Explanation) -> str:
    """The refuted robots whose lines are not known, with what the search said of some of them."""
    explained = {word for conflict in found.conflicts.found for word in conflict.words}
    known = [word for word in found.tried.reasons if word not in explained]
    head = f"Refuted robots for which no conflict is known yet: {found.conflicts.left}"
    shown = [f"  {_robot(word)}: {found.tried.reasons[word]}" for word in known[:MOST_CONFLICTS]]
    more = found.conflicts.left - len(shown)
    return "\n".join([head, *shown, *([f"  and {more} more"] if shown and more > 0 else [])])


def _conflict(
    conflict: Conflict, sources: Sequence[Source], shown: set[TaskLine], *, colour: bool
) -> str:
    """The robots that a conflict rules out, and its lines."""
    if not conflict.lines:
        return f"{_whom(conflict)}: no line of the task is needed for that"
    head = "this line rules" if len(conflict.lines) == 1 else "these lines together rule"
    lines = [f"{head[0].upper()}{head[1:]} out {_whom(conflict)}:"]
    return "\n".join(lines + _marked(conflict.lines, sources, shown, colour=colour))


def _marked(
    lines: Sequence[TaskLine],
    sources: Sequence[Source],
    shown: Collection[TaskLine],
    *,
    colour: bool,
) -> list[str]:
    """The lines in order, each place once, with all that is said about it, and its excerpt."""
    says, text = dict[Span, list[str]](), list[str]()
    for line in lines:
        if line not in shown:
            says.setdefault(line.span, []).append(line.says)
    for line in lines:
        if line in shown:
            text.append(f"  and, as above, {line.says}")
        elif line.span in says:
            text += marked_line(sources, line.span, "; ".join(says.pop(line.span)), colour=colour)
    return text


def _amounts(found: Explanation, conflict: Conflict) -> str:
    """How much drives lack for a robot of a conflict that they are part of.

    It is the first one: others are ruled out by its lines too, but the search may have found other
    reasons for them.
    """
    if not (conflict.words and any(line.kind in DRIVES for line in conflict.lines)):
        return ""
    robot = conflict.words[0]
    reason = found.tried.reasons.get(robot)
    return "" if reason is None else f"\n{_robot(robot)}: {reason}"


def _whom(conflict: Conflict) -> str:
    if not conflict.words:
        return "every robot, whatever its size"
    count = len(conflict.words)
    longest = max(conflict.words, key=len)
    if count == 1:
        return f"the robot {_robot(longest)}"
    return f"{count} robots, as {_robot(longest)}"


def _robot(word: Sequence[str]) -> str:
    return " ".join(word)


def _nearest(found: Explanation) -> list[str]:
    """The nearest robot, unless the reason of the verdict already names it."""
    nearest = found.tried.nearest
    if nearest is None or f"{_robot(nearest.word)}: {nearest.obstacle}" in found.tried.reason:
        return []
    return [f"The nearest was {_robot(nearest.word)}:\n  {nearest.obstacle}"]


def _suggested(found: Explanation) -> str:
    """What would help, and what was tried without success."""
    lines = []
    if found.suggestions:
        alone = any(one.change.lines == 1 for one in found.suggestions)
        lines.append(PROVED if alone else f"{NO_SINGLE} Two together do, as a run has proved,")
        lines += [f"  {_suggestion(one)}" for one in found.suggestions]
    elif found.runs:
        lines.append(NO_SINGLE)
    elif not found.most_runs:
        lines.append("No changes were tried.")
    elif found.ended:
        lines.append("No change was tried to the end.")
    else:
        lines.append(
            "No change of a single line was found that makes it possible: no poses were found with "
            "any of them."
        )
    if found.failed:
        lines.append(f"Without success: {'; '.join(change.says for change in found.failed)}.")
    return "\n".join(lines)


def finding_line(found: Conflict | Suggestion) -> str:
    """A conflict or a suggestion in one line, told as soon as it is known."""
    if isinstance(found, Suggestion):
        return f"possible {_suggestion(found)}"
    return f"ruled out, {_whom(found)}: {'; '.join(line.says for line in found.lines)}"


def _suggestion(one: Suggestion) -> str:
    robot = f"{one.change.says}: {_robot(one.word)}"
    if not one.efforts:
        return robot
    peaks = ", ".join(f"{peak:.4g} {unit}" for unit, peak in one.efforts.items())
    return f"{robot}, effort peak {peaks}"


def ending(result: Synthesis, posed: PosedTask, context: RunContext, folder: str) -> str:
    """The end of the report on an impossible task: a conflict, and what to do next.

    If a time limit in force is reached, the search for a conflict ends.
    """
    lines = list[str]()
    with suppress(OutOfTimeError):
        lines += _quickly(result, posed, context)
    lines.append(after_synthesis(result, posed.task, folder))
    return "\n".join(lines)


def _quickly(result: Synthesis, posed: PosedTask, context: RunContext) -> list[str]:
    """Why a task is impossible, if a few solver calls are enough to tell."""
    reasons = {r.derivation: r.reason for r in result.records if r.same_robot_as is None}
    claims = [lemma.claim() for lemma in result.lemmas]
    lines = lemma_blocks(posed, learnt(posed, claims[:MOST_LEMMAS]))
    if lines:
        more = len(claims) - MOST_LEMMAS
        return lines + ([f"and {more} more lemmas"] if more > 0 else [])
    first = foremost(posed, tuple(reasons)) if reasons else None
    if first is None or not _about_bodies(posed.task):
        found = quick_conflict(posed, first, context)
        if first is not None:
            found.tried = replace(found.tried, reasons={first.word: reasons[first.labels]})
        lines += conflict_blocks(found)
    if first is not None and not lines:
        lines.append(f"{_robot(first.word)}: {reasons[first.labels]}")
    return lines


def _about_bodies(task: ir.Task) -> bool:
    """Whether the task constrains whole bodies, for which finding a conflict takes seconds."""
    return task.bounds_body or any(clause.subject == "body" for clause in task.avoid)


# --- JSON ----------------------------------------------------------------------------------------


def why_json(found: Explanation) -> str:
    """The explanation as JSON; ends with a line break."""
    sources = found.posed.program.sources
    nearest = found.tried.nearest
    content = {
        "verdict": found.tried.verdict,
        "reason": found.tried.reason,
        "task": found.posed.task.name,
        "lemmas": lemma_entries(found.posed, found.tried.lemmas),
        "conflicts": conflict_entries(found.posed, found.conflicts),
        "unexplained": found.conflicts.left,
        "modules": None if found.bound is None else _line(found.bound, sources),
        "beyond": list(found.beyond),
        "nearest": None
        if nearest is None
        else {
            "word": list(nearest.word),
            "robustness": nearest.robustness,
            "obstacle": nearest.obstacle,
        },
        "suggestions": [_suggested_change(one, sources) for one in found.suggestions],
        "in_vain": [change.says for change in found.failed],
        "runs": found.runs,
        "ended": found.ended,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def lemma_entries(posed: PosedTask, lemmas: Sequence[Learnt]) -> list[dict[str, Any]]:
    """The statements of lemmas, and the lines that they depend on."""
    sources = posed.program.sources
    return [
        {
            "says": lemma.says,
            "condition": lemma.claim.condition,
            "argument": lemma.claim.argument,
            "lines": [_line(line, sources) for line in lemma.lines],
        }
        for lemma in lemmas
    ]


def conflict_entries(posed: PosedTask, conflicts: Conflicts) -> list[dict[str, Any]]:
    """The conflicts, each with its lines and the robots that it rules out."""
    sources = posed.program.sources
    return [
        {
            "lines": [_line(line, sources) for line in conflict.lines],
            "robots": [list(word) for word in conflict.words],
        }
        for conflict in conflicts.found
    ]


def _line(line: TaskLine, sources: Sequence[Source]) -> dict[str, Any]:
    source = sources[line.span.file]
    row, column = source.position(line.span.start)
    end_row, end_column = source.position(line.span.end)
    return {
        "kind": line.kind,
        "says": line.says,
        "file": source.path,
        "line": row,
        "column": column,
        "end_line": end_row,
        "end_column": end_column,
    }


def _suggested_change(one: Suggestion, sources: Sequence[Source]) -> dict[str, Any]:
    value = one.change.value
    return {
        "says": one.change.says,
        "line": None if one.change.line is None else _line(one.change.line, sources),
        "value": None if value is None else float(value),
        "word": list(one.word),
        "effort_peak": one.effort_peak,
        "robustness": one.robustness,
    }
