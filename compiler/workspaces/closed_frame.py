"""A closed frame as a rational rotation and a rational shift, with bounds on their errors.

A rotation is a unit quaternion; an integer quaternion gives a rational matrix (Euler, Rodrigues).
The quaternion is computed in ball arithmetic and rounded; the difference of the matrices bounds the
error.  Rotations with rational sines and cosines are exact.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TypeAlias, TypeVar

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, working_precision
from compiler.workspaces.hull import Point
from grammar_lang import ir
from grammar_lang.ir import constants

BITS = 40
"""The binary digits of the entries of a quaternion; those of a shift have more after the point."""
SHIFT_BITS = 60
PRECISION = 320

Matrix: TypeAlias = tuple[Point, ...]
Number = TypeVar("Number", arb, Fraction)

_IDENTITY: Matrix = (
    (Fraction(1), Fraction(0), Fraction(0)),
    (Fraction(0), Fraction(1), Fraction(0)),
    (Fraction(0), Fraction(0), Fraction(1)),
)
_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True, slots=True)
class RationalFrame:
    """``p -> rotation p + shift`` (metres).

    The image of a point at distance d from the origin differs by less than ``turned * d + moved``
    from its image under the exact frame.
    """

    rotation: Matrix
    shift: Point
    turned: Fraction = Fraction(0)
    moved: Fraction = Fraction(0)

    def apply(self, point: Sequence[Fraction]) -> Point:
        """The image of a point."""
        turned = self.direction(point)
        return tuple(a + b for a, b in zip(turned, self.shift, strict=True))

    def direction(self, vector: Sequence[Fraction]) -> Point:
        """The image of a vector, or of a normal."""
        return tuple(_dot(row, vector) for row in self.rotation)


def rational_frame(frame: ir.Expr) -> RationalFrame:
    """The rational frame of a product of closed rotations and translations, from the world inwards.

    Raises:
        ValueError: the frame is not closed.
    """
    return _exact(frame) or _rounded(frame)


def _exact(frame: ir.Expr) -> RationalFrame | None:
    """The exact frame, if all of it is evidently rational."""
    rotation = _IDENTITY
    shift: Point = (Fraction(0),) * 3
    for step in ir.factors(frame):
        if isinstance(step, ir.Rot):
            turn = _exact_turn(step)
            if turn is None:
                return None
            rotation = _times(rotation, turn)
            continue
        amounts = [constants.rational(amount) for amount in _moved(step)]
        known = [amount for amount in amounts if amount is not None]
        if len(known) < len(amounts):
            return None
        shift = tuple(a + _dot(row, known) for a, row in zip(shift, rotation, strict=True))
    return RationalFrame(rotation, shift)


def _exact_turn(step: ir.Rot) -> Matrix | None:
    cosine, sine = (
        constants.rational(ir.Unary(function, step.angle)) for function in ("cos", "sin")
    )
    if cosine is None or sine is None:
        return None
    sine = -sine if step.axis.startswith("-") else sine
    along = _AXES[step.axis[-1]]
    one, other = (along + 1) % 3, (along + 2) % 3
    rows = [list(row) for row in _IDENTITY]
    rows[one][one] = rows[other][other] = cosine
    rows[one][other], rows[other][one] = -sine, sine
    return tuple(tuple(row) for row in rows)


def _moved(step: ir.Expr) -> tuple[ir.Expr, ir.Expr, ir.Expr]:
    """The vector by which a step moves."""
    zero = ir.Num(Fraction(0))
    match step:
        case ir.Move(axis=axis, distance=distance):
            signed = ir.Unary("neg", distance) if axis.startswith("-") else distance
            x, y, z = (signed if place == axis[-1] else zero for place in _AXES)
            return x, y, z
        case ir.Shift(vector=ir.Vector(x=x, y=y, z=z)):
            return x, y, z
        case ir.World():
            return zero, zero, zero
        case _:
            raise ValueError("the frame is no product of closed turns and moves")


# --- Ball arithmetic ------------------------------------------------------------------------------


def _rounded(frame: ir.Expr) -> RationalFrame:
    with working_precision(PRECISION):
        quaternion, shift = [arb(1), arb(0), arb(0), arb(0)], [arb(0)] * 3
        for step in ir.factors(frame):
            if isinstance(step, ir.Rot):
                quaternion = _composed(quaternion, _turn(step))
                continue
            vector = [closed_ball(amount) for amount in _moved(step)]
            rows = _matrix(quaternion, arb(1))
            shift = [a + _ball_dot(row, vector) for a, row in zip(shift, rows, strict=True)]
        near = [_nearest(entry, BITS) for entry in quaternion]
        square = sum((entry * entry for entry in near), Fraction(0))
        rotation = _matrix(near, square)
        place = tuple(_nearest(entry, SHIFT_BITS) for entry in shift)
        meant = _matrix(quaternion, arb(1))
        turned = _length(meant[i][j] - ball(rotation[i][j]) for i, j in product(range(3), repeat=2))
        moved = _length(a - ball(b) for a, b in zip(shift, place, strict=True))
    return RationalFrame(rotation, place, turned, moved)


def _turn(step: ir.Rot) -> list[arb]:
    half = closed_ball(step.angle) / 2
    sine = -half.sin() if step.axis.startswith("-") else half.sin()
    found = [half.cos(), arb(0), arb(0), arb(0)]
    found[1 + _AXES[step.axis[-1]]] = sine
    return found


def _composed(first: Sequence[arb], second: Sequence[arb]) -> list[arb]:
    """The product of two quaternions."""
    a, b, c, d = first
    w, x, y, z = second
    return [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]


def _matrix(quaternion: Sequence[Number], square: Number) -> tuple[tuple[Number, ...], ...]:
    """The rotation matrix of a quaternion with the given square of its length."""
    w, x, y, z = quaternion
    return (
        _row(square, w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        _row(square, 2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        _row(square, 2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )


def _row(square: Number, *entries: Number) -> tuple[Number, ...]:
    return tuple(entry / square for entry in entries)


def _nearest(value: arb, bits: int) -> Fraction:
    """A rational with ``bits`` binary digits after the point, near the middle of a ball."""
    whole = (value.mid() * 2**bits).floor().unique_fmpz()
    if whole is None:
        raise ArithmeticError("the enclosure of a frame is too wide")
    return Fraction(int(whole), 2**bits)


def _length(entries: Iterable[arb]) -> Fraction:
    """A rational upper bound on the length of every vector in balls."""
    square = arb(0)
    for entry in entries:
        square += entry * entry
    scale = 2 ** (2 * SHIFT_BITS)
    upper = (square.upper().sqrt() * scale).upper().ceil().unique_fmpz()
    if upper is None:
        raise ArithmeticError("the enclosure of a frame is too wide")
    return Fraction(int(upper), scale)


def _dot(row: Sequence[Fraction], vector: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(row, vector, strict=True)), Fraction(0))


def _ball_dot(row: Sequence[arb], vector: Sequence[arb]) -> arb:
    total = arb(0)
    for a, b in zip(row, vector, strict=True):
        total += a * b
    return total


def _times(left: Matrix, right: Matrix) -> Matrix:
    columns = tuple(zip(*right, strict=True))
    return tuple(tuple(_dot(row, column) for column in columns) for row in left)
