"""The parts of a formula, and their occurrences."""

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
    """The formula and all its parts, from the outside in and from left to right."""
    pending = [formula]
    while pending:
        found = pending.pop()
        yield found
        pending += reversed(operands(found))


def atoms(*formulas: ir.Formula) -> tuple[ir.Atom, ...]:
    """The different atoms of formulas, in the order of their first occurrence."""
    found = {
        part: None
        for formula in formulas
        for part in subformulas(formula)
        if isinstance(part, ir.Atom)
    }
    return tuple(found)


def with_atoms(formula: ir.Formula, of: Callable[[ir.Atom], ir.Formula]) -> ir.Formula:
    """The formula with others in place of its atoms; its depth is bounded by the parser."""
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
    """All that a task says of how effectors' frames are turned."""
    reached = () if task.reach is None else task.reach.poses
    spoken = atoms(*(clause.formula for clause in task.satisfy))
    return (*reached, *(pose for atom in spoken for pose in atom.poses))


# --- Occurrences of subformulas, and formulas in which one is replaced by a constant --------------
#
# Every operator is monotonic in an occurrence under an even number of negations (*positive*) and
# antitonic in the others, so that false in place of a positive occurrence, or true in place of a
# negative one, makes a formula stronger.


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A part of a formula; ``path`` are the numbers of the operands that lead to it."""

    path: tuple[int, ...]
    formula: ir.Formula
    positive: bool


def occurrences(formula: ir.Formula) -> Iterator[Occurrence]:
    """All parts of a formula, itself the first, from the outside in and from left to right."""
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
    """Whether an operand of a part is negated by it."""
    return isinstance(found.formula, ir.Not) or (
        isinstance(found.formula, ir.Implies) and number == 0
    )


def strengthened(formula: ir.Formula, part: Occurrence) -> ir.Formula:
    """The formula with the constant in place of one of its parts that makes it strongest."""
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
    """The formula with another operand of that number."""
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
# A point that moves from F straight into G is, at the instant of the change, on the boundary of
# both, which no enclosure decides.  That it is in one of them can be decided.


def attained(formula: ir.Formula) -> ir.Formula:
    """The same formula with ``F or G until G`` for ``F until G`` where G is closed.

    If F or G holds up to an instant of G, there is a first instant of G from now on, since those
    instants make a closed set; before it F holds.
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
    """Whether a formula certainly holds on a closed set of instants: regions are closed."""
    if isinstance(formula, ir.And | ir.Or):
        return all(_closed(part) for part in formula.operands)
    return isinstance(formula, ir.Atom)


# --- Formulas as text of the language -------------------------------------------------------------


_TIGHT, _UNTIL, _AND, _OR, _IMPLIES = range(1, 6)
"""How tightly operators bind, as the language reference numbers them."""


def formula_text(formula: ir.Formula) -> str:
    """A formula with no more parentheses than it needs, times in seconds."""
    return _text(formula)[0]


def _within(formula: ir.Formula, level: int) -> str:
    """A formula in a place for operators that bind at least as tightly as ``level``."""
    text, own = _text(formula)
    return text if own <= level else f"({text})"


def _text(formula: ir.Formula) -> tuple[str, int]:
    """A formula and how tightly its operator binds."""
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
        # No text denotes a window that begins later and has no end; this one people understand.
        return "" if window.lower == 0 else f"[{_seconds(window.lower)}, end]"
    return f"[{_seconds(window.lower)}, {_seconds(window.upper)}]"


def _seconds(time: Fraction) -> str:
    """A time as a decimal where it is one, else as a quotient."""
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
