"""What of a task the compiler cannot use yet.

To leave such a clause out would be unsound: a robot found without it need not do the task, nor be
judged by the rest of it.  A task that has one is refused before anything is searched or verified.
"""

from __future__ import annotations

from collections.abc import Iterator

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity
from grammar_lang.source import Span


def unsupported(task: ir.Task) -> tuple[Diagnostic, ...]:
    """An error for every clause of a task that is not compiled."""
    return tuple(
        Diagnostic(
            Code.NOT_SUPPORTED,
            Severity.ERROR,
            f"{what} cannot be compiled by this version",
            span,
            "remove it to find robots for the rest of the task; `srgc check` reads it already",
            () if span.file == task.span.file and _within(span, task.span) else _needed_by(task),
        )
        for what, span in _clauses(task)
    )


def _within(inner: Span, outer: Span) -> bool:
    return outer.start <= inner.start and inner.end <= outer.end


def _needed_by(task: ir.Task) -> tuple[tuple[Span, str], ...]:
    return ((task.span, f"task `{task.name}` needs it"),)


def _clauses(task: ir.Task) -> Iterator[tuple[str, Span]]:
    if task.avoid_self is not None:
        yield "`avoid self`", task.avoid_self.span
