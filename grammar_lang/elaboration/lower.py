"""From the abstract syntax of a file to its program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.modules import ModuleInfo, lower_module
from grammar_lang.elaboration.productions import GrammarInfo, lower_grammar
from grammar_lang.elaboration.semantics import SemanticsInfo, lower_semantics
from grammar_lang.elaboration.tasks import Family, Surroundings, lower_task
from grammar_lang.elaboration.workspaces import lower_workspace
from grammar_lang.names.table import NameTable
from grammar_lang.names.unused import report_unused
from grammar_lang.source import Source, Span
from grammar_lang.syntax import tasks as t


def _modules(file: t.File, names: NameTable, sink: Sink) -> dict[str, ModuleInfo]:
    """The modules by name; a second one of a name is checked and left out."""
    found: dict[str, ModuleInfo] = {}
    for item in file.items:
        if isinstance(item, s.Module):
            info = lower_module(item, sink)
            if names.declared.is_first(item):
                found[item.name.text] = info
    return found


def _check_semantics(names: NameTable, sink: Sink) -> None:
    for name, semantics in names.declared.semantics.items():
        if names.entity(semantics.grammar) is None:
            hint = did_you_mean(name, names.declared.grammars, "grammar", sink)
            message = f"semantics of an unknown grammar `{name}`"
            sink.error(Code.UNKNOWN_NAME, message, semantics.grammar.span, hint)


def _family(
    grammar: GrammarInfo, semantics: SemanticsInfo | None, modules: Mapping[str, ModuleInfo]
) -> Family:
    symbols = [x.name for p in grammar.grammar.productions for x in p.right]
    used = [modules[name].module for name in symbols if name in modules]
    joints = {dof.kind for module in used for dof in module.dofs}
    driven = {dof.kind for module in used for dof in module.free_dofs}
    kinds: tuple[ir.DofKind, ...] = ("revolute", "prismatic")
    return Family(
        kinds=tuple(kind for kind in kinds if kind in joints),
        driven=tuple(kind for kind in kinds if kind in driven),
        has_semantics=semantics is not None,
        uses=() if semantics is None else semantics.uses,
    )


def lower(
    file: t.File,
    names: NameTable,
    sources: tuple[Source, ...],
    maps: Mapping[Span, ir.ObstacleMap],
    sink: Sink,
) -> ir.Program:
    """The program of a file, meaningful if no error was reported.

    Args:
        file: the items of the file and of all it includes.
        names: what its names stand for.
        sources: the texts that spans point into.
        maps: the files of obstacles, by the span of the path that names each.
        sink: takes the findings.
    """
    declared = names.declared
    modules = _modules(file, names, sink)
    _check_semantics(names, sink)
    grammars: dict[str, ir.Grammar] = {}
    families: dict[str, Family] = {}
    for name, grammar in declared.grammars.items():
        info = lower_grammar(grammar, names, sink)
        semantics = None
        if name in declared.semantics:
            semantics = lower_semantics(info, declared.semantics[name], modules, names, sink)
        blocks = None if semantics is None else semantics.blocks
        grammars[name] = replace(info.grammar, semantics=blocks)
        families[name] = _family(info, semantics, modules)
    workspaces = {name: lower_workspace(w, maps, sink) for name, w in declared.workspaces.items()}
    tasks: dict[str, ir.Task] = {}
    around = Surroundings(names, modules, families, workspaces)
    for name, task in declared.tasks.items():
        lowered = lower_task(task, around, sink)
        if lowered is not None:
            tasks[name] = lowered
    report_unused(names, sink)
    return ir.Program(
        modules={name: info.module for name, info in modules.items()},
        terminals=tuple(declared.terminals),
        grammars=grammars,
        workspaces=workspaces,
        tasks=tasks,
        sources=sources,
        terminal_spans={name: found.span for name, found in declared.terminals.items()},
    )
