"""Turn exceptions into one message and an exit status."""

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
    """Run an action and return its status; an exception is reported and turned into one."""
    try:
        return action()
    except (BrokenPipeError, SystemExit):
        return _no_reader()
    except BaseException as error:
        status, tell = _report(error)
        try:
            tell()
        except OSError:  # nobody reads it, or the disk is full: the status still tells
            silence(sys.stderr)
        return status


def show(checked: Checked, *, stderr: bool) -> None:
    """Print diagnostics, in colour if the stream shows colours."""
    from grammar_lang.diagnostics.render import to_text

    colour = colours(sys.stderr if stderr else sys.stdout)
    text = to_text(checked.diagnostics, checked.sources, colour=colour, most=MOST_FINDINGS)
    click.echo(text, err=stderr, nl=False, color=True)


def _report(error: BaseException) -> tuple[int, Callable[[], None]]:
    """The exit status for an exception, and a function that prints the message."""
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
    """Status and message for a missing answer, a full device, or a bug in srgc."""
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
    """Silence both streams: the reader has gone (click turns that into a SystemExit of its own).

    The status is not 0, which would mean success.  A shell reports 141 for a program that a broken
    pipe ends.
    """
    for stream in (sys.stdout, sys.stderr):
        silence(stream)
    return NO_READER
