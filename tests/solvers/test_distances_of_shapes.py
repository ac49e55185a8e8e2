"""Distances between shapes of random robots, against bounded least squares and MuJoCo.

A sphere, capsule or box is all of ``c + sum(s_i x_i)`` with bounds of the s_i, and a radius: the
distance of two is a bounded least squares problem.  Places of frames come from the robot's
kinematics, which is tested elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import mujoco
import numpy as np
import pytest
from scipy.optimize import lsq_linear

from compiler.arrays import Array
from compiler.discretisation.hull_distance import nearest_to_zero
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.discretisation.spanning_points import OFF
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.bodies_apart import bodies_apart
from compiler.robots.robot import WORLD, RobotModel, Shape
from grammar_lang import ir
from tests.oracles.robots import Builder

KINDS: list[ir.ShapeKind] = ["sphere", "capsule", "box", "cylinder"]


def random_arm(seed: int, kinds: list[ir.ShapeKind]) -> tuple[RobotModel, list[int]]:
    """An arm with a shape or two on each link, and the frames of these, which are effectors, too.

    It has three to six joints in space, or in the plane where the seed is odd; some branch.
    """
    rng = np.random.default_rng(seed)
    builder = Builder(3 - seed % 2)
    joints, frame, frames = int(rng.integers(3, 7)), WORLD, list[int]()

    def size(low: int, high: int) -> int:
        return builder.number(Fraction(int(rng.integers(low, high)), 100))

    for number in range(joints):
        if seed % 4 > 1 and number == joints // 2:
            frame = frames[len(frames) // 2]
        frame = builder.joint(frame, "z" if builder.dimension == 2 else str(rng.choice([*"xyz"])))
        for _ in range(int(rng.integers(1, 3))):
            kind = kinds[int(rng.integers(len(kinds)))]
            place = builder.move(frame, "y", size(-20, 20))
            place = builder.turn(place, "z", builder.number(Fraction(int(rng.integers(-3, 4)), 2)))
            length, radius = size(5, 60), size(2, 15)
            if kind == "box":
                sizes = [size(3, 50) for _ in range(builder.dimension)]
            else:
                sizes = [radius] if kind == "sphere" else [length, radius]
            builder.shape(place, kind, sizes, str(rng.choice(["x", "-y"])))
            frames.append(place)
        frame = builder.move(frame, "x", size(20, 70))
    for each in frames:
        builder.effector(each)
    return builder.build(), frames


@dataclass(frozen=True)
class Set:
    """All of c + sum(s_i x_i) with bounds of s, (d,), (d, k), (k, 2), and a radius."""

    middle: Array
    columns: Array
    bounds: Array
    radius: float

    @staticmethod
    def of(shape: Shape, sizes: list[float], origin: Array, axes: Array) -> Set:
        """A shape whose frame has these axes, (d, d) by columns."""
        d = len(origin)
        if shape.kind == "sphere":
            return Set(origin, np.zeros((d, 0)), np.zeros((0, 2)), sizes[0])
        if shape.kind == "capsule":
            along = shape.sign * axes[:, [shape.axis]]
            return Set(origin, along, np.array([[0.0, sizes[0]]]), sizes[1])
        if shape.kind == "box":
            halves = np.array(sizes) / 2
            return Set(origin, axes, np.stack([-halves, halves], axis=1), 0.0)
        # In the plane a cylinder is a rectangle.
        across = axes[:, [1 - shape.axis]]
        columns = np.concatenate([shape.sign * axes[:, [shape.axis]], across], axis=1)
        return Set(origin, columns, np.array([[0, sizes[0]], [-sizes[1], sizes[1]]]), 0.0)


def distance(one: Set, two: Set) -> float:
    columns = np.concatenate([one.columns, -two.columns], axis=1)
    apart = two.middle - one.middle
    if not columns.size:
        return float(np.linalg.norm(apart)) - one.radius - two.radius
    bounds = np.concatenate([one.bounds, two.bounds]).T
    found = lsq_linear(columns, apart, bounds, method="bvls", tol=1e-15)
    return float(np.linalg.norm(columns @ found.x - apart)) - one.radius - two.radius


class Posed:
    """A random arm in random poses: what we say of the pairs that have to stay apart, (K, p)."""

    def __init__(self, seed: int, kinds: list[ir.ShapeKind], count: int) -> None:
        model, self.frames = random_arm(seed, kinds)
        apart = bodies_apart(model, ir.AvoidSelf(Fraction(0)))
        self.model = replace(model, apart=apart)
        numeric = NumericRobot(robot_graph(self.model))
        q = np.random.default_rng(100 + seed).uniform(-np.pi, np.pi, size=(count, numeric.n))
        first = len(model.effectors)
        self.points = numeric.positions(q, np.zeros(0))
        self.origins = self.points[:, :first]
        # The axes of frames, by effectors a metre along each of them.
        self.axes = np.stack(
            [NumericRobot(robot_graph(moved(model, axis))).positions(q, np.zeros(0))[:, :first]
             - self.origins for axis in range(model.dimension)], axis=3,
        )  # fmt: skip
        ours = []
        for (one, two), gap in zip(apart, numeric.spanning.gaps, strict=True):
            hulls = self.points[:, [first + i for i in gap]]
            ours.append(
                np.linalg.norm(nearest_to_zero(hulls), axis=1) - self.radius(one) - self.radius(two)
            )
        self.ours = np.stack(ours, axis=1) if ours else np.zeros((count, 0))

    def sizes(self, number: int) -> list[float]:
        """The numbers of a shape."""
        nodes = self.model.scalars
        return [float(nodes[i].value) for i in self.model.shapes[number].sizes]  # type: ignore[union-attr]

    def radius(self, number: int) -> float:
        shape = self.model.shapes[number]
        return 0.0 if shape.radius is None else self.sizes(number)[-1]

    def set(self, number: int, pose: int) -> Set:
        shape = self.model.shapes[number]
        place = self.origins[pose, number], self.axes[pose, number]
        return Set.of(shape, self.sizes(number), *place)


def moved(model: RobotModel, axis: int) -> RobotModel:
    """The robot with its effectors a metre along an axis of their frames."""
    builder = Builder(model.dimension)
    for node in model.scalars:
        builder.table.add(node)
    builder.frames, builder.dofs = list(model.frames), list(model.dofs)
    for frame in model.effectors:
        builder.effector(builder.move(frame, "xyz"[axis], builder.number(1)))
    return builder.build()


@pytest.mark.parametrize("seed", range(12))
def test_exact_sets(seed: int) -> None:
    """Spheres, capsules and boxes, and cylinders of the plane."""
    kinds: list[ir.ShapeKind] = KINDS if seed % 2 else ["sphere", "capsule", "box"]
    arm = Posed(seed, kinds, 40)
    compared = 0
    for pose in range(40):
        sets = [arm.set(number, pose) for number in range(len(arm.frames))]
        for place, (one, two) in enumerate(arm.model.apart):
            true = distance(sets[one], sets[two])
            thick = sets[one].radius + sets[two].radius
            if true + thick < 1e-6:  # what is inside has no distance
                assert arm.ours[pose, place] < 1e-6
                continue
            compared += 1
            assert arm.ours[pose, place] == pytest.approx(true, abs=1e-9)
    assert compared > 30


def geometry(shape: Shape, sizes: list[float], origin: Array, axes: Array) -> dict[str, object]:
    """A shape of space as MuJoCo has it."""
    along = shape.sign * axes[:, shape.axis]
    middle, halves = origin, [size / 2 for size in sizes]
    if shape.kind in {"capsule", "cylinder"}:
        middle, halves = origin + along * sizes[0] / 2, [sizes[1], sizes[0] / 2]
        # Any frame whose z is along the axis.
        axes = np.stack([axes[:, shape.axis - 2], np.zeros(3), along], axis=1)
        axes[:, 1] = np.cross(along, axes[:, 0])
    elif shape.kind == "sphere":
        halves = sizes
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(axes).ravel())
    kinds = {
        "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
        "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
        "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
        "box": mujoco.mjtGeom.mjGEOM_BOX,
    }
    size = [*halves, 0.0, 0.0][:3]
    return {"type": kinds[shape.kind], "size": size, "pos": middle, "quat": quaternion}


@pytest.mark.parametrize("seed", range(0, 16, 2))
def test_all_shapes_of_space_in_mujoco(seed: int) -> None:
    """A search knows a cylinder by a prism, whose edges and faces are 4 % of the radius off."""
    arm = Posed(seed, KINDS, 6)
    for pose in range(6):
        spec = mujoco.MjSpec()
        for number, shape in enumerate(arm.model.shapes):
            frame = arm.origins[pose, number], arm.axes[pose, number]
            spec.worldbody.add_geom(**geometry(shape, arm.sizes(number), *frame))
        world = spec.compile()
        world.opt.ccd_tolerance, world.opt.ccd_iterations = 1e-9, 300
        data = mujoco.MjData(world)
        mujoco.mj_kinematics(world, data)
        for place, (one, two) in enumerate(arm.model.apart):
            true = mujoco.mj_geomDistance(world, data, one, two, 20.0, None)
            ours = arm.ours[pose, place]
            round_ = [i for i in (one, two) if arm.model.shapes[i].kind == "cylinder"]
            off = sum(OFF * arm.sizes(i)[1] for i in round_)
            if true > off + 1e-6:
                assert ours == pytest.approx(true, abs=off + 1e-6)
