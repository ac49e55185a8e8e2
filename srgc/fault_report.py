"""What becomes of exceptions: one message, and an exit status."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable
from contextlib import suppress

import click

from srgc.exit_status import INTERNAL, INTERRUPTED, SPEC_ERRORS, UNKNOWN, USAGE
from srgc.faults import MOST_FINDINGS, Checked, NoAnswer, SpecErrors, UsageFault
from srgc.interruption import interrupted_text
from srgc.terminal import colours

NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EIO)


def guarded(action: Callable[[], int]) -> int:
    """The status of an action; whatever it raises is reported and has a status, too."""
    try:
        return action()
    except (BrokenPipeError, SystemExit):
        return _no_reader()
    except BaseException as error:
        try:
            return _reported(error)
        except BrokenPipeError:
            return _no_reader()


def show(checked: Checked, *, stderr: bool) -> None:
    """Print findings, in colour where it is shown."""
    from grammar_lang.findings.render import to_text

    colour = colours(sys.stderr if stderr else sys.stdout)
    text = to_text(checked.diagnostics, checked.sources, colour=colour, most=MOST_FINDINGS)
    click.echo(text, err=stderr, nl=False, color=True)


def _reported(error: BaseException) -> int:
    """Say what happened; the status."""
    match error:
        case UsageFault():
            click.echo(f"error: {error}", err=True)
            return USAGE
        case SpecErrors():
            show(error.checked, stderr=True)
            return SPEC_ERRORS
        case click.exceptions.NoArgsIsHelpError():
            click.echo(error.format_message(), err=True)
            return USAGE
        case click.ClickException():
            error.show()
            return USAGE
        case click.Abort() | KeyboardInterrupt():
            click.echo(interrupted_text(), err=True)
            return INTERRUPTED
        case Exception():
            return _fault(error)
        case _:
            raise error


def _fault(error: Exception) -> int:
    """Report an answer that could not be had, a device that takes no more, or a fault of srgc."""
    from compiler.languages.budget import BudgetExceededError

    if isinstance(error, BudgetExceededError | NoAnswer):
        click.echo(f"unknown: {error}", err=True)
        return UNKNOWN
    if isinstance(error, OSError) and error.errno in NO_SPACE:
        click.echo(f"error: the output cannot be written: {error.strerror}", err=True)
        return USAGE
    if "SRGC_TRACEBACK" in os.environ:
        raise error
    kind = type(error).__name__
    click.echo(
        f"internal error: {kind}: {error}\n"
        "this is a fault of srgc, not of your file; SRGC_TRACEBACK=1 shows where it is",
        err=True,
    )
    return INTERNAL


def _no_reader() -> int:
    """The reader has gone (click turns that into an exit of its own): no more can be said."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):  # closed before, or a stand-in
            os.dup2(nowhere, stream.fileno())
    return 0
