"""Motions and forces in coordinates y with q = D y, as expressions."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from compiler.dynamics.absolute_angles import Coordinates


def own_motion(coordinates: Coordinates, y: ca.SX) -> ca.SX:
    """D y: the joints' own coordinates or rates, shape (n,)."""
    return _stack([_weighed(row, y) for row in coordinates.rows])


def generalised_forces(coordinates: Coordinates, forces: ca.SX) -> ca.SX:
    """D' tau: the forces on the joints' own coordinates by virtual work, shape (n,)."""
    return _stack([_weighed(column, forces) for column in zip(*coordinates.rows, strict=True)])


def _weighed(weights: Sequence[int], values: ca.SX) -> ca.SX:
    """The sum of values with weights 1, 0 and -1."""
    total = ca.SX(0)
    for i, weight in enumerate(weights):
        if weight:
            total = total + (values[i] if weight > 0 else -values[i])
    return total


def _stack(entries: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)
