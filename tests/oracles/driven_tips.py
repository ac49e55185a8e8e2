"""A chain of two rods in motion: its proof along a tube, and where its tips are by scipy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

import numpy as np
import shapely
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import ball, constant_ball
from compiler.expressions.tape import tape
from compiler.robots.robot import WORLD, RobotModel
from compiler.tasks.monitor import AtomKey
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.verifier.proofs.enclosure import Accuracy, TubeSegment, tube
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.point_map import PointMap
from solvers.verifier.proofs.region_distance import region_distance
from solvers.verifier.proofs.vector_field import VectorField
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import Builder
from tests.oracles.tasks import task

F = Fraction
ACCURACY = Accuracy(10, 96, 1e-10)
LENGTHS = (F(13, 10), F(9, 10))
START = (F(3, 10), F(-7, 10), F(4, 5), F(-3, 5))
STEP, STEPS = F(1, 4), 12
PULL = (F(1, 5), F(-1, 2))
FINE = 200
"""Samples per step."""


def model() -> RobotModel:
    """Two joints, each with a rod; the tip is effector 1, the elbow effector 2."""
    builder = Builder()
    elbow = builder.link(builder.joint(WORLD), builder.parameter())
    builder.effector(builder.link(builder.joint(elbow), builder.parameter()))
    builder.effector(elbow)
    return replace(builder.build(), posed=True)


@lru_cache
def inputs(seed: int) -> list[list[Fraction]]:
    rng = np.random.default_rng(seed)
    return [[F(int(x), 100) for x in rng.integers(-120, 120, 2)] for _ in range(STEPS)]


@dataclass(frozen=True)
class Tips:
    """Positions of both effectors at FINE samples per step, shape (n, 2, 2), and the times."""

    times: Array
    points: Array

    def at(self, time: Fraction, effector: int) -> Array:
        return self.points[int(time / STEP * FINE), effector - 1]


@lru_cache
def tips(seed: int) -> Tips:
    state = np.array([float(x) for x in START])
    lengths = np.array([float(x) for x in LENGTHS])
    pull = (float(PULL[0]), float(PULL[1]))
    samples = [state[None, :]]
    for u in inputs(seed):
        torque = np.array([float(x) for x in u])

        def slope(_: float, x: Array, torque: Array = torque) -> Array:
            mass, coriolis, gravity = chain_dynamics(lengths, np.ones(2), x[:2], x[2:], pull)
            right = torque - coriolis - gravity
            return np.concatenate([x[2:], np.linalg.solve(mass, right)])

        inner = np.linspace(0, float(STEP), FINE + 1)
        found = solve_ivp(
            slope, (0, inner[-1]), samples[-1][-1], t_eval=inner, method="DOP853",
            rtol=1e-10, atol=1e-10,
        )  # fmt: skip
        samples.append(found.y.T[1:])
    q = np.concatenate(samples)[:, :2]
    elbow = lengths[0] * np.stack([np.cos(q[:, 0]), np.sin(q[:, 0])], axis=1)
    total = q.sum(axis=1)
    tip = elbow + lengths[1] * np.stack([np.cos(total), np.sin(total)], axis=1)
    times = np.arange(len(q)) * float(STEP) / FINE
    return Tips(times, np.stack([tip, elbow], axis=1))


Corners = Sequence[Sequence[Fraction]]


def tilted_square(centre: Array, size: Fraction) -> Corners:
    """A square whose sides have slopes 3/4 and -4/3, of edge 2 ``size``, near a point."""
    x, y = (F(round(float(c) * 100), 100) for c in centre)
    a, b = size * F(4, 5), size * F(3, 5)
    return [(x + a - b, y + b + a), (x - a - b, y - b + a), (x - a + b, y - b - a),
            (x + a + b, y + b - a)]  # fmt: skip


def polytope(corners: Corners) -> Polytope:
    from compiler.workspaces.polytope import polytope_of

    return polytope_of(ir.Hull(tuple(tuple(corner) for corner in corners)), 2)


def depths(corners: Corners, points: Array) -> Array:
    """The signed distances of points (n, 2) to the boundary, positive inside, by shapely."""
    area = shapely.Polygon([[float(x) for x in corner] for corner in corners])
    where = shapely.points(points)
    distance = shapely.distance(shapely.boundary(area), where)
    inside = shapely.contains_xy(area, points[:, 0], points[:, 1])
    found: Array = np.where(inside, distance, -distance)
    return found


def horizon_task() -> ir.Task:
    return replace(task(), step=STEP, steps=STEPS)


@lru_cache
def segments(seed: int) -> tuple[PointMap, tuple[TubeSegment, ...]]:
    """The tube of a motion, and what turns it into positions."""
    graph = robot_graph(model(), PULL)
    tail = (*(ball(x) for x in LENGTHS), *map(constant_ball, graph.constants))
    field = VectorField(tape(graph.balance), tape(graph.variation), 2, tail)
    torques = [[ball(x) for x in u] for u in inputs(seed)]
    found = tube(field, [ball(x) for x in START], torques, ball(STEP), ACCURACY)
    return PointMap(tape(graph.points), field, 2), tuple(found)


def proof(seed: int, regions: Mapping[AtomKey, Polytope]) -> FormulaProof:
    """The atoms along the tube of a motion; within the working precision of ``ACCURACY``."""
    point_map, tiles = segments(seed)
    distances = {atom: region_distance(shape) for atom, shape in regions.items()}
    found = FormulaProof(point_map, distances, horizon_task())
    for segment in tiles:
        found.add(segment, [ball(x) for x in inputs(seed)[segment.number]])
    return found
