"""The interface of this package: it takes a file or a text and returns a program or diagnostics."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.disturbances import check_ownership
from grammar_lang.elaboration.families import Family, family_of
from grammar_lang.elaboration.modules import ModuleInfo, lower_module
from grammar_lang.elaboration.productions import lower_grammar
from grammar_lang.elaboration.recovery import sound_part, without_followers
from grammar_lang.elaboration.semantics import lower_semantics
from grammar_lang.elaboration.tasks import Surroundings, lower_task
from grammar_lang.elaboration.workspaces import lower_workspace
from grammar_lang.files.file_tree import (
    LIMIT,
    FileSet,
    FileTree,
    TooLarge,
    decoded,
    is_text,
    name_of,
    read_file,
    reason,
    too_large,
)
from grammar_lang.files.inclusion import Inclusion, include_all
from grammar_lang.names.resolver import resolve_names
from grammar_lang.names.table import NameTable, report_unused
from grammar_lang.parsing.parse import without_collection
from grammar_lang.source import Source, Span
from grammar_lang.syntax import tasks as t
from grammar_lang.syntax.tasks import File

_START = Span(0, 0)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A program with its diagnostics; the program is None if and only if there is an error.

    ``sources`` are all files that were read: the main file, its includes, maps and images.
    ``sound`` is the part of the program without errors, for checks that look at one grammar,
    workspace or task at a time; None if nothing could be read.  ``syntax`` is all that could be
    parsed, of all files, and ``names`` are the names in it; both are None if the main file is not
    text.  ``opened`` maps the span of the path in an ``include`` to the number of the file that it
    reads.
    """

    program: ir.Program | None
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]
    sound: ir.Program | None = None
    syntax: File | None = None
    names: NameTable | None = None
    opened: Mapping[Span, int] = field(default_factory=dict[Span, int])


@without_collection
def load_text(
    text: str,
    name: str,
    folder: Path | None = None,
    open_files: Mapping[str, bytes] | None = None,
) -> Loaded:
    """Check a text.

    Args:
        text: the specification.
        name: what diagnostics call it.
        folder: the folder that paths in the text are relative to; without it, the text can include
            only files of the library.
        open_files: the contents that an editor holds of other files, by path with links resolved;
            they are used instead of what is on disk.
    """
    sink = Sink()
    text = text.removeprefix("\ufeff")
    data = text.encode("utf-8", "surrogatepass")
    tree = None
    if folder is not None:
        tree = FileTree(folder, os.path.realpath(folder), name, open_files or {})
    source = Source(name, text, Path(name).name, data)
    if len(data) > LIMIT:
        too_large("the text has", len(data), LIMIT, _START, sink)
        return _refused(source, sink=sink)
    return _checked(source, tree, sink, sound=is_text(text, 0, sink))


@without_collection
def load(path: Path, open_files: Mapping[str, bytes] | None = None) -> Loaded:
    """Check a file and all that it includes.

    A file that cannot be read gives a diagnostic, never an exception.

    Args:
        path: the file.
        open_files: as for :func:`load_text`; the file itself may be among them.
    """
    sink = Sink()
    name = name_of(path)
    try:
        held = (open_files or {}).get(os.path.realpath(path))
        data = read_file(path, LIMIT) if held is None else held
        top = os.path.realpath(path.parent)
    except (OSError, ValueError) as error:
        hint = "give the path of an `.srg` file"
        sink.error(Code.UNREADABLE_FILE, f"cannot read the file: {reason(error)}", _START, hint)
        return _refused(Source(name, ""), sink=sink)
    except TooLarge as large:
        too_large("the file has", large.size, LIMIT, _START, sink)
        return _refused(Source(name, ""), sink=sink)
    text, sound = decoded(data, 0, sink)
    source = Source(name, text, path.name, data)
    tree = FileTree(path.parent, top, path.name, open_files or {})
    return _checked(source, tree, sink, sound=sound)


def _checked(source: Source, tree: FileTree | None, sink: Sink, *, sound: bool) -> Loaded:
    """Check a text that is within the size limit."""
    if not sound:
        return _refused(source, sink=sink)
    files = FileSet(tree, sink, [source], LIMIT - len(source.data))
    real = "" if tree is None else os.path.realpath(tree.folder / source.path)
    all_of_it = include_all(files, real)
    sources = tuple(files.sources)
    if not all_of_it.file.items and not all_of_it.file.broken and not sink.has_errors:
        hint = "declare modules, a grammar, a workspace and a task"
        sink.error(Code.EMPTY_FILE, "the file declares nothing", _START, hint)
    names = resolve_names(all_of_it.file, sink)
    program = lower(all_of_it.file, names, sources, all_of_it, sink)
    if not sink.has_errors:
        found, syntax = sink.sorted(), all_of_it.file
        return Loaded(program, found, sources, program, syntax, names, all_of_it.opened)
    part = sound_part(program, all_of_it.file, sink.found)
    told = without_followers(sink.sorted(), all_of_it.file, complete=all_of_it.complete)
    sound_program = part if all_of_it.complete else None
    return Loaded(None, told, sources, sound_program, all_of_it.file, names)


