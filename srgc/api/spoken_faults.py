"""Faults of public functions: one exception of srgc with one message, without its inner frames."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from functools import wraps
from inspect import signature
from typing import ParamSpec, TypeVar

from compiler.languages.budget import BudgetExceededError
from srgc.api.due_arguments import refuse_others
from srgc.faults import NoAnswer, SrgcError, UsageFault

P = ParamSpec("P")
T = TypeVar("T")

_OPTION = re.compile(r"(?<![\w`-])--([a-z][a-z-]*)")


def spoken(function: Callable[P, T]) -> Callable[P, T]:
    """The function with faults that end a traceback at the line that called it.

    An argument of another kind than the annotation says is such a fault.  Options that a message
    names are called as the arguments of Python functions are.  With ``SRGC_TRACEBACK`` in the
    environment all frames are kept.
    """
    parameters = signature(function)

    @wraps(function)
    def calling(*arguments: P.args, **named: P.kwargs) -> T:
        __tracebackhide__ = True
        if "SRGC_TRACEBACK" in os.environ:
            return function(*arguments, **named)
        try:
            refuse_others(parameters, arguments, named)
            return function(*arguments, **named)
        except UsageFault as error:
            fault: SrgcError = UsageFault(in_python(str(error)))
        except BudgetExceededError as error:
            fault = NoAnswer(str(error))
        except SrgcError as error:
            fault = error
        raise fault.with_traceback(None) from None

    return calling


def in_python(message: str) -> str:
    """A message about options of a command as one about arguments: ``--max-length``: max_length."""
    message = message.removesuffix(" with -o")
    return _OPTION.sub(lambda option: f"`{option[1].replace('-', '_')}`", message)
