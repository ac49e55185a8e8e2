"""From the abstract syntax of a file to its program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from grammar_lang import ir
from grammar_lang import syntax_tasks as t
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.findings.spelling import did_you_mean
from grammar_lang.modules import ModuleInfo
from grammar_lang.productions import GrammarInfo, lower_grammar
from grammar_lang.resolve import Declarations, declarations
from grammar_lang.semantics import SemanticsInfo, lower_semantics
from grammar_lang.source import Source, Span
from grammar_lang.tasks import Family, Surroundings, lower_task
from grammar_lang.unused import report_unused
from grammar_lang.workspaces import lower_workspace


def _check_semantics(declared: Declarations, sink: Sink) -> None:
    for name, semantics in declared.semantics.items():
        if name not in declared.grammars:
            hint = did_you_mean(name, declared.grammars, "grammar", sink)
            message = f"semantics of an unknown grammar `{name}`"
            sink.error(Code.UNKNOWN_NAME, message, semantics.grammar.span, hint)


def _family(
    grammar: GrammarInfo, semantics: SemanticsInfo | None, modules: Mapping[str, ModuleInfo]
) -> Family:
    symbols = [s.name for p in grammar.grammar.productions for s in p.right]
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
    file: t.File, sources: tuple[Source, ...], maps: Mapping[Span, ir.ObstacleMap], sink: Sink
) -> ir.Program:
    """The program of a file, meaningful if no error was reported.

    Args:
        file: the items of the file and of all it includes.
        sources: the texts that spans point into.
        maps: the files of obstacles, by the span of the path that names each.
        sink: takes the findings.
    """
    declared = declarations(file, sink)
    _check_semantics(declared, sink)
    grammars: dict[str, ir.Grammar] = {}
    families: dict[str, Family] = {}
    infos: dict[str, GrammarInfo] = {}
    for name, grammar in declared.grammars.items():
        info = infos[name] = lower_grammar(grammar, declared, sink)
        semantics = None
        if name in declared.semantics:
            semantics = lower_semantics(info, declared.semantics[name], declared.modules, sink)
        blocks = None if semantics is None else semantics.blocks
        grammars[name] = replace(info.grammar, semantics=blocks)
        families[name] = _family(info, semantics, declared.modules)
    workspaces = {name: lower_workspace(w, maps, sink) for name, w in declared.workspaces.items()}
    tasks: dict[str, ir.Task] = {}
    around = Surroundings(declared, families, workspaces)
    for name, task in declared.tasks.items():
        lowered = lower_task(task, around, sink)
        if lowered is not None:
            tasks[name] = lowered
    report_unused(file, infos, sink)
    return ir.Program(
        modules={name: info.module for name, info in declared.modules.items()},
        terminals=tuple(declared.terminals),
        grammars=grammars,
        workspaces=workspaces,
        tasks=tasks,
        sources=sources,
        terminal_spans=declared.terminals,
    )
