"""After errors: the sound part of a program, and diagnostics that only follow from others.

The later checks use the sound part.  A statement that cannot be parsed is dropped; if a name in it,
or a clause of its item, is then missing, that is not reported.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity
from grammar_lang.source import Span
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from grammar_lang.syntax.tasks import File

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class _Unsound:
    """The items that contain an error, as (kind, name)."""

    items: frozenset[tuple[type, str]]

    def without(self, kind: type, named: Mapping[str, Item]) -> dict[str, Item]:
        """The items of that kind that are sound."""
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
    """The grammar, without its semantics if that or one of its modules has an error."""
    used = (x.name for p in grammar.productions for x in p.right if x.kind == "module")
    if grammar.name in semantics and all(name in modules for name in used):
        return grammar
    return replace(grammar, semantics=None)


def sound_part(program: ir.Program, file: t.File, found: Iterable[Diagnostic]) -> ir.Program:
    """The grammars, workspaces and tasks without an error in themselves or in what they use.

    Args:
        program: the program of a file that may have errors.
        file: its syntax.
        found: all diagnostics, including those that only follow from others.
    """
    unsound = _unsound(file, found)
    modules = unsound.without(s.Module, program.modules)
    semantics = unsound.without(
        s.Semantics, {g.name: g.semantics for g in program.grammars.values() if g.semantics}
    )
    grammars = {
        name: _grammar(grammar, semantics, modules)
        for name, grammar in unsound.without(s.Grammar, program.grammars).items()
        if all(module in modules for module in grammar.listed)
    }
    workspaces = unsound.without(t.Workspace, program.workspaces)
    tasks = {
        name: task
        for name, task in unsound.without(t.Task, program.tasks).items()
        if task.grammar in grammars and task.workspace in workspaces
    }
    missions = {
        name: mission
        for name, mission in unsound.without(m.Mission, program.missions).items()
        if all(task in tasks for task in mission.tasks)
    }
    return replace(
        program, grammars=grammars, workspaces=workspaces, tasks=tasks, missions=missions
    )


# --- Diagnostics that follow from others ------------------------------------------------------


_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_QUOTED = re.compile(r"`([^`]*)`")

_MISSING = frozenset(
    {
        Code.MISSING_CLAUSE,
        Code.EMPTY_MISSION,
        Code.CONTRADICTORY_MISSION,
        Code.MISSING_START,
        Code.MISSING_BLOCK,
        Code.BAD_DOF_USE,
        Code.UNDEFINED_ATTRIBUTE,
        Code.BAD_DYNAMICS,
        Code.MISSING_FRAME,
        Code.NOT_MOUNTED,
    }
)
_NAMED = _MISSING | {
    Code.UNKNOWN_NAME,
    Code.UNUSED_NAME,
    Code.UNUSED_SYMBOL,
    Code.UNUSED_OBSTACLE,
    Code.NO_AMOUNT,
    Code.AMOUNT_OF_ZERO,
}


class Spans:
    """Disjoint spans, with a search for the one that covers a place."""

    def __init__(self, spans: Iterable[Span]) -> None:
        self._spans = sorted(spans, key=lambda span: (span.file, span))
        self._starts = [(span.file, span.start) for span in self._spans]

    def covering(self, place: Span) -> Span | None:
        """The span that contains the start of ``place``, or ends there."""
        index = bisect_right(self._starts, (place.file, place.start)) - 1
        if index < 0:
            return None
        found = self._spans[index]
        return found if found.file == place.file and place.start <= found.end else None


def without_followers(
    found: Sequence[Diagnostic], file: File, *, complete: bool = True
) -> tuple[Diagnostic, ...]:
    """The diagnostics that do not merely follow from the syntax errors of a file.

    Args:
        found: all diagnostics.
        file: its syntax, with what could not be parsed.
        complete: whether all included files were read; if not, no name is reported as unknown.
    """
    if complete and not file.broken:
        return tuple(found)
    broken = Spans(file.broken)

    def follows(diagnostic: Diagnostic) -> bool:
        if diagnostic.code in _MISSING and broken.covering(diagnostic.span):
            return True
        # An axis as a value: its name may be that of what could not be declared.
        axis = diagnostic.code is Code.SORT_MISMATCH and broken.covering(diagnostic.span)
        if not axis and diagnostic.code not in _NAMED:
            return False
        if not complete and not axis:
            return True
        quoted = " ".join(_QUOTED.findall(diagnostic.message))
        return any(word in file.skipped for word in _WORD.findall(quoted))

    return tuple(d for d in found if not follows(d))
