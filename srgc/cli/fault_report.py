"""What becomes of exceptions: one message, and an exit status."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable
from functools import partial

import click

from srgc.faults import (
    INTERNAL,
    INTERRUPTED,
    MOST_FINDINGS,
    NO_READER,
    SPEC_ERRORS,
    UNKNOWN,
    USAGE,
    Checked,
    NoAnswer,
    SolversDisagree,
    SpecErrors,
    UsageFault,
)
from srgc.interruption import interrupted_text
from srgc.terminal import colours, silence

NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def guarded(action: Callable[[], int]) -> int:
    """The status of an action; whatever it raises is reported and has a status, too."""
    try:
        return action()
    except (BrokenPipeError, SystemExit):
        return _no_reader()
    except BaseException as error:
        status, tell = _report(error)
        try:
            tell()
        except OSError:  # nobody reads it, or the disk is full: the status still says it
            silence(sys.stderr)
        return status


def show(checked: Checked, *, stderr: bool) -> None:
    """Print findings, in colour where it is shown."""
    from grammar_lang.diagnostics.render import to_text

    colour = colours(sys.stderr if stderr else sys.stdout)
    text = to_text(checked.diagnostics, checked.sources, colour=colour, most=MOST_FINDINGS)
    click.echo(text, err=stderr, nl=False, color=True)


def _report(error: BaseException) -> tuple[int, Callable[[], None]]:
    """The status of an exception, and what says what happened."""
    match error:
        case UsageFault():
            return USAGE, _message(error.finding(colour=colours(sys.stderr)))
        case SolversDisagree():
            return INTERNAL, _message(f"error: {error}")
        case SpecErrors(checked=checked):
            return SPEC_ERRORS, partial(show, checked, stderr=True)
        case click.exceptions.NoArgsIsHelpError():
            return USAGE, _message(error.format_message())
        case click.ClickException():
            return USAGE, error.show
        case click.Abort() | KeyboardInterrupt():
            return INTERRUPTED, _message(interrupted_text())
        case Exception():
            return _fault(error)
        case _:
            raise error


def _fault(error: Exception) -> tuple[int, Callable[[], None]]:
    """Of an answer that could not be had, a device that takes no more, or a fault of srgc."""
    from compiler.words.budget import BudgetExceededError

    if isinstance(error, BudgetExceededError | NoAnswer):
        return UNKNOWN, _message(f"unknown: {error}")
    if isinstance(error, OSError) and error.errno in NO_SPACE:
        return USAGE, _message(f"error: the output cannot be written: {error.strerror}")
    if "SRGC_TRACEBACK" in os.environ:
        raise error
    kind = type(error).__name__
    return INTERNAL, _message(
        f"internal error: {kind}: {error}\n"
        "this is a fault of srgc, not of your file; SRGC_TRACEBACK=1 shows where it is"
    )


def _message(text: str) -> Callable[[], None]:
    return partial(click.echo, text, err=True, color=colours(sys.stderr))


def _no_reader() -> int:
    """The reader has gone (click turns that into an exit of its own): no more can be said.

    Not 0, which says that all is well: 141 is what a shell says of a program that such a pipe ends.
    """
    for stream in (sys.stdout, sys.stderr):
        silence(stream)
    return NO_READER
