"""The command ``check``."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click

from srgc.cli.arguments import FILES_OR_STDIN, DocumentedCommand
from srgc.faults import Checked, UsageFault


@click.command(
    cls=DocumentedCommand,
    examples=["srgc check specs/planar_arm.srg", "srgc check --json specs/patrol.srg"],
    statuses={0: "no errors; there may be warnings", 1: "errors, or a file does not exist"},
    reads_spec=False,
    read_on="docs/reference/language.md, and `srgc explain CODE` on a finding",
)
@FILES_OR_STDIN
@click.option("--json", "as_json", is_flag=True, help="Print the diagnostics as a JSON list.")
def check(files: tuple[Path, ...], as_json: bool) -> int:  # noqa: FBT001
    """Find the mistakes in specs.

    This checks syntax, names, units, grammars, semantics, workspaces and tasks.  Every diagnostic
    has a location, a code and, in most cases, a hint.  `-` reads standard input.
    """
    from srgc.cli.fault_report import show
    from srgc.session import check_file, check_standard_input
    from srgc.standard_input import DASH

    if files.count(DASH) > 1:
        raise UsageFault("`-` is given twice: standard input can be read once")
    results = _each_finding_once(
        [check_standard_input() if path == DASH else check_file(path) for path in files]
    )
    if as_json:
        from grammar_lang.diagnostics.render import records

        items = [entry for r in results for entry in records(r.diagnostics, r.sources)]
        click.echo(json.dumps(items, indent=1, ensure_ascii=False))
    else:
        from srgc.text_reports.findings_text import summary

        for result in results:
            show(result, stderr=False)
        click.echo(summary(results))
    return 0 if all(result.program is not None for result in results) else 1


def _each_finding_once(results: Sequence[Checked]) -> list[Checked]:
    """The results without what an earlier one found in a file that both include."""
    said, found = set[tuple[object, ...]](), list[Checked]()
    for result in results:
        names = [os.path.realpath(source.name) for source in result.sources]
        new = {(names[d.span.file], d.span[:2], d.code, d.message): d for d in result.diagnostics}
        kept = tuple(d for key, d in new.items() if key not in said)
        found.append(replace(result, diagnostics=kept))
        said |= new.keys()
    return found
