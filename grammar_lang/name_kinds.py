"""What the names of a file stand for: one of the wrong kind is not called unknown."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import cached_property

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from grammar_lang.files.map_names import map_name
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.findings.spelling import did_you_mean
from grammar_lang.resolve import Declarations
from grammar_lang.source import Span


class NameKinds:
    """The names of a file with what they are; gathered when the first wrong name is met."""

    def __init__(self, declared: Declarations) -> None:
        self._declared = declared

    @cached_property
    def _kinds(self) -> Mapping[str, tuple[str, Span]]:
        found: dict[str, tuple[str, Span]] = {}
        for name, kind, span in self._all():
            found.setdefault(name, (kind, span))
        return found

    def _all(self) -> Iterator[tuple[str, str, Span]]:
        declared = self._declared
        for name, span in declared.terminals.items():
            yield name, "a module" if name in declared.modules else "an edge", span
        for grammar in declared.grammars.values():
            yield grammar.name.text, "a grammar", grammar.name.span
            for item in grammar.items:
                if isinstance(item, s.Production):
                    yield item.left.text, "a nonterminal", item.left.span
        for workspace in declared.workspaces.values():
            yield workspace.name.text, "a workspace", workspace.name.span
        for task in declared.tasks.values():
            yield task.name.text, "a task", task.name.span
        for workspace in declared.workspaces.values():
            yield from self._places(workspace)

    def _places(self, workspace: t.Workspace) -> Iterator[tuple[str, str, Span]]:
        """The regions and maps of a workspace."""
        of = f"of workspace `{workspace.name.text}`"
        for part in workspace.items:
            if isinstance(part, t.Region) and part.name is not None:
                yield part.name.text, f"a region {of}", part.name.span
        for name, span in self.maps(workspace.name.text).items():
            yield name, f"a map of obstacles {of}", span

    def maps(self, workspace: str) -> dict[str, Span]:
        """The names of the maps of a workspace, readable or not, with where they stand."""
        items = self._declared.workspaces[workspace].items
        maps = [item.path for item in items if isinstance(item, t.ObstaclesFrom)]
        return {map_name(path.text): path.span for path in reversed(maps)}

    def report(
        self,
        name: s.Ident,
        due: str,
        known: Collection[str],
        sink: Sink,
        message: str | None = None,
    ) -> None:
        """Report a name that is not ``due``: what it is instead, or that there is none.

        Args:
            name: the name.
            due: what is due here, with its article: ``a grammar``.
            known: the names that would do.
            sink: where the error goes.
            message: what to say of a name that stands for nothing at all.
        """
        what = due.split(" ", 1)[1]
        hint = did_you_mean(name.text, known, what, sink)
        if name.text in self._kinds:
            kind, span = self._kinds[name.text]
            sink.error(
                Code.WRONG_KIND,
                f"`{name.text}` is {kind}, not {due}",
                name.span,
                hint,
                [(span, "declared here")],
            )
        else:
            unknown = message or f"unknown {what} `{name.text}`"
            sink.error(Code.UNKNOWN_NAME, unknown, name.span, hint)


class RegionNames:
    """The names of the regions and maps of a workspace."""

    def __init__(self, workspace: ir.Workspace, kinds: NameKinds) -> None:
        self._workspace = workspace.name
        self._kinds = kinds
        regions = {region.name: region.span for region in workspace.regions}
        self._maps = kinds.maps(workspace.name)
        self._places = tuple(regions)
        self._ordered = tuple(regions | self._maps)
        self.names = frozenset(self._ordered)

    def check(self, name: s.Ident, sink: Sink) -> None:
        """Report a name that is no region or map of the workspace."""
        if name.text not in self.names:
            self._unknown(name, self._ordered, sink)

    def check_place(self, name: s.Ident, sink: Sink) -> None:
        """Report a name that is no region, where one starts or ends."""
        if name.text in self._maps:
            message = f"`{name.text}` is a map of obstacles, and no place to start or to end"
            notes = [(self._maps[name.text], "declared here")]
            hint = "name a region; a map is avoided, or named in a formula"
            sink.error(Code.WRONG_KIND, message, name.span, hint, notes)
        elif name.text not in self.names:
            self._unknown(name, self._places, sink)

    def _unknown(self, name: s.Ident, known: tuple[str, ...], sink: Sink) -> None:
        message = f"workspace `{self._workspace}` has no region `{name.text}`"
        due = f"a region of workspace `{self._workspace}`"
        self._kinds.report(name, due, known, sink, message)
