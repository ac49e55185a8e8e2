"""The parts of a formula and their occurrences."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import degrees
from typing import assert_never

from grammar_lang import ir
from grammar_lang.ir.constants import to_float

# --- The parts of a formula -----------------------------------------------------------------------


def operands(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    """The direct subformulas, from left to right."""
    match formula:
        case ir.Atom():
            return ()
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return parts
        case ir.Implies(left=left, right=right) | ir.Until(left=left, right=right):
            return left, right
        case (
            ir.Not(operand=part)
            | ir.Always(operand=part)
            | ir.Eventually(operand=part)
            | ir.Next(operand=part)
            | ir.Last(operand=part)
        ):
            return (part,)
        case _:
            assert_never(formula)


def subformulas(formula: ir.Formula) -> Iterator[ir.Formula]:
    """The formula and all its parts, outermost first and from left to right."""
    pending = [formula]
    while pending:
        found = pending.pop()
        yield found
        pending += reversed(operands(found))


def atoms(*formulas: ir.Formula) -> tuple[ir.Atom, ...]:
    """The distinct atoms of formulas, in the order of their first occurrence."""
    found = {
        part: None
        for formula in formulas
        for part in subformulas(formula)
        if isinstance(part, ir.Atom)
    }
    return tuple(found)


def with_atoms(formula: ir.Formula, of: Callable[[ir.Atom], ir.Formula]) -> ir.Formula:
    """The formula with its atoms replaced; recursive, since the parser bounds its depth."""
    match formula:
        case ir.Atom():
            return of(formula)
        case ir.Not() | ir.Always() | ir.Eventually() | ir.Next() | ir.Last():
            return replace(formula, operand=with_atoms(formula.operand, of))
        case ir.And() | ir.Or():
            return replace(formula, operands=tuple(with_atoms(p, of) for p in formula.operands))
        case ir.Implies() | ir.Until():
            left, right = with_atoms(formula.left, of), with_atoms(formula.right, of)
            return replace(formula, left=left, right=right)
        case _:
            assert_never(formula)


def asked_poses(task: ir.Task) -> tuple[ir.Pose, ...]:
    """All poses that a task requires of effectors."""
    reached = () if task.reach is None else task.reach.poses
    spoken = atoms(*(clause.formula for clause in task.satisfy))
    return (*reached, *(pose for atom in spoken for pose in atom.poses))


# --- Occurrences of subformulas, and formulas in which one is replaced by a constant --------------
#
# Every operator is monotonic in an occurrence under an even number of negations (*positive*) and
# antitonic in the others.  So a formula becomes stronger if a positive occurrence is replaced by
# false, or a negative one by true.


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A part of a formula; ``path`` holds the operand numbers that lead to it from the top."""

    path: tuple[int, ...]
    formula: ir.Formula
    positive: bool


def occurrences(formula: ir.Formula) -> Iterator[Occurrence]:
    """All parts of a formula, itself included, outermost first and from left to right."""
    pending = [Occurrence((), formula, positive=True)]
    while pending:
        found = pending.pop()
        yield found
        parts = [
            Occurrence((*found.path, number), part, found.positive is not _turns(found, number))
            for number, part in enumerate(operands(found.formula))
        ]
        pending += reversed(parts)


def _turns(found: Occurrence, number: int) -> bool:
    """Whether a part negates its operand of that number."""
    return isinstance(found.formula, ir.Not) or (
        isinstance(found.formula, ir.Implies) and number == 0
    )


def strengthened(formula: ir.Formula, part: Occurrence) -> ir.Formula:
    """The formula with one part replaced by the constant that makes the formula strongest."""
    anywhere = atoms(formula)[0]
    constant: ir.Formula = ir.Or((anywhere, ir.Not(anywhere)))
    if part.positive:
        constant = ir.Not(constant)
    around = [formula]
    for number in part.path[:-1]:
        around.append(operands(around[-1])[number])
    for whole, number in zip(reversed(around), reversed(part.path), strict=False):
        constant = _with_operand(whole, number, constant)
    return constant


def _with_operand(formula: ir.Formula, number: int, part: ir.Formula) -> ir.Formula:
    """The formula with the operand of that number replaced."""
    match formula:
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return replace(formula, operands=(*parts[:number], part, *parts[number + 1 :]))
        case ir.Implies() | ir.Until():
            return replace(formula, left=part) if number == 0 else replace(formula, right=part)
        case ir.Not() | ir.Always() | ir.Eventually() | ir.Next() | ir.Last():
            return replace(formula, operand=part)
        case ir.Atom():
            raise ValueError("an atom has no operands")
        case _:
            assert_never(formula)


# --- ``F until G`` with G about closed regions, in an equivalent form that is easier to prove -----
#
# A point that moves from F straight into G is on the boundary of both at the instant of the change,
# which no enclosure can decide.  But it can be decided that the point is in one of them.


