"""Principal moments and axes, against LAPACK and by algebra."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import working_precision
from compiler.rigid_links.mass_moments import principal_axes
from compiler.rigid_links.rigid_tree import PRECISION


@pytest.mark.parametrize("moments", [(1, 2, 3), (0, 5, 5), (2, 2, 2), (1e-20, 1, 1e20), (7, 7, 1)])
def test_moments_and_axes_give_the_tensor_back(moments: tuple[float, ...]) -> None:
    turn = np.linalg.qr(np.array([[1.0, 2, 3], [-2, 1, 1], [0, 1, -4]]))[0]
    given = turn @ np.diag(moments) @ turn.T
    given = (given + given.T) / 2
    with working_precision(PRECISION):
        tensor = arb_mat([[arb(float(given[i, j])) for j in range(3)] for i in range(3)])
        found, axes = principal_axes(tensor)
        rest = tensor * 1
        for moment, axis in zip(found, axes, strict=True):
            rest -= axis * axis.transpose() * moment
        size = max(moments)
        assert all(abs(item) < 1e-70 * size for item in rest.entries())
        for i, one in enumerate(axes):
            for j, other in enumerate(axes):
                assert abs((one.transpose() * other)[0, 0] - int(i == j)) < 1e-70
    expected = np.linalg.eigvalsh(given)
    np.testing.assert_allclose(sorted(map(float, found)), expected, rtol=0, atol=1e-14 * size)


def test_a_diagonal_tensor_keeps_its_axes() -> None:
    with working_precision(PRECISION):
        for diagonal in ((3, 1, 2), (0, 0, 0)):
            tensor = arb_mat(
                [[value * (i == j) for j in range(3)] for i, value in enumerate(diagonal)]
            )
            found, axes = principal_axes(tensor)
            assert [int(float(item)) for item in found] == list(diagonal)
            for i, axis in enumerate(axes):
                assert [int(float(item)) for item in axis.entries()] == [
                    int(i == k) for k in range(3)
                ]
