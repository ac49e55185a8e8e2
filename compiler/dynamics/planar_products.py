r"""Scalar products of the columns of a planar Jacobian, in absolute angles, with few sines.

In absolute angles a column is a vector turned by one angle at most, J_i = R(y_a) w_i, so that

.. math:: J_i \cdot J_j = w_i \cdot R(y_b - y_a)\, w_j

Left to itself a product has the sum of two squares of sines and cosines where there is a one, and a
sum of products where there is one cosine: over a box of angles, intervals lose all of that.
"""

from __future__ import annotations

from collections import Counter

import casadi as ca

from compiler.dynamics.absolute_angles import Coordinates
from compiler.robots.robot import Joint, RobotModel, Turn

NORMAL = 2
"""The axis that is normal to the plane."""


def has_turned_columns(model: RobotModel, coordinates: Coordinates) -> bool:
    """Whether all columns are such: in the plane, no coordinate moves two frames, none is flipped.

    A turn about another axis than the plane's would change the sense in which angles count.
    """
    steps = [node.step for node in model.frames]
    uses = Counter(step.dof for step in steps if isinstance(step, Joint))
    turning = {i for i, dof in enumerate(model.dofs) if dof.kind == "revolute"}
    upright = all(
        step.axis == NORMAL
        for step in steps
        if isinstance(step, Turn) or (isinstance(step, Joint) and step.dof in turning)
    )
    alone = all(count == 1 for count in uses.values())
    return model.dimension == 2 and upright and alone and turning <= coordinates.absolute


def planar_products(columns: ca.SX, y: ca.SX, absolute: frozenset[int]) -> ca.SX:
    """The matrix of all products of two columns, shape (n, n); ``columns`` is (2, n)."""
    n = columns.size2()
    angles = [_angle(columns[:, i], y, absolute) for i in range(n)]
    found = ca.SX.zeros(n, n)
    for i in range(n):
        for j in range(i, n):
            product = ca.dot(columns[:, i], columns[:, j])
            found[i, j] = found[j, i] = _relative(product, y, angles[i], angles[j])
    return found


def _angle(column: ca.SX, y: ca.SX, absolute: frozenset[int]) -> int | None:
    """The angle by which a column is turned; None for one that stays as it is."""
    turned = [number for number in sorted(absolute) if ca.depends_on(column, y[number])]
    return turned[0] if turned else None


def _relative(product: ca.SX, y: ca.SX, first: int | None, second: int | None) -> ca.SX:
    """The product of two columns as the angle between them says."""
    if first is None or second is None:
        return product
    if first == second:
        return ca.substitute(product, y[first], ca.SX(0))
    between = y[second] - y[first]
    return ca.substitute(product, ca.vertcat(y[first], y[second]), ca.vertcat(0, between))
