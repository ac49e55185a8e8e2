"""The declarations of a file: one name space for modules, edges and nonterminals."""

from __future__ import annotations

from dataclasses import dataclass, field

from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.modules import ModuleInfo, duplicate, lower_module
from grammar_lang.source import Span


@dataclass(slots=True)
class Declarations:
    """What a file declares, in order of declaration; only first declarations are kept."""

    modules: dict[str, ModuleInfo] = field(default_factory=dict[str, ModuleInfo])
    terminals: dict[str, Span] = field(default_factory=dict[str, Span])
    grammars: dict[str, s.Grammar] = field(default_factory=dict[str, s.Grammar])
    semantics: dict[str, s.Semantics] = field(default_factory=dict[str, s.Semantics])
    workspaces: dict[str, t.Workspace] = field(default_factory=dict[str, t.Workspace])
    tasks: dict[str, t.Task] = field(default_factory=dict[str, t.Task])


def _terminal(name: s.Ident, declared: Declarations, sink: Sink) -> bool:
    if name.text in declared.terminals:
        duplicate(name, declared.terminals[name.text], sink)
        return False
    declared.terminals[name.text] = name.span
    return True


def _edges(edges: s.Edges, declared: Declarations, sink: Sink) -> None:
    for name in edges.names:
        if not name.text or not name.text.isprintable() or " " in name.text:
            message = "an edge label is neither empty nor contains blanks"
            sink.error(Code.SYNTAX, message, name.span, "write visible characters only")
        else:
            _terminal(name, declared, sink)


def _named(item: s.Grammar | t.Workspace | t.Task, declared: Declarations, sink: Sink) -> None:
    first: s.Grammar | t.Workspace | t.Task
    match item:
        case s.Grammar():
            first = declared.grammars.setdefault(item.name.text, item)
        case t.Workspace():
            first = declared.workspaces.setdefault(item.name.text, item)
        case t.Task():
            first = declared.tasks.setdefault(item.name.text, item)
    if first is not item:
        duplicate(item.name, first.name.span, sink)


def _item(item: t.Item, declared: Declarations, sink: Sink) -> None:
    match item:
        case s.Module(name=name):
            info = lower_module(item, sink)
            if _terminal(name, declared, sink):
                declared.modules[name.text] = info
        case s.Edges():
            _edges(item, declared, sink)
        case s.Semantics(grammar=name):
            first = declared.semantics.setdefault(name.text, item)
            if first is not item:
                message = f"a second `semantics` of grammar `{name.text}`"
                notes = [(first.grammar.span, "first here")]
                sink.error(Code.DUPLICATE_NAME, message, name.span, "merge the two", notes)
        case t.Include():
            pass
        case s.Grammar() | t.Workspace() | t.Task():
            _named(item, declared, sink)


def declarations(file: t.File, sink: Sink) -> Declarations:
    """Collect the declarations of a file; second ones of a name are reported."""
    declared = Declarations()
    for item in file.items:
        _item(item, declared, sink)
    return declared
