"""Faults of public functions: one exception of srgc with one message, without its inner frames.

An argument that is not what its annotation says is one, too: most of those who make that mistake
have no type checker, and call ``srgc.words("arm.srg")``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence, Sized
from dataclasses import dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from numbers import Integral, Real
from os import PathLike
from typing import ParamSpec, TypeVar

from compiler.words.budget import BudgetExceededError
from srgc.faults import NoAnswer, SrgcError, UsageFault
from srgc.paths import refuse_impossible

P = ParamSpec("P")
T = TypeVar("T")


def spoken(function: Callable[P, T]) -> Callable[P, T]:
    """The function with faults that end a traceback at the line that called it.

    An argument of another kind than the annotation says is such a fault.  With
    ``SRGC_TRACEBACK`` in the environment all frames are kept.
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
            fault: SrgcError = UsageFault(error.in_python(), code=error.code, hint=error.hint)
        except BudgetExceededError as error:
            fault = NoAnswer(str(error))
        except SrgcError as error:
            fault = error
        raise fault.with_traceback(None) from None

    return calling


# --- arguments ------------------------------------------------------------------------------------

LONGEST = 60
"""Of what is shown of a value, in characters."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """What a value has to be, in words and as a test."""

    due: str
    holds: Callable[[object], bool]


def _of(*types: type) -> Callable[[object], bool]:
    return lambda value: isinstance(value, types) and not isinstance(value, bytes)


def _holds_values(value: object) -> bool:
    return isinstance(value, Sized) and not isinstance(value, str | bytes)


def _is_source(value: object) -> bool:
    return _of(str, PathLike)(value) or hasattr(value, "to_srg")


_PATH = _Kind("a path", _of(str, PathLike))
_SOURCE = _Kind("a path, or a specification that was built", _is_source)
_SPECIFICATION = _Kind(
    "what `srgc.load` gives, a path, or a specification that was built",
    lambda value: hasattr(value, "ir") or _is_source(value),
)
_MAPPING = _Kind("a mapping, as a dict", _of(Mapping))
_KINDS = {
    "Source": _SOURCE,
    "Specification": _SPECIFICATION,
    "int": _Kind("a whole number", _of(Integral)),
    "float": _Kind("a number", _of(Real)),
    "str": _Kind("a text", _of(str)),
    "str | PathLike[str]": _PATH,
    "Values": _Kind("numbers by their names, or all of them", _holds_values),
    "str | Sequence[str]": _Kind("a text, or several", _of(str, Iterable)),
    "Mapping[str, tuple[float, float]]": _MAPPING,
    "Mapping[str, Sequence[float]]": _MAPPING,
}


def refuse_others(
    signature: Signature, arguments: Sequence[object], named: Mapping[str, object]
) -> None:
    """Refuse arguments that are not what their annotations say; some annotations only.

    Raises:
        UsageFault: one is something else, or a path that there cannot be.
    """
    try:
        given = signature.bind(*arguments, **named).arguments
    except TypeError:
        return  # The call says so, as that of any function does.
    for name, value in given.items():
        parameter = signature.parameters[name]
        several = value if parameter.kind is Parameter.VAR_POSITIONAL else (value,)
        for each in several:
            _refuse_other(name, str(parameter.annotation), each)


def _refuse_other(name: str, annotation: str, value: object) -> None:
    kind = _KINDS.get(annotation.removesuffix(" | None"))
    optional = annotation.endswith(" | None") and value is None
    if kind is None or optional:
        return
    if not kind.holds(value):
        raise UsageFault(f"`{name}` is {kind.due}, not {_shown(value)}")
    if kind in (_SOURCE, _SPECIFICATION) and isinstance(value, str) and {"{", "\n"} & {*value}:
        raise UsageFault(f"`{name}` is a path: `srgc.load(text=...)` reads a specification itself")
    if kind in (_PATH, _SOURCE, _SPECIFICATION) and isinstance(value, str | PathLike):
        refuse_impossible(value)


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
