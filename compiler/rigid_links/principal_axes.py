"""Principal moments and axes of a symmetric tensor.

Source: Jacobi 1846 (rotations that make one pair of entries after the other zero).
"""

from __future__ import annotations

from flint import arb, arb_mat, ctx

from compiler.rigid_links.ball_pose import identity

PAIRS = ((0, 1), (0, 2), (1, 2))
MOST_SWEEPS = 50
"""Convergence is quadratic: far fewer are needed at any precision."""


def principal_axes(tensor: arb_mat) -> tuple[list[arb], list[arb_mat]]:
    """Three moments, and as many axes (3, 1), orthonormal, both to nearly the working precision.

    Shape (3, 3), symmetric.  A moment is that of the exact tensor about its axis.  A tensor that is
    diagonal has the axes of the frame, exactly.
    """
    work, turned = _middle(tensor), identity()
    size = sum((abs(item) for item in work.entries()), arb(0))
    small = size * arb(2) ** (-(ctx.prec - 16))
    for _ in range(MOST_SWEEPS):
        left = [(i, j) for i, j in PAIRS if abs(work[i, j]) > small]
        if not left:
            break
        for i, j in left:
            turn = _rotation(work, i, j)
            work = _middle(turn.transpose() * work * turn)
            turned = _middle(turned * turn)
    axes = [arb_mat([[turned[i, k]] for i in range(3)]) for k in range(3)]
    moments = [(axis.transpose() * tensor * axis)[0, 0] for axis in axes]
    return moments, axes


def _rotation(work: arb_mat, i: int, j: int) -> arb_mat:
    """The rotation by the smaller angle after which the entry (i, j) is zero."""
    half = (work[j, j] - work[i, i]) / 2
    size = abs(half) + (half**2 + work[i, j] ** 2).sqrt()
    tangent = work[i, j] / size if half >= 0 else -work[i, j] / size
    cosine = 1 / (1 + tangent**2).sqrt()
    sine = tangent * cosine
    turn = identity()
    turn[i, i], turn[j, j], turn[i, j], turn[j, i] = cosine, cosine, sine, -sine
    return turn


def _middle(matrix: arb_mat) -> arb_mat:
    """Without the radii, which would only grow."""
    return arb_mat([[matrix[i, j].mid() for j in range(3)] for i in range(3)])
