"""The outline of a document, the symbols of all documents, folds, and links."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from lsprotocol import types as lsp

from grammar_lang import syntax as s
from grammar_lang.files.file_tree import LIBRARY
from grammar_lang.formatting.expansion import named_files
from grammar_lang.names.declarations import Kind
from grammar_lang.source import Span, written
from grammar_lang.syntax import Ident
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.line_map import LineMap
from srgc.language_server.documents.places import location
from srgc.language_server.documents.uris import UriOf

_KINDS = lsp.SymbolKind
_MOST = 500
_MEMBERS: dict[type, lsp.SymbolKind] = {
    s.Param: _KINDS.Property,
    s.Const: _KINDS.Constant,
    s.Dof: _KINDS.Variable,
    s.State: _KINDS.Variable,
    s.Input: _KINDS.Variable,
    s.Frame: _KINDS.Field,
    s.Port: _KINDS.Interface,
}


class _Outline:
    def __init__(self, analysis: Analysis, number: int) -> None:
        self._analysis = analysis
        self._lines: LineMap = analysis.lines(number)

    def symbol(
        self,
        name: s.Ident,
        kind: lsp.SymbolKind,
        whole: Span,
        detail: str | None = None,
        children: Sequence[lsp.DocumentSymbol] = (),
    ) -> lsp.DocumentSymbol:
        """One symbol; the selected range of its name always lies within its whole range."""
        inner = Span(max(name.span.start, whole.start), min(name.span.end, whole.end))
        if inner.start > inner.end:
            inner = whole
        return lsp.DocumentSymbol(
            name=name.text or "?",
            kind=kind,
            range=self._lines.range(whole),
            selection_range=self._lines.range(inner),
            detail=detail,
            children=list(children),
        )

    def item(self, item: t.Item) -> Iterator[lsp.DocumentSymbol]:
        match item:
            case s.Module():
                children = list(self._members(item))
                yield self.symbol(item.name, _KINDS.Class, item.span, "module", children)
            case s.Edges(names=names):
                for name in names:
                    yield self.symbol(name, _KINDS.EnumMember, name.span, "edge")
            case s.Grammar():
                parts = list(self._productions(item))
                yield self.symbol(item.name, _KINDS.Module, item.span, "grammar", parts)
            case s.Semantics(blocks=blocks):
                made = [self.symbol(b.label, _KINDS.Method, b.span) for b in blocks]
                yield self.symbol(item.grammar, _KINDS.Namespace, item.span, "semantics", made)
            case t.Workspace():
                parts = list(self._regions(item))
                yield self.symbol(item.name, _KINDS.Package, item.span, "workspace", parts)
            case t.Task():
                yield self.symbol(item.name, _KINDS.Event, item.span, "task")
            case m.Mission():
                yield self.symbol(item.name, _KINDS.Event, item.span, "mission")
            case t.Include(path=path):
                yield self.symbol(path, _KINDS.File, item.span, "include")

    def _members(self, module: s.Module) -> Iterator[lsp.DocumentSymbol]:
        for item in module.items:
            if type(item) in _MEMBERS and not isinstance(item, s.Role | s.Named | s.Emission):
                detail = written(item.span, self._analysis.sources)
                yield self.symbol(item.name, _MEMBERS[type(item)], item.span, detail)

    def _productions(self, grammar: s.Grammar) -> Iterator[lsp.DocumentSymbol]:
        for item in grammar.items:
            if isinstance(item, s.Production):
                right = " ".join(o.symbol.text for o in item.right) or "empty"
                detail = f"{item.left.text} -> {right}"
                yield self.symbol(item.label, _KINDS.Function, item.span, detail)

    def _regions(self, workspace: t.Workspace) -> Iterator[lsp.DocumentSymbol]:
        for item in workspace.items:
            if isinstance(item, t.Region) and item.name is not None:
                yield self.symbol(item.name, _KINDS.Field, item.span, item.kind)
            elif isinstance(item, t.ObstaclesFrom):
                yield self.symbol(item.path, _KINDS.File, item.span, "obstacles")


def outline(analysis: Analysis, number: int) -> list[lsp.DocumentSymbol]:
    """The items of a document, with their declarations."""
    maker = _Outline(analysis, number)
    return [symbol for item in analysis.items(number) for symbol in maker.item(item)]


_INDEXED: dict[Kind, lsp.SymbolKind] = {
    "module": _KINDS.Class,
    "edge": _KINDS.Class,
    "production": _KINDS.Function,
    "nonterminal": _KINDS.Interface,
    "grammar": _KINDS.Module,
    "workspace": _KINDS.Package,
    "region": _KINDS.Field,
    "obstacle": _KINDS.Field,
    "target": _KINDS.Field,
    "task": _KINDS.Event,
    "mission": _KINDS.Event,
}


def _matches(name: str, query: str) -> bool:
    """Whether the letters of a query occur in a name in that order, ignoring case."""
    letters = iter(name.lower())
    return all(letter in letters for letter in query.lower())


def workspace_symbols(
    analyses: Sequence[Analysis], query: str, uri_of: UriOf
) -> list[lsp.WorkspaceSymbol]:
    """The declarations in all programs whose names match a query."""
    found: dict[tuple[str, int, str], lsp.WorkspaceSymbol] = {}
    for analysis in analyses:
        for mention in analysis.names.mentions:
            entity, span = mention.entity, mention.span
            kind = _INDEXED.get(entity.kind)
            if kind is None or not mention.declares or not _matches(entity.name, query):
                continue
            key = (analysis.place(span.file), span.start, entity.kind)
            container = ".".join(entity.scope) or None
            found[key] = lsp.WorkspaceSymbol(
                location=location(analysis, span, uri_of),
                name=entity.name,
                kind=kind,
                container_name=container,
            )
    return [found[key] for key in sorted(found)][:_MOST]


# --- Folding: items, blocks and comments of several lines -----------------------------------------


_PART = re.compile(
    r"""//[^\n]*|/\*(?:[^*]|\*(?!/))*(?:\*/|\Z)|"[^"\n]*"|'[^'\n]*'|[{}]""",
)


