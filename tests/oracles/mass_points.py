"""A robot model as point masses: the same mass, com and inertia of every body, and no matrix M.

Rods are their two Gauss points, a solid is six points on the principal axes of its second moments
(two in the plane).  Frames are multiplied out in numpy, which takes complex coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.robot import Joint, Offset, PointBody, RobotModel, RodBody, SolidBody, Turn
from tests.oracles.lagrangian import PointCloud

Complex = NDArray[np.complex128]
GAUSS = 0.5 / np.sqrt(3.0)


def mass_points(model: RobotModel, theta: Array) -> PointCloud:
    """All of a robot's mass; positions are (N, 3) whatever the dimension."""
    scalars = scalar_floats(model.scalars, theta)
    masses: list[float] = []
    places: list[tuple[int, Array]] = []
    for body in model.bodies:
        if isinstance(body, RodBody):
            along = body.sign * scalars[body.length] * np.eye(3)[body.axis]
            mass = scalars[body.density] * scalars[body.length]
            points = [(mass / 2, along * (0.5 - GAUSS)), (mass / 2, along * (0.5 + GAUSS))]
        elif isinstance(body, PointBody):
            points = [(scalars[body.mass], np.zeros(3))]
        else:
            points = _solid(body, scalars)
        masses += [mass for mass, _ in points]
        places += [(body.frame, place) for _, place in points]

    def positions(q: Complex) -> Complex:
        frames = _frames(model, scalars, q)
        return np.array([frames[f][0] + frames[f][1] @ place for f, place in places])

    return PointCloud(np.array(masses), positions)


def _solid(body: SolidBody, scalars: Sequence[float]) -> list[tuple[float, Array]]:
    mass, com = scalars[body.mass], np.array([scalars[i] for i in body.com])
    items = [scalars[i] for i in body.inertia]
    if len(items) == 1:
        arm = np.array([np.sqrt(items[0] / mass), 0.0, 0.0])
        return [(mass / 2, com + arm), (mass / 2, com - arm)]
    xx, yy, zz, xy, xz, yz = items
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    moments, axes = np.linalg.eigh(np.trace(inertia) / 2 * np.eye(3) - inertia)
    assert moments.min() > 0
    arms = [np.sqrt(3 * m / mass) * axis for m, axis in zip(moments, axes.T, strict=True)]
    return [(mass / 6, com + sign * arm) for arm in arms for sign in (1, -1)]


def _frames(
    model: RobotModel, scalars: Sequence[float], q: Complex
) -> list[tuple[Complex, Complex]]:
    """Origin and rotation of every frame."""
    world = np.zeros(3, dtype=np.complex128), np.eye(3, dtype=np.complex128)
    frames: list[tuple[Complex, Complex]] = []
    for node in model.frames:
        origin, turn = frames[node.parent] if frames else world
        match node.step:
            case Turn(axis, angle):
                turn = turn @ _rotation(axis, scalars[angle])
            case Offset(vector):
                origin = origin + turn @ np.array([scalars[i] for i in vector])
            case Joint(dof, axis, sign) if model.dofs[dof].kind == "revolute":
                turn = turn @ _rotation(axis, sign * q[dof])
            case Joint(dof, axis, sign):
                origin = origin + turn[:, axis] * sign * q[dof]
            case None:
                pass
        frames.append((origin, turn))
    return frames


def _rotation(axis: int, angle: complex) -> Complex:
    """Rodrigues' formula about a coordinate axis."""
    e = np.eye(3)[axis]
    cross = np.cross(np.eye(3), e)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)


def energy(cloud: PointCloud, q: Array, v: Array, pull: Sequence[float]) -> float:
    """Kinetic plus potential energy, from positions and velocities."""
    velocities = cloud.jacobian(q) @ v
    weights = np.zeros(3)
    weights[: len(pull)] = pull
    places = cloud.positions(q.astype(np.complex128)).real
    kinetic = np.sum(cloud.masses * np.sum(velocities**2, axis=1)) / 2
    return float(kinetic - cloud.masses @ (places @ weights))
