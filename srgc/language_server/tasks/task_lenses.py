"""Code lenses on tasks: check, synth, and the last verdict."""

from __future__ import annotations

from collections.abc import Mapping

from lsprotocol import types as lsp

from grammar_lang.syntax import tasks as t
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.tasks.verdicts import Verdicts, current_files, folder_of

CHECK, SYNTH, VERIFY = "srgc.check", "srgc.synth", "srgc.verify"

Running = Mapping[tuple[str, str], str]
"""What is being done about a task (path of the file, name), as text."""


def task_lenses(
    analysis: Analysis, number: int, uri: str, verdicts: Verdicts, running: Running
) -> list[lsp.CodeLens]:
    """The lenses of a document.

    Args:
        analysis: the program.
        number: the number of the document in it.
        uri: that of the document.
        verdicts: what result folders say.
        running: what is going on.
    """
    path = analysis.path(0)
    files: dict[str, bytes] = {}
    lenses: list[lsp.CodeLens] = []
    for item in analysis.items(number):
        if not isinstance(item, t.Task):
            continue
        name = item.name.text
        place = analysis.lines(number).range(item.name.span)

        def add(title: str, command: str, at: lsp.Range = place, task: str = name) -> None:
            lenses.append(lsp.CodeLens(at, lsp.Command(title, command, arguments=[uri, task])))

        add("check", CHECK)
        if path is None:
            continue
        doing = running.get((str(path), name))
        add("synth (running)" if doing == "synth" else "synth", SYNTH)
        files = files or current_files(analysis)
        verdict = verdicts.read(folder_of(path, name), files)
        if verdict is not None:
            add(f"{verdict.text}, verifying" if doing == "verify" else verdict.text, VERIFY)
    return lenses
