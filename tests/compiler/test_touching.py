"""Bodies that touch at all poses of a box: against kinematics by hand and bounded least squares."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.evaluators.intervals import between
from compiler.robots.robot import WORLD, RobotModel
from compiler.unreachability.enclosed_points import PointTapes
from compiler.unreachability.motion_conditions import motion_conditions
from compiler.unreachability.touching import Touching, nearest_shares
from grammar_lang import ir
from tests.oracles.robots import Builder, interval
from tests.oracles.tasks import task as plain_task

F = Fraction
LENGTHS = (F(13, 10), F(3, 10), F(9, 10))
AXES = {2: "zzz", 3: "zyz"}
RADII = {"rod": F(1, 20), "capsule": F(1, 10), "sphere": F(1, 10)}
MARGIN = F(1, 50)


def arm(dimension: int, kinds: tuple[str, str]) -> RobotModel:
    """Three joints with links of known lengths; the first link and the last one keep apart."""
    builder = Builder(dimension)
    frame = WORLD
    for i, axis in enumerate(AXES[dimension]):
        frame = builder.joint(frame, axis, range_=interval(-3, 3))
        if i != 1:
            body(builder, frame, kinds[i // 2], LENGTHS[i])
        frame = builder.move(frame, "x", builder.number(LENGTHS[i]))
    builder.effector(frame)
    return replace(builder.build(), apart=((0, 1),))


def body(builder: Builder, frame: int, kind: str, length: Fraction) -> None:
    size, radius = builder.number(length), builder.number(RADII[kind])
    match kind:
        case "rod":
            builder.rod(frame, "x", size)
            builder.bodies[-1] = replace(builder.bodies[-1], radius=radius)
        case "capsule":
            builder.shape(frame, "capsule", (size, radius))
        case _:
            builder.shape(frame, "sphere", (radius,))


def turned(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    found = np.eye(3)
    found[i, i] = found[j, j] = c
    found[i, j], found[j, i] = -s, s
    return found


def distance(dimension: int, kinds: tuple[str, str], q: np.ndarray) -> float:
    """Of the axes of the first and the last body, by bounded least squares."""
    at, way, ends = np.zeros(3), np.eye(3), []
    for i, axis in enumerate(AXES[dimension]):
        way = way @ turned(axis, q[i])
        ends.append((at, way[:, 0] * float(LENGTHS[i])))
        at = at + ends[-1][1]
    (one, along), (two, beside) = ends[0], ends[2]
    sides = [way_ * (kind != "sphere") for way_, kind in zip((along, beside), kinds, strict=True)]
    matrix = np.stack([sides[0], -sides[1]], axis=1)
    found = lsq_linear(matrix, two - one, bounds=(0, 1), method="bvls")
    return float(np.linalg.norm(matrix @ found.x - (two - one)))


def touching(dimension: int, kinds: tuple[str, str]) -> tuple[RobotModel, Touching]:
    model = arm(dimension, kinds)
    place = ir.Region("Bounds", "bounds", ir.Inequalities(()))
    workspace = ir.Workspace("W", 2 if dimension == 2 else 3, place, (region(dimension),))
    task = replace(plain_task(start="T"), avoid_self=ir.AvoidSelf(MARGIN, frozenset()))
    (pair,) = motion_conditions(model, workspace, task).pairs
    return model, Touching(pair.points, pair.counts, pair.apart)


def region(dimension: int) -> ir.Region:
    rows = tuple(
        ir.HalfSpace(tuple(F(sign * (i == j)) for j in range(dimension)), F(9))
        for i in range(dimension)
        for sign in (-1, 1)
    )
    return ir.Region("T", "target", ir.Inequalities(rows))


CASES = [(2, ("rod", "rod")), (3, ("capsule", "rod")), (3, ("rod", "sphere"))]


@pytest.mark.parametrize(("dimension", "kinds"), CASES)
def test_what_is_certain_is_so_at_every_pose(dimension: int, kinds: tuple[str, str]) -> None:
    """Random boxes: of those that are certain every pose is too near; small ones are decided."""
    model, violation = touching(dimension, kinds)
    apart = float(RADII[kinds[0]] + RADII[kinds[1]] + MARGIN)
    assert float(violation.apart) == pytest.approx(apart, rel=1e-15)
    rng, seen = np.random.default_rng(dimension), {True: 0, False: 0}
    with working_precision(64):
        tapes = PointTapes(model)
        for number in range(600):
            middle = [F(int(x), 1000) for x in rng.integers(-2900, 2900, 3)]
            if dimension == 3:
                # Folded back, as few arms in space are by chance.
                middle[1:] = [F(int(x), 1000) for x in rng.integers((1400, -500), (2900, 500))]
            half = F(int(rng.integers(1, 60 if number % 2 else 5)), 1000)
            turn = [1000 * half if i == 0 else half for i in range(3)]
            # The first joint moves both alike, so that it may turn as far as it can.
            box = [between(m - h, m + h) for m, h in zip(middle, turn, strict=True)]
            certain = violation.certain(tapes.over(box))
            at = np.array([float(m) for m in middle])
            offs = rng.uniform(-1, 1, (4, 3)) * [float(h) for h in turn]
            corners = np.array(list(product((-1, 1), repeat=3))) * [float(h) for h in turn]
            if certain:
                assert all(distance(dimension, kinds, at + o) < apart for o in (*offs, *corners))
            elif half < F(5, 1000):
                crossing = dimension == 2 and distance(dimension, kinds, at) < 1e-9
                assert crossing or distance(dimension, kinds, at) > apart - 0.03
            seen[certain] += 1
    assert min(seen.values()) >= 10, seen


def test_a_crossing_in_the_plane_needs_no_radius() -> None:
    model, violation = touching(2, ("rod", "rod"))
    thin = replace(violation, apart=F(0))
    with working_precision(64):
        tapes = PointTapes(model)
        # The third link comes back across the first: a triangle that is overshot.
        folded = [F(0), F(22, 10), F(24, 10)]
        box = [between(m - F(1, 50), m + F(1, 50)) for m in folded]
        assert distance(2, ("rod", "rod"), np.array([float(m) for m in folded])) < 1e-9
        assert thin.certain(tapes.over(box))
        straight = [between(m - F(1, 50), m + F(1, 50)) for m in (F(0), F(1, 2), F(1, 2))]
        assert not thin.certain(tapes.over(straight))


def test_the_nearest_places_of_two_segments() -> None:
    rng = np.random.default_rng(5)
    for dimension in (2, 3):
        for _ in range(200):
            corner, one, two = rng.normal(size=(3, dimension))
            if rng.random() < 0.2:
                two = one * rng.normal()
            first, second = nearest_shares(corner[None], (one[None], two[None]))[0]
            matrix = np.stack([one, two], axis=1)
            best = lsq_linear(matrix, -corner, bounds=(0, 1), method="bvls")
            found = np.linalg.norm(corner + first * one + second * two)
            assert 0 <= first <= 1
            assert 0 <= second <= 1
            assert found == pytest.approx(np.linalg.norm(matrix @ best.x + corner), abs=1e-6)