def _refused(*sources: Source, sink: Sink) -> Loaded:
    return Loaded(None, sink.sorted(), sources)


# --- From the abstract syntax of a file to its program --------------------------------------------


def _modules(
    file: t.File, names: NameTable, meshes: Mapping[Span, ir.Mesh | ir.VisualFile], sink: Sink
) -> dict[str, ModuleInfo]:
    """The modules by name; if a name is declared twice, the second is checked but left out."""
    found: dict[str, ModuleInfo] = {}
    for item in file.items:
        if isinstance(item, s.Module):
            info = lower_module(item, sink)
            if s.owns_body(item):
                from grammar_lang.elaboration.module_bodies import with_body

                info = with_body(info, item, meshes, sink)
            if names.declared.is_first(item):
                found[item.name.text] = info
    return found


def _check_semantics(names: NameTable, sink: Sink) -> None:
    for name, semantics in names.declared.semantics.items():
        if name in names.declared.grammars and names.declared.grammars[name].from_ports:
            message = f"grammar `{name}` is made from ports, and so is its semantics"
            hint = "`srgc expand` prints both, to be continued by hand; or write other modules"
            sink.error(Code.OTHER_GRAMMAR, message, semantics.grammar.span, hint)
        if names.entity(semantics.grammar) is None:
            hint = did_you_mean(name, names.declared.grammars, "grammar", sink)
            message = f"semantics of an unknown grammar `{name}`"
            sink.error(Code.UNKNOWN_NAME, message, semantics.grammar.span, hint)


def lower(
    file: t.File,
    names: NameTable,
    sources: tuple[Source, ...],
    read: Inclusion,
    sink: Sink,
) -> ir.Program:
    """Build the program of a file; it is meaningful only if no error was reported.

    Args:
        file: the items of the file and of all that it includes.
        names: the declaration that each name refers to.
        sources: the texts that spans point into.
        read: the maps and meshes that were read.
        sink: collects the diagnostics.
    """
    declared = names.declared
    modules = _modules(file, names, read.meshes, sink)
    _check_semantics(names, sink)
    spans = {item.span: name for name, item in declared.modules.items()}
    broken = {spans[span] for span in file.broken if span in spans}
    grammars: dict[str, ir.Grammar] = {}
    families: dict[str, Family] = {}
    for name, grammar in declared.grammars.items():
        semantics = None
        if grammar.from_ports:
            from grammar_lang.elaboration.port_grammars import lower_port_grammar

            lost = {*modules} if grammar.span in file.broken else broken
            info, semantics = lower_port_grammar(grammar, modules, lost, names, sink)
        else:
            info = lower_grammar(grammar, names, sink)
        if name in declared.semantics and not grammar.from_ports:
            semantics = lower_semantics(
                info, declared.semantics[name], modules, names, read.meshes, sink
            )
        blocks = None if semantics is None else semantics.blocks
        grammars[name] = replace(info.grammar, semantics=blocks)
        families[name] = family_of(info, semantics, modules)
    workspaces = {
        name: lower_workspace(w, read.maps, sink) for name, w in declared.workspaces.items()
    }
    tasks: dict[str, ir.Task] = {}
    around = Surroundings(names, modules, families, workspaces)
    for name, task in declared.tasks.items():
        lowered = lower_task(task, around, sink)
        if lowered is not None:
            tasks[name] = lowered
            check_ownership(lowered, grammars, sink)
    program = ir.Program(
        modules={name: info.module for name, info in modules.items()},
        terminals=tuple(declared.terminals),
        grammars=grammars,
        workspaces=workspaces,
        tasks=tasks,
        sources=sources,
        terminal_spans={name: found.span for name, found in declared.terminals.items()},
    )
    if declared.missions:
        from grammar_lang.elaboration.missions import lower_missions

        # A mission reports nothing about tasks that have errors of their own.
        sound = sound_part(program, file, sink.found) if sink.has_errors else program
        missions = lower_missions(declared.missions, around, sound.tasks, sink)
        program = replace(program, missions=missions)
    report_unused(names, sink)
    return program
