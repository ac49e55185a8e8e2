"""The face of this package: a file or a text in, a program or diagnostics out."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from grammar_lang import ir
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Diagnostic, Sink
from grammar_lang.elaboration.lower import lower
from grammar_lang.elaboration.recovery import sound_part, without_followers
from grammar_lang.files.file_set import FileSet, too_large
from grammar_lang.files.file_tree import FileTree, name_of
from grammar_lang.files.inclusion import include_all
from grammar_lang.files.source_file import LIMIT, TooLarge, decoded, is_text, read_file, reason
from grammar_lang.names.resolver import resolve_names
from grammar_lang.names.table import NameTable
from grammar_lang.paused_collection import without_collection
from grammar_lang.source import Source, Span
from grammar_lang.syntax.tasks import File

_START = Span(0, 0)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A program with its diagnostics; the program is None if and only if one is an error.

    ``sources`` are all files that were read: the main file, what it includes, maps and images.
    ``sound`` is what of the program has no error, for the checks that look at one grammar,
    workspace or task at a time; None where nothing could be read.  ``syntax`` is what could be
    parsed, of all files, and ``names`` are the names in it; None where the main file is no text.
    """

    program: ir.Program | None
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]
    sound: ir.Program | None = None
    syntax: File | None = None
    names: NameTable | None = None


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
        folder: where the text is taken to stand; without it, it includes nothing.
        open_files: what an editor holds of other files, by their path without links; these bytes
            are taken for what stands on the disk.
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
    """Check a file with all it includes.

    One that cannot be read gives one diagnostic, never an exception.

    Args:
        path: the file.
        open_files: as for :func:`load_text`; the file itself may be one of them.
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
    """The program of a text that is not too large."""
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
    program = lower(all_of_it.file, names, sources, all_of_it.maps, sink)
    if not sink.has_errors:
        return Loaded(program, sink.sorted(), sources, program, all_of_it.file, names)
    part = sound_part(program, all_of_it.file, sink.found)
    told = without_followers(sink.sorted(), all_of_it.file, complete=all_of_it.complete)
    sound_program = part if all_of_it.complete else None
    return Loaded(None, told, sources, sound_program, all_of_it.file, names)


def _refused(*sources: Source, sink: Sink) -> Loaded:
    return Loaded(None, sink.sorted(), sources)
