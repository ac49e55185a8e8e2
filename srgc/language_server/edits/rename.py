"""Renaming: every place of a name, and a proof that nothing else has changed its meaning.

What the new name would do is not guessed: the program is read again with it, and refused unless
every name stands for the same thing as before and no finding is new.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lsprotocol import types as lsp

from grammar_lang.findings.diagnostics import Severity
from grammar_lang.parsing.tables import RESERVED
from grammar_lang.source import Span
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.places import described
from srgc.language_server.documents.published import UriOf
from srgc.language_server.names.names import Key, Mark

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_SYMBOLS = ("terminal", "nonterminal", "occurrence")


class RenameRefused(Exception):
    """The name cannot be changed like that; the message says why."""


@dataclass(frozen=True, slots=True)
class Renamable:
    """The name at a place: where it stands and what it is now."""

    span: Span
    name: str


def renamable(analysis: Analysis, number: int, offset: int) -> Renamable | None:
    """The name at a place, if there is one that can be changed.

    Raises:
        RenameRefused: it cannot; why.
    """
    mark = analysis.mark(number, offset)
    if mark is None:
        return None
    if mark.key.kind == "map":
        raise RenameRefused("this is the name of a file; rename the file and the path of it")
    return Renamable(mark.span, mark.key.name)


def _checked_name(analysis: Analysis, key: Key, new: str) -> None:
    """Refuse what is no name at all, or is taken.

    Raises:
        RenameRefused: as it says.
    """
    if new in RESERVED:
        raise RenameRefused(f"`{new}` is a reserved word")
    edge = key.kind == "terminal" and key.name not in analysis.declared.modules
    if not edge and not _NAME.fullmatch(new):
        raise RenameRefused(f"`{new}` is no name: letters, digits and `_`, no digit first")
    if edge and (not new.isprintable() or not new or " " in new or {"'", '"'} <= set(new)):
        raise RenameRefused("an edge has visible characters, and not both kinds of quotes")
    for other in _rivals(analysis, key):
        if other.name == new and analysis.names.definitions(other):
            raise RenameRefused(f"`{new}` is already the name of {described(analysis, other)}")


def _rivals(analysis: Analysis, key: Key) -> list[Key]:
    """The names that must differ from that of a thing."""
    index = analysis.names
    if key.kind not in _SYMBOLS:
        return index.keys(key.kind, key.scope)
    keys = index.keys("terminal")
    for kind in ("nonterminal", "occurrence"):
        scoped = index.keys(kind)
        keys += [each for each in scoped if key.kind == "terminal" or _near(each, key)]
    return keys


def _near(one: Key, other: Key) -> bool:
    """Whether two symbols of grammars may stand in one production."""
    if one.kind == other.kind == "occurrence":
        return one.scope == other.scope
    return one.scope[:1] == other.scope[:1]


def _replacement(analysis: Analysis, mark: Mark, new: str) -> str:
    """What is written in the place of a name: with quotes where it needs them."""
    if mark.key.kind != "terminal":
        return new
    quoted = mark.whole.start < mark.span.start
    if not quoted:
        quote = '"' if "'" in new else "'"
        return new if _NAME.fullmatch(new) else f"{quote}{new}{quote}"
    if analysis.text(mark.whole)[0] in new:
        raise RenameRefused(f"write {described(analysis, mark.key)} in other quotes first")
    return new


def _edits(analysis: Analysis, key: Key, new: str) -> dict[int, list[tuple[Span, str]]]:
    """The edits of each file, in order."""
    found: dict[int, list[tuple[Span, str]]] = {}
    for mark in analysis.names.of(key):
        text = _replacement(analysis, mark, new)
        found.setdefault(mark.span.file, []).append((mark.span, text))
    return found


def _edited(text: str, edits: Sequence[tuple[Span, str]]) -> str:
    parts: list[str] = []
    here = 0
    for span, new in edits:
        parts += [text[here : span.start], new]
        here = span.end
    return "".join([*parts, text[here:]])


def _again(
    analysis: Analysis,
    edits: Mapping[int, Sequence[tuple[Span, str]]],
    open_files: Mapping[str, bytes],
) -> Analysis:
    """The program with the edits."""
    held = dict(open_files)
    for number, each in edits.items():
        text = _edited(analysis.sources[number].text, each)
        held[analysis.place(number)] = text.encode("utf-8", "surrogatepass")
    main = analysis.sources[0].text
    return analyse(analysis.name, _edited(main, edits.get(0, ())), held)


def _meanings(analysis: Analysis, old: str, new: str) -> list[tuple[object, ...]]:
    """What every name stands for, in order, with the old name for the new one."""

    def text(name: str) -> str:
        return old if name == new else name

    return [
        (mark.whole.file, mark.key.kind, tuple(map(text, mark.key.scope)), text(mark.key.name))
        for mark in analysis.names.marks
    ]


def _refuse_other_meaning(before: Analysis, after: Analysis, key: Key, new: str) -> None:
    """Refuse a new name that changes anything but the name.

    Raises:
        RenameRefused: it does.
    """

    def faults(analysis: Analysis) -> int:
        return sum(d.severity is Severity.ERROR for d in analysis.loaded.diagnostics)

    if faults(after) > faults(before):
        known = {(d.code, d.message) for d in before.loaded.diagnostics}
        wrong = (d for d in after.loaded.diagnostics if d.severity is Severity.ERROR)
        first = next((d.message for d in wrong if (d.code, d.message) not in known), "")
        raise RenameRefused(f"with the name `{new}` there is an error: {first}")
    if _meanings(before, key.name, new) != _meanings(after, key.name, new):
        raise RenameRefused(f"with the name `{new}` other names would mean something else")


def rename(
    analyses: Sequence[Analysis],
    place: str,
    offset: int,
    new: str,
    open_files: Mapping[str, bytes],
    uri_of: UriOf,
) -> lsp.WorkspaceEdit | None:
    """The edits that give the thing at a place another name; None if no name stands there.

    Args:
        analyses: the programs that the file belongs to.
        place: the path of the file without links, or the URI of a document.
        offset: where the name stands.
        new: the name it is to have.
        open_files: what is held of files, by their path without links.
        uri_of: gives the client's URI of a file.

    Raises:
        RenameRefused: the name cannot be changed like that.
    """
    changes: dict[str, dict[tuple[int, int], lsp.TextEdit]] = {}
    for analysis in analyses:
        number = analysis.number(place)
        found = None if number is None else renamable(analysis, number, offset)
        mark = None if number is None else analysis.mark(number, offset)
        if found is None or mark is None or found.name == new:
            continue
        _checked_name(analysis, mark.key, new)
        edits = _edits(analysis, mark.key, new)
        after = _again(analysis, edits, open_files)
        _refuse_other_meaning(analysis, after, mark.key, new)
        for file, each in edits.items():
            path = analysis.path(file)
            uri = analysis.name if path is None else uri_of(path)
            lines = analysis.lines(file)
            for span, text in each:
                edit = lsp.TextEdit(lines.range(span), text)
                changes.setdefault(uri, {})[span.start, span.end] = edit
    if not changes:
        return None
    return lsp.WorkspaceEdit(
        changes={uri: [edits[at] for at in sorted(edits)] for uri, edits in changes.items()}
    )
