"""Arms whose links are hulls in tilted frames, where their corners are, and distances of hulls.

Nothing here is the project's: frames follow one another by matrices, and distances are those of
non-negative least squares.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
from scipy.optimize import nnls

from compiler.expressions.scalars import Constant
from compiler.robots.robot import WORLD, Joint, Offset, RobotModel, Shape, Turn
from tests.oracles.robots import Builder

HEAVY = 1e4
"""The weight of what sums of shares are."""


def hull_gap(one: np.ndarray, two: np.ndarray) -> float:
    """The distance of the hulls of two sets of points (n, d), zero where they meet."""
    rows = [np.concatenate([one.T, -two.T], axis=1)]
    ones = np.zeros((2, len(one) + len(two)))
    ones[0, : len(one)], ones[1, len(one) :] = HEAVY, HEAVY
    right = np.concatenate([np.zeros(one.shape[1]), [HEAVY, HEAVY]])
    shares, _ = nnls(np.concatenate([*rows, ones]), right, maxiter=10_000)
    shares[: len(one)] /= shares[: len(one)].sum()
    shares[len(one) :] /= shares[len(one) :].sum()
    return float(np.linalg.norm(rows[0] @ shares))


def hulled_arm(seed: int, corners: int = 32) -> RobotModel:
    """An arm with a hull or two of at most so many corners on each link, some of few.

    In space, or in the plane where the seed is odd.  Hulls are off the origin of their frame, and
    of no symmetry.  All links that are not next to each other have to stay apart.
    """
    rng = np.random.default_rng(seed)
    builder, links = Builder(3 - seed % 2), list[list[int]]()
    planar = builder.dimension == 2
    frame = WORLD
    for _ in range(int(rng.integers(3, 6))):
        frame = builder.joint(frame, "z" if planar else str(rng.choice([*"xyz"])))
        links.append([])
        for _ in range(int(rng.integers(1, 3))):
            axis = "z" if planar else str(rng.choice([*"xyz"]))
            place = builder.turn(frame, axis, builder.number(Fraction(int(rng.integers(-9, 9)), 7)))
            count = int(rng.integers(1, 5)) if rng.random() < 0.2 else int(rng.integers(5, corners))
            middle = rng.integers(-20, 30, 3)
            found = {tuple(x) for x in (middle + rng.integers(-15, 15, (count, 3))).tolist()}
            if planar:
                found = {(x, y, 0) for x, y, _ in found}
            scaled = [tuple(Fraction(x, 100) for x in each) for each in sorted(found)]
            links[-1].append(len(builder.shapes))
            builder.hull(place, scaled)  # type: ignore[arg-type]
        frame = builder.move(frame, "x", builder.number(Fraction(int(rng.integers(30, 60)), 100)))
    builder.effector(frame)
    apart = [
        (one, two)
        for first, second in combinations(range(len(links)), 2) if second > first + 1
        for one in links[first] for two in links[second]
    ]  # fmt: skip
    return replace(builder.build(), apart=tuple(apart))


def rotation(axis: int, angle: float) -> np.ndarray:
    """About a coordinate axis."""
    found, (i, j) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
    found[i, i] = found[j, j] = np.cos(angle)
    found[i, j], found[j, i] = -np.sin(angle), np.sin(angle)
    return found


def numbers(model: RobotModel) -> list[float]:
    """The scalars of a robot that are numbers."""
    return [float(s.value) if isinstance(s, Constant) else float("nan") for s in model.scalars]


def corners_of(model: RobotModel, q: np.ndarray) -> list[np.ndarray]:
    """The corners (n, d) of each hull of a robot with revolute joints in a pose."""
    values, places = numbers(model), [(np.zeros(3), np.eye(3))]
    for node in model.frames[1:]:
        origin, turned = places[node.parent]
        match node.step:
            case Turn(axis, angle):
                turned = turned @ rotation(axis, values[angle])
            case Offset(vector):
                origin = origin + turned @ np.array([values[i] for i in vector])
            case Joint(dof, axis, sign):
                turned = turned @ rotation(axis, sign * q[dof])
        places.append((origin, turned))
    return [_corners(shape, values, *places[shape.frame])[:, : model.dimension]
            for shape in model.shapes]  # fmt: skip


def _corners(
    shape: Shape, values: list[float], origin: np.ndarray, turned: np.ndarray
) -> np.ndarray:
    local = np.array([[values[i] for i in corner] for corner in shape.corners])
    found: np.ndarray = origin + local @ turned.T
    return found
