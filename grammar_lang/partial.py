"""What of a program with errors is sound, so that the later checks can look at it all the same."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from grammar_lang.findings.cascades import Spans
from grammar_lang.findings.diagnostics import Diagnostic, Severity

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class _Unsound:
    """The items with an error in them, as (kind, name)."""

    items: frozenset[tuple[type, str]]

    def without(self, kind: type, named: Mapping[str, Item]) -> dict[str, Item]:
        """The sound ones."""
        return {name: item for name, item in named.items() if (kind, name) not in self.items}


def _unsound(file: t.File, found: Iterable[Diagnostic]) -> _Unsound:
    spans = Spans(item.span for item in file.items)
    wrong = [d.span for d in found if d.severity is Severity.ERROR]
    bad = {spans.covering(span) for span in (*wrong, *file.broken)}
    names: set[tuple[type, str]] = set()
    for item in file.items:
        if item.span in bad and not isinstance(item, s.Edges | t.Include):
            name = item.grammar if isinstance(item, s.Semantics) else item.name
            names.add((type(item), name.text))
    return _Unsound(frozenset(names))


def _grammar(
    grammar: ir.Grammar, semantics: Mapping[str, object], modules: Mapping[str, ir.Module]
) -> ir.Grammar:
    """The grammar, without its semantics where they or a module of it are not sound."""
    used = (x.name for p in grammar.productions for x in p.right if x.kind == "module")
    if grammar.name in semantics and all(name in modules for name in used):
        return grammar
    return replace(grammar, semantics=None)


def sound_part(program: ir.Program, file: t.File, found: Iterable[Diagnostic]) -> ir.Program:
    """The grammars, workspaces and tasks without an error in themselves or in what they use.

    Args:
        program: what was lowered of a file, whatever its errors.
        file: its syntax.
        found: all findings, those included that only follow from others.
    """
    unsound = _unsound(file, found)
    modules = unsound.without(s.Module, program.modules)
    semantics = unsound.without(
        s.Semantics, {g.name: g.semantics for g in program.grammars.values() if g.semantics}
    )
    grammars = {
        name: _grammar(grammar, semantics, modules)
        for name, grammar in unsound.without(s.Grammar, program.grammars).items()
    }
    workspaces = unsound.without(t.Workspace, program.workspaces)
    tasks = {
        name: task
        for name, task in unsound.without(t.Task, program.tasks).items()
        if task.grammar in grammars and task.workspace in workspaces
    }
    return replace(program, grammars=grammars, workspaces=workspaces, tasks=tasks)
