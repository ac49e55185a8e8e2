r"""Bound how far a computer's evaluation of a controller's law is from the law.

In a binary format with p bits, a number z that is read, or that is the exact result of an
operation, is rounded with an error of at most :math:`2^{-p} |z| + \eta`.  Here :math:`\eta` is the
least number with full precision, so smaller numbers may be flushed to zero.  The errors are
propagated in balls along the operations of ``controller_code.py``, in their order.

Source: Higham, *Accuracy and Stability of Numerical Algorithms* (2002), sections 2.2 and 3.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball, working_precision
from solvers.verifier.claims.certificate import exact
from srgc.exports.exported_controller import ExportedController, literal

BITS = 64
"""The precision of the balls: what they add to a bound is far below the rounding of doubles."""


@dataclass(frozen=True, slots=True)
class Precision:
    """A binary format of IEEE 754 with its name in C and ``bits`` significant bits.

    Constants end in ``suffix``.  Numbers are below 2^``exponent``; from 2^(2 - ``exponent``) on
    they have full precision.
    """

    name: str
    suffix: str
    bits: int
    exponent: int


DOUBLE = Precision("double", "", 53, 1024)
SINGLE = Precision("float", "f", 24, 128)


@dataclass(frozen=True, slots=True)
class _Rounded:
    """Bounds on the size of a number as computed, and on its distance from the exact one."""

    size: arb
    error: arb


@dataclass(frozen=True, slots=True)
class _Rounding:
    """The rounding of a precision."""

    unit: arb
    least: arb

    def of(self, size: arb, error: arb) -> _Rounded:
        """Round numbers up to ``size`` with errors up to ``error``."""
        added = (self.unit * size + self.least).upper()
        return _Rounded((size + added).upper(), (error + added).upper())

    def constant(self, text: str) -> _Rounded:
        """A number of the certificate, written as a decimal and read as the nearest number."""
        value, written = exact(text), Fraction(literal(text))
        return self.of(abs(ball(written)).upper(), ball(abs(written - value)).upper())


def rounding_bounds(
    controller: ExportedController,
    measured: Sequence[Sequence[arb]],
    precision: Precision,
    turns: int = 0,
) -> list[arb]:
    """Bounds on how far each held input (m,) may be from the law, in its unit.

    Args:
        controller: the law, with its gains.
        measured: all possible measurements (2n,) at each sample, as balls; the program gets the
            nearest numbers of the precision.
        precision: the precision of all constants and operations.
        turns: up to how many whole turns away winding coordinates may be given.

    Raises:
        ValueError: the controller has no gains.
    """
    claim = controller.design.claim.controller
    if claim is None:
        raise ValueError("there are no gains")
    with working_precision(BITS):
        two = arb(2)
        rounding = _Rounding(two**-precision.bits, two ** (2 - precision.exponent))
        largest = two ** (precision.exponent - 1)
        found, loads = [arb(0)] * len(controller.inputs), controller.loads
        rows = zip(
            controller.design.claim.inputs, claim.reference, claim.gains, measured[:-1], strict=True
        )
        for planned, reference, gains, states in rows:
            off = [
                _deviation(rounding, x, text, turns if number in controller.winding else 0)
                for number, (x, text) in enumerate(zip(states, reference, strict=True))
            ]
            for i, (text, row) in enumerate(zip(planned, gains, strict=True)):
                if i in loads:
                    continue
                held = _held(rounding, text, row, off, largest)
                found[i] = found[i].max(held)
        return found


@dataclass(frozen=True, slots=True)
class _Deviation:
    """A measured quantity less its reference, as computed; ``true`` bounds the exact value."""

    computed: _Rounded
    true: arb
    read: arb


def _deviation(rounding: _Rounding, measured: arb, text: str, turns: int) -> _Deviation:
    """The deviation of an angle given up to ``turns`` whole turns away, which are removed.

    If the number of turns may be determined wrongly, the error is infinite.
    """
    # The program accepts anything less than one turn more.
    farther = 2 * arb.pi() * (turns + 1) if turns else arb(0)
    read, planned = rounding.of((abs(measured) + farther).upper(), arb(0)), rounding.constant(text)
    true = abs(measured - ball(exact(text))).upper()
    error = read.error + planned.error
    computed = rounding.of((true + farther + error).upper(), error)
    if turns:
        # The number of turns is rounded three times, 2 pi once, and so is their product.
        unsure = (computed.error + 4 * rounding.unit * (farther + arb.pi())).upper()
        if not bool(true + unsure < arb.pi()):
            unsure = arb("inf")
        computed = rounding.of((true + unsure).upper(), unsure)
    return _Deviation(computed, true, read.size.max(planned.size))


def _held(
    rounding: _Rounding, text: str, row: Sequence[str], off: Sequence[_Deviation], largest: arb
) -> arb:
    """The error of one input; infinite if a number may exceed the range of the precision."""
    held = rounding.constant(text)
    most = held.size
    for gain_text, each in zip(row, off, strict=True):
        gain = rounding.constant(gain_text)
        product = rounding.of(
            (gain.size * each.computed.size).upper(),
            (gain.size * each.computed.error + gain.error * each.true).upper(),
        )
        held = rounding.of(held.size + product.size, held.error + product.error)
        most = most.max(held.size).max(each.computed.size).max(each.read).max(gain.size)
    return held.error if bool(most < largest) else arb("inf")
