"""What a shell offers as the value of an argument.

Completion has to be fast and has to work in a spec that is still being written.  So names are read
from the text, line by line; only words need the compiler.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from compiler.words.language import Language

MOST_WORDS = 20
"""The number of words to offer at most."""
MOST_READ = 2000
"""The number of words to search for continuations of what has been typed."""
MOST_FILES = 50
"""The number of files, with includes, to read for names."""
_NAMED = re.compile(r"^\s*(task|grammar|workspace|mission)\s+([^\W\d]\w*)", re.MULTILINE)
_INCLUDE = re.compile(r'^\s*include\s+"([^"\n]+)"', re.MULTILINE)


def complete_file(
    _context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Specs whose path begins with ``incomplete``; if there are none, the shell completes files."""
    return _paths(incomplete, lambda path: path.suffix == ".srg" and path.is_file(), "file")


def complete_folder(
    _context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Result folders whose path begins with ``incomplete``; if there are none, shell folders."""
    from srgc.paths import holds_results

    return _paths(incomplete, holds_results, "dir")


def complete_name(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names declared in the given file, of the kind that the option or argument takes."""
    from click.shell_completion import CompletionItem

    kind = parameter.name if parameter.name in ("task", "workspace", "mission") else "grammar"
    found = dict.fromkeys(name for each, name in _declared(_file(context)) if each == kind)
    return [CompletionItem(name) for name in found if name.startswith(incomplete)]


def complete_code(
    context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Codes of diagnostics, with their titles."""
    from click.shell_completion import CompletionItem

    from grammar_lang.diagnostics.code_pages import title
    from grammar_lang.diagnostics.diagnostic import Code

    given = {str(code).upper() for code in context.params.get("codes") or ()}
    typed = incomplete.upper()
    return [
        CompletionItem(code.value, help=title(code))
        for code in Code
        if code.value.startswith(typed) and code.value not in given
    ]


def complete_word(
    context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Whole words of the family, shortest first."""
    from click.shell_completion import CompletionItem

    words = (" ".join(word) for word in islice(_words(context), MOST_READ))
    fitting = (word for word in words if word.startswith(incomplete))
    return [CompletionItem(word) for word in islice(fitting, MOST_WORDS)]


def complete_symbol(
    context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Symbols that continue the symbols typed so far, in some of the shorter words."""
    from click.shell_completion import CompletionItem

    before = tuple(context.params.get("symbols") or ())
    place = len(before)
    next_ones = (
        word[place]
        for word in islice(_words(context), MOST_READ)
        if len(word) > place and word[:place] == before
    )
    found = dict.fromkeys(symbol for symbol in next_ones if symbol.startswith(incomplete))
    return [CompletionItem(symbol) for symbol in found]


def _paths(incomplete: str, fits: Callable[[Path], bool], otherwise: str) -> list[CompletionItem]:
    """Fitting paths that begin with ``incomplete``, in its folder and in matching subfolders."""
    from click.shell_completion import CompletionItem

    found = [str(path) for path in _near(incomplete) if fits(path)]
    if not found:
        return [CompletionItem(incomplete, type=otherwise)]
    return [CompletionItem(path) for path in sorted(found)]


def _near(incomplete: str) -> Iterator[Path]:
    """The entries whose path begins with ``incomplete``, and the contents of such folders."""
    folder, _, name = incomplete.rpartition("/")
    top = Path(f"{folder}/" if incomplete.startswith("/") else folder)
    for path in _listed(top):
        if path.name.startswith(name) and path.name.startswith(".") <= name.startswith("."):
            yield path
            yield from _listed(path) if path.is_dir() else ()


def _listed(folder: Path) -> list[Path]:
    try:
        return [*folder.iterdir()]
    except OSError:
        return []


def _file(context: click.Context) -> Path | None:
    given = context.params.get("file")
    return given if isinstance(given, Path) else None


def _declared(path: Path | None) -> Iterator[tuple[str, str]]:
    """Kind and name of each declaration in a file and its includes, even if they have errors."""
    due, seen = [] if path is None else [path], set[Path]()
    while due and len(seen) < MOST_FILES:
        each = due.pop(0)
        if each in seen:
            continue
        seen.add(each)
        try:
            text = each.read_text(encoding="utf-8", errors="replace")
        except OSError:
            continue
        yield from _NAMED.findall(text)
        due += [each.parent / name for name in _INCLUDE.findall(text)]


def _words(context: click.Context) -> Iterator[tuple[str, ...]]:
    """The words of the family that the arguments name; no words if the spec has errors."""
    family = _family(context)
    return iter(()) if family is None else iter(family.words())


def _family(context: click.Context) -> Language | None:
    from compiler.words.language import language
    from srgc.session import SrgcError, chosen, program_of

    path = _file(context)
    if path is None:
        return None
    try:
        program = program_of(path)
        name = context.params.get("grammar")
        task = context.params.get("task")
        if task is not None and name is None:
            name = chosen(program.tasks, task, "task").grammar
        family = chosen(program.grammars, name, "grammar")
    except SrgcError:
        return None
    return language(family, program.terminals, program.modules)
