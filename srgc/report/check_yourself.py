"""How to verify the result without this page, and what it is about, to the byte."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Iterator
from importlib.metadata import version

from solvers.verifier.report import Outcome
from srgc.render.html_text import text
from srgc.report.evidence import Evidence
from srgc.report.spec_source import spec_source
from srgc.version import VERSION


def check_section(evidence: Evidence) -> str:
    """Commands, digests, versions and the specification itself."""
    told = list(_commands(evidence))
    width = max(len(command) for command, _ in told) + 2
    commands = "\n".join(f"{command:<{width}}# {what}" for command, what in told)
    rows = "".join(
        f"<tr><td>{text(name)}</td><td><code>{text(value)}</code></td></tr>"
        for name, value in _identity(evidence)
    )
    return (
        '<section id="check"><h2>Check it yourself</h2>'
        f"<p>{_rests(evidence)} In the folder of this page:</p>"
        f'<pre class="commands">{text(commands)}</pre>{_verifier(evidence)}'
        f'<div class="scroll"><table class="identity"><tbody>{rows}</tbody></table></div>'
        f"<h3>The specification</h3>{spec_source(evidence)}</section>"
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
    yield f"srgc synth {path} -o again{_options(evidence)}", "search again"


def _options(evidence: Evidence) -> str:
    """The options that the search had."""
    design = evidence.design
    parts = [f" --task {design['task']}" if len(evidence.program.tasks) > 1 else ""]
    parts.append(f" --seed {design['seed']}" if design["seed"] else "")
    parts.append(f" --cells {design['least_cells']}" if design.get("least_cells") else "")
    parts.append(" --all" if design.get("all_designs") else "")
    named = ("solver", "search")
    parts += [f" --{name} {design[name]}" for name in named if design.get(name)]
    return "".join(parts)


def _identity(evidence: Evidence) -> Iterator[tuple[str, str]]:
    yield "SHA-256 of the specification and what it includes", evidence.design["spec_sha256"]
    for name, content in evidence.files.items():
        yield f"SHA-256 of spec/{name}", hashlib.sha256(content).hexdigest()
    for name, digest in evidence.digests.items():
        yield f"SHA-256 of {name}", digest
    yield "made by", f"srgc {evidence.design['version']}"
    checked = "not checked" if evidence.report is None else "checked by"
    flint = f", python-flint {version('python-flint')}" if evidence.report is not None else ""
    yield checked, f"srgc {VERSION}{flint}"
