"""Matrices of balls, entry by entry."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat

SIGNS = arb(0, 1)
"""The ball [-1, 1]."""


def column(entries: Sequence[arb]) -> arb_mat:
    """A matrix of one column."""
    return arb_mat(len(entries), 1, list(entries))


def column_of_ones(size: int) -> arb_mat:
    """What adds up the columns of a matrix."""
    return arb_mat(size, 1, [arb(1)] * size)


def identity(size: int) -> arb_mat:
    """The unit matrix."""
    return arb_mat([[arb(int(i == j)) for j in range(size)] for i in range(size)])


def absolute(matrix: arb_mat) -> arb_mat:
    """Exact upper bounds of the absolute values of the entries."""
    entries = [abs(item).upper() for item in matrix.entries()]
    return arb_mat(matrix.nrows(), matrix.ncols(), entries)


def both_signs(bounds: arb_mat) -> arb_mat:
    """All matrices whose entries are within bounds."""
    entries = [SIGNS * item for item in bounds.entries()]
    return arb_mat(bounds.nrows(), bounds.ncols(), entries)


def rows(matrix: arb_mat, first: int, last: int) -> arb_mat:
    """The rows first ... last - 1."""
    width = matrix.ncols()
    return arb_mat(last - first, width, matrix.entries()[first * width : last * width])


def stacked(upper: arb_mat, lower: arb_mat) -> arb_mat:
    """One matrix above another."""
    height = upper.nrows() + lower.nrows()
    return arb_mat(height, upper.ncols(), upper.entries() + lower.entries())
