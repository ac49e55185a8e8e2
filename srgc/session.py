"""From the arguments of a command to a checked program and the named item in it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from compiler.checks.grammar_checks import cycle_diagnostics, grammar_diagnostics
from compiler.checks.workspace_checks import workspace_diagnostics
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Severity, Sink
from grammar_lang.load import Loaded, load
from grammar_lang.parsing.parse import without_collection
from srgc.faults import Checked, NoAnswer, SpecErrors, SrgcError, UsageFault
from srgc.standard_input import DASH, STDIN, standard_input

__all__ = [
    "Checked", "NoAnswer", "SpecErrors", "SrgcError", "UsageFault", "check_file", "check_loaded",
    "check_standard_input", "chosen", "program_of", "refuse_cycles",
]  # fmt: skip

Item = TypeVar("Item")
READS_STDIN = "`srgc check -` and `srgc fmt -` read standard input; other commands read files"


def check_file(path: Path) -> Checked:
    """Run all checks on a file.

    Raises:
        UsageFault: the file exists but cannot be read.
    """
    return _with_near_name(path, check_loaded(_loaded(path)))


def check_standard_input() -> Checked:
    """Run all checks on standard input; files that it names are looked for in the current folder.

    Raises:
        UsageFault: it cannot be read.
    """
    return check_loaded(load(Path(STDIN), {os.path.realpath(STDIN): standard_input()}))


def _loaded(path: Path) -> Loaded:
    try:
        if path == DASH and not path.exists():
            raise UsageFault("`-` is no file", hint=READS_STDIN)
        if path.exists() and not path.is_file():
            hint = None if path.is_dir() else READS_STDIN
            raise UsageFault(f"{path} is not a file", hint=hint)
        if path.is_file():
            path.open("rb").close()
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    return load(path)


def _with_near_name(path: Path, checked: Checked) -> Checked:
    """For a file that does not exist, let the hint name a similar file."""
    if path.exists() or checked.program is not None or len(checked.diagnostics) != 1:
        return checked
    from srgc.paths import near_spec

    meant = near_spec(path)
    if meant is None:
        return checked
    (found,) = checked.diagnostics
    return replace(checked, diagnostics=(replace(found, hint=f"is it `{meant}`?"),))


@without_collection
def check_loaded(loaded: Loaded, *, formulas: bool = True) -> Checked:
    """Run all checks on what was read; if there are errors, on the sound parts.

    Without ``formulas``, skip the checks that need NumPy and a SAT solver.
    """
    if loaded.sound is None:
        return Checked(None, loaded.diagnostics, loaded.sources)
    sink = Sink(list(loaded.diagnostics))
    complete = loaded.program is not None
    grammar_diagnostics(loaded.sound, sink, complete=complete)
    workspace_diagnostics(loaded.sound, sink, complete=complete)
    tasks = loaded.sound.tasks.values()
    if any(task.demanded or task.payloads or task.origin for task in tasks):
        from compiler.checks.task_checks import task_diagnostics

        task_diagnostics(loaded.sound, sink)
    if any(task.robust or task.control for task in tasks):
        from compiler.checks.disturbance_checks import disturbance_diagnostics

        disturbance_diagnostics(loaded.sound, sink, complete=complete)
    if complete and any(task.avoid_self for task in tasks):
        from compiler.checks.self_collision_checks import self_collision_diagnostics

        self_collision_diagnostics(loaded.sound, sink)
    _check_aims(loaded.sound, sink, complete=complete)
    if complete and _has_solids(loaded.sound):
        from compiler.checks.shape_checks import shape_diagnostics

        shape_diagnostics(loaded.sound, sink)
    if complete and any(isinstance(task.start, ir.StartAt) for task in tasks):
        from compiler.checks.given_start_checks import given_start_diagnostics
        from compiler.checks.task_checks import start_diagnostics

        start_diagnostics(loaded.sound, sink)
        given_start_diagnostics(loaded.sound, sink)
    if formulas and any(task.satisfy for task in tasks):
        # Only formulas need the SAT solver; without them, the checks start fast.
        from compiler.checks.loop_checks import loop_diagnostics
        from compiler.tasks.obstacle_pieces import task_by_task
        from solvers.conflicts.vacuity import formula_diagnostics

        for program in task_by_task(loaded.sound):
            loop_diagnostics(program, sink)
            formula_diagnostics(program, sink)
    checked = None if sink.has_errors else loaded.program
    return Checked(checked, sink.sorted(), loaded.sources)


def _check_aims(program: ir.Program, sink: Sink, *, complete: bool) -> None:
    """Check what tasks and missions minimize, and what missions allow to change."""
    tasks, missions = program.tasks.values(), program.missions.values()
    least = any(task.minimize for task in tasks) or any(each.minimize for each in missions)
    if complete and least:
        from compiler.checks.objective_checks import objective_diagnostics

        objective_diagnostics(program, sink)
    if missions:
        from compiler.checks.mission_checks import mission_diagnostics

        mission_diagnostics(program, sink)


def _has_solids(program: ir.Program) -> bool:
    """Whether a robot may have bodies that collide as points because they have no shape."""
    blocks = (b for g in program.grammars.values() for b in (g.semantics or {}).values())
    return any(isinstance(emission, ir.Solid) for block in blocks for emission in block.emissions)


def program_of(path: Path) -> ir.Program:
    """The program of a file without errors.

    Raises:
        SpecErrors: the file has errors.
        UsageFault: it cannot be read.
    """
    return _sound(check_file(path))


def expansion_of(path: Path, output: Path | None = None) -> str:
    """The text of a file without errors, with its grammars from ports written out.

    Raises:
        SpecErrors: the file has errors.
        UsageFault: it cannot be read, or files that it names would not be found beside the output.
    """
    from grammar_lang.formatting.expansion import expanded, names_files

    loaded = _loaded(path)
    _sound(_with_near_name(path, check_loaded(loaded)))
    text = expanded(loaded)
    elsewhere = output is not None and output.parent.resolve() != path.parent.resolve()
    if output is not None and elsewhere and names_files(text):
        where = path.parent / output.name
        raise UsageFault(f"the text names files beside {path}; write it there: -o {where}")
    return text


def _sound(checked: Checked) -> ir.Program:
    if checked.program is None:
        errors = tuple(d for d in checked.diagnostics if d.severity is Severity.ERROR)
        raise SpecErrors(Checked(None, errors, checked.sources))
    return checked.program


def refuse_cycles(program: ir.Program, grammar: ir.Grammar) -> None:
    """Refuse a nonterminal that derives itself, which gives infinitely many robots.

    Elsewhere this is only a warning.

    Raises:
        SpecErrors: the grammar has such a nonterminal.
    """
    sink = Sink()
    cycle_diagnostics(program, grammar, sink)
    errors = tuple(replace(d, severity=Severity.ERROR) for d in sink.sorted())
    if errors:
        raise SpecErrors(Checked(None, errors, program.sources))


def chosen(items: Mapping[str, Item], name: str | None, kind: str, or_else: str = "") -> Item:
    """The item with that name; without a name, the only item.

    ``or_else`` ends the message about a missing name: what may be chosen instead.

    Raises:
        UsageFault: there is no such item or none at all, or there are several and no name is given.
    """
    names = ", ".join(items)
    if name is not None:
        if name in items:
            return items[name]
        from difflib import get_close_matches

        near = get_close_matches(name, items, 1)
        meant = f"did you mean `{near[0]}`? " if near and len(items) > 1 else ""
        raise UsageFault(f"there is no {kind} `{name}`; {meant}the file has: {names or 'none'}")
    if len(items) == 1:
        return next(iter(items.values()))
    if not items:
        raise UsageFault(f"the file has no {kind}")
    raise UsageFault(f"the file has several {kind}s: choose one of {names} with --{kind}{or_else}")
