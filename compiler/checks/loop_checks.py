"""Whether a motion that goes on for ever can begin where its task says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.robots.effector_counts import several_effectors
from compiler.workspaces.polytope import Polytope, refuting_polytope
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.source import Span


def loop_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report starts of repeating tasks that contradict what formulas demand at all times.

    Maps are obstacles already. A start in a region is checked only if the effector that starts
    there is known. A start at given coordinates is reported only if all robots of the family
    certainly begin on the wrong side.
    """
    for task in program.tasks.values():
        if not task.repeat:
            continue
        asked = [each for clause in task.satisfy for each in _at_first(clause.formula)]
        if isinstance(task.start, ir.StartIn):
            for atom, inside in asked:
                _check(program, task, task.start, atom, sink, inside=inside)
        elif asked:
            _check_given(program, task, task.start, asked, sink)


def _at_first(formula: ir.Formula, *, positive: bool = True) -> Iterator[tuple[ir.Atom, bool]]:
    """The atoms that are true (or false) at the first instant whenever a formula holds there."""
    match formula:
        case ir.Atom(poses=poses):
            # An effector that is not in a required pose may be anywhere.
            if positive or not poses:
                yield formula, positive
        case ir.Not(operand=part):
            yield from _at_first(part, positive=not positive)
        case ir.And(operands=parts) | ir.Or(operands=parts):
            if isinstance(formula, ir.And) is positive:
                for part in parts:
                    yield from _at_first(part, positive=positive)
        case ir.Implies(left=left, right=right) if not positive:
            yield from _at_first(left, positive=True)
            yield from _at_first(right, positive=False)
        case ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window):
            if isinstance(formula, ir.Always) is positive and window.lower == 0:
                yield from _at_first(part, positive=positive)
        case _:
            return


def _check(
    program: ir.Program,
    task: ir.Task,
    start: ir.StartIn,
    atom: ir.Atom,
    sink: Sink,
    *,
    inside: bool,
) -> None:
    if _starting(program, task, start) != atom.effector:
        return
    workspace = program.workspaces[task.workspace]
    begins, asked = _region(workspace, start.region), _region(workspace, atom.region)
    if begins is None or asked is None:
        return
    if begins.intersection(asked).is_empty if inside else asked.contains(begins):
        _report(sink, atom, (start.span, f"it starts in `{start.region}`"), inside=inside)


def _check_given(
    program: ir.Program,
    task: ir.Task,
    start: ir.StartAt,
    asked: Sequence[tuple[ir.Atom, bool]],
    sink: Sink,
) -> None:
    # This module loads CasADi, which other checks do not need.
    from compiler.checks.given_positions import given_positions

    positions = given_positions(program, task, start)
    if positions is None:
        return
    workspace = program.workspaces[task.workspace]
    for atom, inside in asked:
        region = _region(workspace, atom.region)
        if region is None:
            continue
        wrong = positions.outside if inside else positions.inside
        if wrong(atom.effector, region):
            note = start.span, "it starts at these coordinates"
            _report(sink, atom, note, inside=inside)


def _report(sink: Sink, atom: ir.Atom, note: tuple[Span, str], *, inside: bool) -> None:
    where = "outside" if inside else "inside"
    sink.error(
        Code.START_OUTSIDE_LOOP,
        f"the motion starts {where} `{atom.region}`, but this must hold at all times",
        atom.span,
        "write `eventually always` for what holds once the motion has come to its loop",
        [note],
    )


def _starting(program: ir.Program, task: ir.Task, start: ir.StartIn) -> int | None:
    """The number of the effector that starts in the region; None if the task leaves it open."""
    named = start.effector or (None if task.reach is None else task.reach.effector)
    if named is None and several_effectors(program, program.grammars[task.grammar]) is False:
        return 1
    return named


def _region(workspace: ir.Workspace, name: str) -> Polytope | None:
    """The exact set of a region; None if it has no interior or is unbounded, reported elsewhere."""
    shape = refuting_polytope(workspace.region(name).shape, workspace.dimension)
    return shape if shape.is_bounded and not shape.is_empty and shape.has_interior else None
