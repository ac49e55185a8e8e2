"""What was proved, with its margins, and how to check it."""

from __future__ import annotations

import hashlib
import math
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.metadata import version
from typing import Any

from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Outcome
from srgc.render.html_text import number, text, with_unit
from srgc.report.evidence import Evidence
from srgc.report.spec_source import spec_source
from srgc.text_reports.verification_report import by_map, in_order
from srgc.version import VERSION

# --- What was proved, condition by condition, the smallest margin first ---------------------------


DECADES = 6
"""The range of the bars in powers of ten; smaller margins have the shortest bar."""
WORDS = {Status.HOLDS: "holds", Status.FAILS: "violated", Status.UNDECIDED: "not decided"}


def margins_section(evidence: Evidence) -> str:
    """The table of conditions; empty if the verifier has none."""
    report = evidence.report
    if report is None or not report.conditions:
        return ""
    conditions = list(by_map(in_order(report.conditions)))
    rows = "".join(_row(condition, conditions) for condition in conditions)
    return (
        '<section id="margins"><h2>Margins</h2>'
        "<p>By how much each condition holds, at the instant at which it is closest to being "
        "violated. Bars are logarithmic, each unit to its own scale. "
        '<span class="screen-only">Choose a time to see the robot there.</span></p>'
        '<div class="scroll"><table class="margins folded"><thead><tr><th>condition</th>'
        '<th class="figure">margin</th><th class="bar">size</th>'
        "<th>closest at</th><th>where</th><th>known</th></tr></thead>"
        f"<tbody>{rows}</tbody></table></div></section>"
    )


def _row(condition: CheckedCondition, among: Sequence[CheckedCondition]) -> str:
    name = text(condition.name)
    if condition.status is not Status.HOLDS:
        name = f'<strong class="bad">{WORDS[condition.status]}:</strong> {name}'
        if condition.why:
            name += f'<br><span class="soft">{text(condition.why)}</span>'
    margin = (
        with_unit(condition.least(4), condition.unit_text)
        if math.isfinite(condition.margin)
        else ""
    )
    # To a nanometre: 0, not what rounding left of it.
    place = ", ".join(number(round(x, 9) + 0.0) for x in condition.place)
    level = condition.level if condition.status is Status.HOLDS else ""
    return (
        f'<tr class="{_class(condition)}"><td>{name}</td><td class="figure">{text(margin)}</td>'
        f'<td class="bar">{_bar(condition, among)}</td>'
        f'<td data-head="closest at">{_when(condition)}</td>'
        f'<td data-head="where">{f"({place})" if place else ""}</td>'
        f'<td data-head="known">{level}</td></tr>'
    )


def _class(condition: CheckedCondition) -> str:
    return "holds" if condition.status is Status.HOLDS else "broken"


def _when(condition: CheckedCondition) -> str:
    if condition.time is None:
        return ""
    return (
        f'<button type="button" class="seek" data-seek="{condition.time!r}">'
        f"{number(condition.time, 5)} s</button>"
    )


def _bar(condition: CheckedCondition, among: Sequence[CheckedCondition]) -> str:
    """The bar of a margin, relative to the largest one of its unit, on a logarithmic scale."""
    if not math.isfinite(condition.margin) or condition.margin <= 0:
        return ""
    largest = max(
        each.margin for each in among if each.unit == condition.unit and math.isfinite(each.margin)
    )
    part = 1 + math.log10(condition.margin / largest) / DECADES
    return f'<span style="width:{100 * max(part, 0.02):.0f}%"></span>'


# --- How to verify the result without this page, and the exact files that it is about -------------


def check_section(evidence: Evidence) -> str:
    """Commands, digests, versions and the specification itself."""
    return own_check(
        _rests(evidence), list(_commands(evidence)), _verifier(evidence),
        identity(
            evidence.design, evidence.files, evidence.digests, checked=evidence.report is not None
        ),
        evidence.program,
    )  # fmt: skip


