"""Renaming: edits all places of a name, after checking that nothing else changes its meaning.

The effect of the new name is not guessed: the program is read again with it, and the new name is
refused unless all names stand for the same things as before and there are no new errors.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from lsprotocol import types as lsp

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.files.file_tree import LIBRARY
from grammar_lang.names.declarations import MEMBERS, REGIONS, TERMINALS, Entity
from grammar_lang.names.table import Mention
from grammar_lang.parsing.tables import RESERVED
from grammar_lang.source import Span
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.places import described
from srgc.language_server.documents.uris import UriOf

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class RenameRefused(Exception):
    """The name cannot be changed like that; the message says why."""


@dataclass(frozen=True, slots=True)
class Renamable:
    """The name at a position: its span and its present text."""

    span: Span
    name: str


def renamable(analysis: Analysis, number: int, offset: int) -> Renamable | None:
    """The name at a position, if there is one that can be changed.

    Raises:
        RenameRefused: it cannot be changed; the message says why.
    """
    mention = analysis.mention(number, offset)
    if mention is None:
        return None
    if mention.entity.kind == "map":
        raise RenameRefused("this is the name of a file; rename the file and the path of it")
    return Renamable(mention.span, mention.entity.name)


def _checked_name(analysis: Analysis, entity: Entity, new: str) -> None:
    """Refuse a new name that is not a valid name, or that is already taken.

    Raises:
        RenameRefused: the message says why.
    """
    if new in RESERVED:
        raise RenameRefused(f"`{new}` is a reserved word")
    edge = entity.kind == "edge"
    if not edge and not _NAME.fullmatch(new):
        raise RenameRefused(f"`{new}` is not a name: letters, digits and `_`, no digit first")
    if edge and (not new.isprintable() or not new or " " in new or {"'", '"'} <= set(new)):
        raise RenameRefused("an edge has visible characters, and not both kinds of quotes")
    for other in _rivals(analysis, entity):
        if other.name == new:
            raise RenameRefused(f"`{new}` is already the name of {described(other)}")


def _rivals(analysis: Analysis, entity: Entity) -> list[Entity]:
    """The entities whose names must differ from that of an entity."""
    names = analysis.names
    for kinds in (MEMBERS, REGIONS):
        if entity.kind in kinds:
            return names.entities(*kinds, scope=entity.scope)
    if entity.kind not in {*TERMINALS, "nonterminal", "occurrence"}:
        return names.entities(entity.kind, scope=entity.scope)
    scoped = names.entities("nonterminal") + names.entities("occurrence")
    near = [each for each in scoped if entity.kind in TERMINALS or _near(each, entity)]
    return names.entities(*TERMINALS) + near


def _near(one: Entity, other: Entity) -> bool:
    """Whether two symbols of grammars may occur in one production."""
    if one.kind == other.kind == "occurrence":
        return one.scope == other.scope
    return one.scope[:1] == other.scope[:1]


def _replacement(analysis: Analysis, mention: Mention, new: str) -> str:
    """The text that replaces a name, with quotes if it needs them."""
    if mention.entity.kind not in TERMINALS:
        return new
    quoted = mention.whole.start < mention.span.start
    if not quoted:
        quote = '"' if "'" in new else "'"
        return new if _NAME.fullmatch(new) else f"{quote}{new}{quote}"
    if analysis.text(mention.whole)[0] in new:
        raise RenameRefused(f"write {described(mention.entity)} in other quotes first")
    return new


def _renamed_together(analysis: Analysis, entity: Entity) -> list[Entity]:
    """An entity and all entities that are named by the same words, such as ``sum(NAME)``."""
    found, todo = {entity: None}, [entity]
    while todo:
        for mention in analysis.names.mentions_of(todo.pop()):
            others = (each.entity for each in analysis.names.together(mention))
            fresh = [other for other in others if other not in found]
            found |= dict.fromkeys(fresh)
            todo += fresh
    return list(found)


def _edits(
    analysis: Analysis, entities: Iterable[Entity], new: str
) -> dict[int, list[tuple[Span, str]]]:
    """The edits of each file, in order."""
    found: dict[int, dict[Span, str]] = {}
    for mention in (m for entity in entities for m in analysis.names.mentions_of(entity)):
        text = _replacement(analysis, mention, new)
        found.setdefault(mention.span.file, {})[mention.span] = text
    return {file: sorted(edits.items()) for file, edits in found.items()}


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
    """What every name stands for, in order, with the new name replaced by the old one."""

    def text(name: str) -> str:
        return old if name == new else name

    found = ((mention.whole.file, mention.entity) for mention in analysis.names.mentions)
    return [
        (file, entity.kind, tuple(map(text, entity.scope)), text(entity.name))
        for file, entity in found
    ]


def _refuse_other_meaning(before: Analysis, after: Analysis, old: str, new: str) -> None:
    """Refuse a new name that changes more than the name.

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
    if _meanings(before, old, new) != _meanings(after, old, new):
        raise RenameRefused(f"with the name `{new}` other names would mean something else")


def _refuse_library(analysis: Analysis, files: Iterable[int], name: str) -> None:
    """Refuse to change the library of the package.

    Raises:
        RenameRefused: a file of the library would change.
    """
    for file in files:
        if analysis.place(file).startswith(LIBRARY):
            raise RenameRefused(f"`{name}` is a name of the library, which is not changed here")


def rename(
    analyses: Sequence[Analysis],
    place: str,
    offset: int,
    new: str,
    open_files: Mapping[str, bytes],
    uri_of: UriOf,
) -> lsp.WorkspaceEdit | None:
    """The edits that rename the entity at a position; None if there is no name.

    Args:
        analyses: the programs that the file belongs to.
        place: the resolved path of the file, or the URI of a document.
        offset: the position of the name.
        new: the new name.
        open_files: the contents of open files, by their resolved paths.
        uri_of: gives the client's URI of a file.

    Raises:
        RenameRefused: the name cannot be changed like that.
    """
    changes: dict[str, dict[tuple[int, int], lsp.TextEdit]] = {}
    for analysis in analyses:
        number = analysis.number(place)
        found = None if number is None else renamable(analysis, number, offset)
        mention = None if number is None else analysis.mention(number, offset)
        if found is None or mention is None or found.name == new:
            continue
        together = _renamed_together(analysis, mention.entity)
        for entity in together:
            _checked_name(analysis, entity, new)
        edits = _edits(analysis, together, new)
        _refuse_library(analysis, edits, found.name)
        after = _again(analysis, edits, open_files)
        _refuse_other_meaning(analysis, after, found.name, new)
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