def attained(formula: ir.Formula) -> ir.Formula:
    """An equivalent formula with ``(F or G) until G`` for each ``F until G`` whose G is closed.

    The instants at which G holds form a closed set.  So if F or G holds up to an instant of G,
    there is a first such instant from now on, and F holds at all instants before it.
    """
    match formula:
        case ir.Until(left=left, right=right):
            left, right = attained(left), attained(right)
            return ir.Until(ir.Or((*_alternatives(left), right)) if _closed(right) else left, right)
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return type(formula)(tuple(attained(part) for part in parts))
        case ir.Implies(left=left, right=right):
            return ir.Implies(attained(left), attained(right))
        case ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window):
            return type(formula)(attained(part), window)
        case ir.Not(operand=part) | ir.Next(operand=part):
            return type(formula)(attained(part))
        case ir.Last(operand=part, duration=duration):
            return ir.Last(duration, attained(part))
        case ir.Atom():
            return formula


def _alternatives(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    return formula.operands if isinstance(formula, ir.Or) else (formula,)


def _closed(formula: ir.Formula) -> bool:
    """Whether a formula certainly holds on a closed set of instants: regions are closed sets."""
    if isinstance(formula, ir.And | ir.Or):
        return all(_closed(part) for part in formula.operands)
    return isinstance(formula, ir.Atom)


# --- Formulas as text of the language -------------------------------------------------------------


_TIGHT, _UNTIL, _AND, _OR, _IMPLIES = range(1, 6)
"""How tightly operators bind, numbered as in the language reference."""


def formula_text(formula: ir.Formula) -> str:
    """A formula as text, with only the parentheses that it needs, and times in seconds."""
    return _text(formula)[0]


def _within(formula: ir.Formula, level: int) -> str:
    """A formula, in parentheses unless it binds at least as tightly as ``level``."""
    text, own = _text(formula)
    return text if own <= level else f"({text})"


def _text(formula: ir.Formula) -> tuple[str, int]:
    """A formula as text, and how tightly its operator binds."""
    match formula:
        case ir.Atom(region=region, effector=effector, numbered=numbered, poses=poses):
            named = f"{region} by effector {effector}" if numbered else region
            return " ".join([named, *map(_pose_text, poses)]), 0
        case ir.And(operands=parts):
            return " and ".join(_within(part, _UNTIL) for part in parts), _AND
        case ir.Or(operands=parts):
            return " or ".join(_within(part, _AND) for part in parts), _OR
        case ir.Until(left=left, right=right):
            return f"{_within(left, _TIGHT)} until {_within(right, _UNTIL)}", _UNTIL
        case ir.Implies(left=left, right=right):
            return f"{_within(left, _OR)} implies {_within(right, _IMPLIES)}", _IMPLIES
        case _:
            operator, operand = _prefixed(formula)
            return f"{operator} {_within(operand, _TIGHT)}", _TIGHT


def _pose_text(pose: ir.Pose) -> str:
    within = f"within {_degrees(pose.within)}"
    if isinstance(pose, ir.Aligned):
        direction = ", ".join(f"{float(part):.10g}" for part in pose.direction)
        return f"aligned {pose.axis} to ({direction}) {within}"
    turns = " * ".join(f"rot({axis}, {_degrees(angle)})" for axis, angle in pose.turns)
    return f"oriented {turns or 'world'} {within}"


def _degrees(angle: ir.Expr) -> str:
    return f"{degrees(to_float(angle)):.10g} deg"


def _prefixed(
    formula: ir.Not | ir.Always | ir.Eventually | ir.Next | ir.Last,
) -> tuple[str, ir.Formula]:
    match formula:
        case ir.Not(operand=operand):
            return "not", operand
        case ir.Always(operand=operand, window=window):
            return f"always{_window(window)}", operand
        case ir.Eventually(operand=operand, window=window):
            return f"eventually{_window(window)}", operand
        case ir.Next(operand=operand):
            return "next", operand
        case ir.Last(operand=operand, duration=duration):
            return f"last[{_seconds(duration)}]", operand
        case _:
            assert_never(formula)


def _window(window: ir.Window) -> str:
    if window.upper is None:
        # The language cannot express a window that begins later and never ends; this is for
        # readers.
        return "" if window.lower == 0 else f"[{_seconds(window.lower)}, end]"
    return f"[{_seconds(window.lower)}, {_seconds(window.upper)}]"


def _seconds(time: Fraction) -> str:
    """A time as a decimal if it has a finite one, or else as a quotient."""
    rest = time.denominator
    digits = 0
    for prime in (2, 5):
        power = 0
        while rest % prime == 0:
            rest, power = rest // prime, power + 1
        digits = max(digits, power)
    if rest != 1:
        return f"{time.numerator} s / {time.denominator}"
    whole = str(time.numerator * 10**digits // time.denominator).rjust(digits + 1, "0")
    return (f"{whole[:-digits]}.{whole[-digits:]}" if digits else whole) + " s"