def _comment(lines: LineMap, start: int, end: int) -> lsp.FoldingRange | None:
    first, last = lines.position(start).line, lines.position(end).line
    if last <= first:
        return None
    return lsp.FoldingRange(first, last, kind=lsp.FoldingRangeKind.Comment)


def folding(text: str, lines: LineMap) -> list[lsp.FoldingRange]:
    """The ranges that can be folded, even if the text has errors."""
    found: list[lsp.FoldingRange | None] = []
    open_braces: list[int] = []
    run: tuple[int, int] | None = None
    for part in _PART.finditer(text):
        if part[0].startswith("//"):
            alone = not text[text.rfind("\n", 0, part.start()) + 1 : part.start()].strip()
            joined = run is not None and not text[run[1] : part.start()].strip() and alone
            if run is not None and joined:
                run = (run[0], part.end())
                continue
            found.append(None if run is None else _comment(lines, *run))
            run = part.span() if alone else None
        elif part[0].startswith("/*"):
            found.append(_comment(lines, *part.span()))
        elif part[0] == "{":
            open_braces.append(part.start())
        elif part[0] == "}" and open_braces:
            found.append(_braces(lines, open_braces.pop(), part.start()))
    found.append(None if run is None else _comment(lines, *run))
    ranges = [each for each in found if each is not None]
    return sorted(ranges, key=lambda each: (each.start_line, each.end_line))


def _braces(lines: LineMap, start: int, end: int) -> lsp.FoldingRange | None:
    """The lines between braces; the line of the closing brace stays visible."""
    first, last = lines.position(start).line, lines.position(end).line - 1
    return lsp.FoldingRange(first, last) if last > first else None


# --- Links from the paths of includes, maps and meshes to the files -------------------------------


def include_links(analysis: Analysis, number: int, uri_of: UriOf) -> list[lsp.DocumentLink]:
    """The links of a document; paths that are not files get none."""
    base = analysis.path(number)
    paths: list[Ident] = []
    library: set[Ident] = set()
    for item in analysis.items(number):
        if isinstance(item, t.Include):
            paths.append(item.path)
            library |= {item.path} if item.std else set()
        else:
            paths += named_files(item)
    if base is None:
        return []
    links: list[lsp.DocumentLink] = []
    for path in paths:
        folder = Path(LIBRARY) if path in library else base.parent
        target = Path(posixpath.normpath(folder / path.text))
        if not path.text or not os.path.isfile(target):  # noqa: PTH113 - any name may occur
            continue
        inside = Span(path.span.start + 1, path.span.end - 1, path.span.file)
        place = analysis.lines(number).range(inside)
        links.append(lsp.DocumentLink(place, uri_of(target)))
    return links
