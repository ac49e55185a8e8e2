"""Exponentials of many small matrices at once, and the integrals that discretise held inputs."""

from __future__ import annotations

from math import comb, factorial

import numpy as np

from compiler.arrays import Array

DEGREE = 13
LARGEST_NORM = 5.371920351148152
"""Up to here the approximant of degree 13 is exact to double precision (Higham 2005, Table 2.3)."""

PADE = tuple(comb(DEGREE, j) * factorial(2 * DEGREE - j) for j in range(DEGREE + 1))
"""Coefficients of the numerator of the diagonal approximant, up to a common factor."""


def matrix_exponential(matrices: Array) -> Array:
    """The exponentials of K matrices (K, n, n) by scaling, Pade and squaring (Higham 2005)."""
    norms = np.abs(matrices).sum(axis=1).max(axis=1, initial=0.0)
    squarings = np.ceil(np.log2(np.maximum(norms / LARGEST_NORM, 1.0))).astype(int)
    scaled = matrices * (0.5**squarings)[:, None, None]
    coefficients = [c / PADE[0] for c in PADE]
    square, identity = scaled @ scaled, np.eye(matrices.shape[1])
    # Even and odd parts by Horner's rule in the square.
    even, odd = coefficients[-2] * identity, coefficients[-1] * identity
    for j in range(DEGREE - 3, -1, -2):
        even = square @ even + coefficients[j] * identity
        odd = square @ odd + coefficients[j + 1] * identity
    odd = scaled @ odd
    result = np.linalg.solve(even - odd, even + odd)
    for done in range(int(squarings.max(initial=0))):
        more = squarings > done
        result[more] = result[more] @ result[more]
    return np.asarray(result)


def held(state: Array, forcing: Array, time: float) -> tuple[Array, Array]:
    r"""The flow of ``x' = F x + G w`` over a time, w held.

    .. math:: \exp \begin{pmatrix} F & G \\ 0 & 0 \end{pmatrix} t
        = \begin{pmatrix} e^{F t} & \int_0^t e^{F s} \mathrm ds\, G \\ 0 & 1 \end{pmatrix}

    Args:
        state: F, shape (K, N, N), 1/s.
        forcing: G, shape (K, N, c).
        time: t, s.

    Returns:
        e^(F t), shape (K, N, N), and the integral times G, shape (K, N, c) (Van Loan 1978).
    """
    count, size, width = forcing.shape
    augmented = np.zeros((count, size + width, size + width))
    augmented[:, :size, :size] = state * time
    augmented[:, :size, size:] = forcing * time
    exponential = matrix_exponential(augmented)
    return exponential[:, :size, :size], exponential[:, :size, size:]
