"""The names that expressions read, in no particular order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from grammar_lang import syntax as s


def readings(expressions: Iterable[s.Expr]) -> Iterator[s.Name | s.Member]:
    """Every ``name`` and every ``owner.name`` in some expressions; walks, never recurses."""
    stack = list(expressions)
    while stack:
        match stack.pop():
            case s.Name() | s.Member() as found:
                yield found
            case s.Call(arguments=arguments):
                stack.extend(argument.value for argument in arguments)
            case s.Tuple(items=items):
                stack.extend(items)
            case s.Scaled(operand=operand) | s.Negate(operand=operand):
                stack.append(operand)
            case s.Binary(left=left, right=right):
                stack.extend((left, right))
            case s.Number() | s.AxisName() | s.WorldName():
                pass


def bounds(domain: s.Interval | s.Choices | None) -> tuple[s.Expr, ...]:
    """The expressions of an interval or of a set of values."""
    match domain:
        case s.Interval(lower=lower, upper=upper):
            return lower, upper
        case s.Choices(values=values):
            return values
        case None:
            return ()
