"""The LDL^T factorisation of a symmetric positive definite matrix, written out for a graph."""

from __future__ import annotations

import casadi as ca


def ldl_solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """``matrix^-1 right`` for a right side of one or more columns; reads the lower triangle.

    Elementary operations only, because validated evaluators need them; no pivoting (Golub & Van
    Loan, *Matrix Computations*, Algorithm 4.1.2).
    """
    n = matrix.size1()
    if not n:
        return ca.SX(0, right.size2())
    lower, scaled = ca.SX.eye(n), ca.SX(n, n)
    inverse = []
    for j in range(n):
        # scaled holds L D, so that no product is formed twice.
        pivot = matrix[j, j] - sum((lower[j, k] * scaled[j, k] for k in range(j)), ca.SX(0))
        inverse.append(1 / pivot)
        for i in range(j + 1, n):
            known = sum((lower[i, k] * scaled[j, k] for k in range(j)), ca.SX(0))
            scaled[i, j] = matrix[i, j] - known
            lower[i, j] = scaled[i, j] * inverse[j]
    rows = [right[i, :] for i in range(n)]
    for i in range(n):
        for k in range(i):
            rows[i] = rows[i] - lower[i, k] * rows[k]
    rows = [row * factor for row, factor in zip(rows, inverse, strict=True)]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            rows[i] = rows[i] - lower[k, i] * rows[k]
    return ca.vertcat(*rows)
