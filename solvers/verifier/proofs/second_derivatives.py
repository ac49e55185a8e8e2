r"""Second derivatives of the equations of motion near a path, enclosed.

.. math::
    F(p + z) = F(p) + DF(p)\,z + \int_0^1 (1 - h)\, z^T H(p + h z)\,z\,dh,

so the mean of H with weights 2 (1 - h) is needed, most of which is near the path.  It is enclosed
by the mean value theorem, or, without third derivatives, part by part of 0 <= h <= 1. Natural
enclosures of H would be several times as wide if squares of sines and cosines cancel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import (
    SIGNS,
    UncertainSignError,
    absolute,
)
from solvers.verifier.proofs.a_priori import Drive
from solvers.verifier.proofs.path import Expansion
from solvers.verifier.proofs.vector_field import Curvature, VectorField

PARTS = 8
"""The number of parts, from the path to a solution, on which second derivatives are enclosed."""


@dataclass(frozen=True, slots=True)
class Hessian:
    """The midpoints of H_i (N, N), exact, and bounds of the distance from them."""

    middle: Array
    radii: arb_mat

    @staticmethod
    def of(matrix: arb_mat) -> Hessian:
        """The Hessian given by a matrix of balls."""
        shape = matrix.nrows(), matrix.ncols()
        middle = np.array([float(item) for item in matrix.mid().entries()]).reshape(shape)
        return Hessian(middle, absolute(matrix - exact_matrix(middle)))


def exact_matrix(matrix: Array) -> arb_mat:
    """A matrix of floats (h, w)."""
    height, width = matrix.shape
    return arb_mat(height, width, matrix.ravel().tolist())


def hessians_about(
    field: VectorField, curvature: Curvature, drive: Drive, about: Expansion, most: Sequence[arb]
) -> list[Hessian] | None:
    """The Hessians of F ``about`` a path, for z within ``most`` (N,); None if F is not smooth."""
    n, side = field.dofs, field.size + field.dofs
    over, inputs = about.entries, drive.all
    still = [entry[0] for entry in over]
    still += [entry[1] if len(entry) > 1 else arb(0) for entry in over[n : 2 * n]]
    try:
        if field.has_kinks:
            # At a jump of a slope there is no second derivative, whatever that of the graph says.
            z = [x + SIGNS * r for x, r in zip(still, most, strict=True)]
            field.smooth_values(field.balance, z[: field.size], inputs)
        means = mean_derivatives(field, curvature, still, inputs, most)
    except UncertainSignError:
        return None
    if not all(value.is_finite() for value in means):
        return None
    found = [[arb(0)] * (side * side) for _ in range(n + field.own)]
    for (i, j, k), value in zip(curvature.places, means, strict=True):
        found[i][j * side + k] = found[i][k * side + j] = value
    return [Hessian.of(arb_mat(side, side, entries)) for entries in found]


def mean_derivatives(
    field: VectorField,
    curvature: Curvature,
    still: Sequence[arb],
    inputs: Sequence[arb],
    most: Sequence[arb],
) -> list[arb]:
    """Enclosures of the means of second derivatives between points and those z away.

    Args:
        field: the equations of motion.
        curvature: the derivatives.
        still: the points (N,).
        inputs: the inputs (m,).
        most: bounds of |z| (N,).

    Raises:
        UncertainSignError: an absolute value has its kink there.
    """
    if curvature.slopes is not None:
        # |H(p + h z) - H(p)| <= h |slopes| |z|, and the mean of h is a third.
        z = [x + SIGNS * r for x, r in zip(still, most, strict=True)]
        near = field.smooth_values(curvature.tape, still, inputs)
        off = [arb(0)] * len(near)
        slopes = field.smooth_values(curvature.slopes, z, inputs)
        for (value, entry), slope in zip(curvature.slope_places, slopes, strict=True):
            off[value] = off[value] + slope.abs_upper() * most[entry]
        return [x + SIGNS * (r / 3).upper() for x, r in zip(near, off, strict=True)]
    means = [arb(0)] * len(curvature.places)
    for part in range(PARTS):
        share = SIGNS * (arb(part + 1) / PARTS)
        z = [x + share * r for x, r in zip(still, most, strict=True)]
        values = field.smooth_values(curvature.tape, z, inputs)
        # Twice the integral of 1 - h over the part.
        weight = arb(2 * (PARTS - part) - 1) / PARTS**2
        means = [m + weight * v for m, v in zip(means, values, strict=True)]
    return means