def own_check(
    rests: str,
    commands: Sequence[tuple[str, str]],
    verifier: str,
    identity: Iterable[tuple[str, str]],
    program: ir.Program,
) -> str:
    """The section of a page about how to check it.

    Args:
        rests: what the page's statements rest on, as HTML.
        commands: commands, with what each of them does.
        verifier: the text after the commands, as HTML.
        identity: names and values that identify the result.
        program: the specification.
    """
    width = max(len(command) for command, _ in commands) + 2
    lines = "\n".join(f"{command:<{width}}# {what}" for command, what in commands)
    rows = "".join(
        f"<tr><td>{text(name)}</td><td><code>{text(value)}</code></td></tr>"
        for name, value in identity
    )
    return (
        '<section id="check"><h2>Check it yourself</h2>'
        f"<p>{rests} In the folder of this page:</p>"
        f'<pre class="commands">{text(lines)}</pre>{verifier}'
        f'<div class="scroll"><table class="identity"><tbody>{rows}</tbody></table></div>'
        f"<h3>The specification</h3>{spec_source(program)}</section>"
    )


def _rests(evidence: Evidence) -> str:
    """What proves something."""
    if evidence.verdict == "unknown":
        return "Neither this page nor its folder proves anything of the task."
    if evidence.report is not None and evidence.report.outcome is Outcome.VALID:
        return "This page proves nothing; the certificate in its folder does."
    return "This page proves nothing."


def _verifier(evidence: Evidence) -> str:
    if evidence.verdict == "unknown":
        return ""
    return (
        "<p>The verifier reads the specification again, recomputes everything else, and shares no "
        "code with the search but the compiler and the validated integration.</p>"
    )


def _commands(evidence: Evidence) -> Iterator[tuple[str, str]]:
    if evidence.verdict == "unknown":
        yield "srgc why .", "what stands in the way"
    else:
        yield "srgc verify .", "check the certificate"
        yield "srgc verify . --json", "the same for programs"
        expected = f"--task {evidence.task.name} --expect {evidence.verdict}"
        yield f"srgc verify . --spec PATH {expected}", "and that it is about your file and task"
        if evidence.verdict == "impossible":
            yield "srgc verify . --trust z3", "run z3 again where no covering is"
            yield "srgc why .", "which lines conflict, what would help"
        yield "python -m solvers.verifier .", "the verifier alone"
    path = shlex.quote(f"spec/{evidence.design['spec']}")
    task = f" --task {evidence.task.name}" if len(evidence.program.tasks) > 1 else ""
    yield f"srgc synth {path} -o again{task}{search_options(evidence.design)}", "search again"


def search_options(design: Mapping[str, Any]) -> str:
    """The options that repeat the search of a ``design.json``, as text for the command line."""
    parts = [f" --seed {design['seed']}" if design["seed"] else ""]
    parts.append(f" --cells {design['least_cells']}" if design.get("least_cells") else "")
    parts.append(" --all" if design.get("all_designs") else "")
    named = ("paths", "evaluations", "solver", "search")
    parts += [f" --{name} {design[name]}" for name in named if design.get(name)]
    return "".join(parts)


def identity(
    design: Mapping[str, Any],
    files: Mapping[str, bytes],
    digests: Mapping[str, str],
    *,
    checked: bool,
) -> Iterator[tuple[str, str]]:
    """The names and values of the exact files and versions that a page is about."""
    yield "SHA-256 of the specification and what it includes", design["spec_sha256"]
    for name, content in files.items():
        yield f"SHA-256 of spec/{name}", hashlib.sha256(content).hexdigest()
    for name, digest in digests.items():
        yield f"SHA-256 of {name}", digest
    yield "made by", f"srgc {design['version']}"
    flint = f", python-flint {version('python-flint')}" if checked else ""
    yield "checked by" if checked else "not checked", f"srgc {VERSION}{flint}"
