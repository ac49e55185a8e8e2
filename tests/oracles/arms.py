"""Robots to test with, built link by link, and their forward kinematics in plain numpy."""

from __future__ import annotations

from fractions import Fraction
from math import cos, pi, sin

import numpy as np

from compiler.expressions.scalars import Apply, Constant, ParameterLeaf, PiConstant, ScalarTable
from compiler.robots.robot import (
    FrameNode,
    Joint,
    Offset,
    RobotDof,
    RobotModel,
    RobotParameter,
    RodBody,
    Turn,
)
from grammar_lang import ir


def number(value):
    """A closed expression of a rational (or an expression, kept)."""
    return ir.Num(Fraction(value)) if isinstance(value, int | str | Fraction) else value


def interval(lower, upper):
    return ir.Interval(number(lower), number(upper))


def degrees(value):
    return ir.Binary("*", ir.Num(Fraction(value) / 180), ir.Pi())


class ArmBuilder:
    """Builds a robot outwards from the current frame; ``frame`` may be set to branch."""

    def __init__(self, dimension=2):
        self.dimension = dimension
        self.table = ScalarTable()
        self.frames = [FrameNode(0, None)]
        self.dofs, self.parameters, self.bodies, self.effectors = [], [], [], []
        self.frame = 0
        self.symbols = 0

    def _step(self, step):
        self.frames.append(FrameNode(self.frame, step))
        self.frame = len(self.frames) - 1
        return self

    def scalar(self, value):
        """A scalar's index: an index stays (wrapped in a list), a number becomes a constant."""
        return value[0] if isinstance(value, list) else self.table.constant(Fraction(value))

    def parameter(self, *domain, name="length", unit="m"):
        """A parameter on an interval (two ends), or any domain; use it as a scalar."""
        self.symbols += 1
        found = interval(*domain) if len(domain) == 2 else domain[0]
        self.parameters.append(RobotParameter(self.symbols, "L", name, found, unit))
        return [self.table.parameter(len(self.parameters) - 1)]

    def apply(self, operation, *arguments):
        """A scalar from scalars."""
        items = [self.scalar(a) for a in arguments]
        if len(items) == 1:
            return [self.table.unary(operation, items[0])]
        return [self.table.binary(operation, *items)]

    def degrees(self, value):
        """A constant angle in rad."""
        return [self.table.binary("*", self.table.constant(Fraction(value) / 180), self.table.pi())]

    def revolute(self, axis=2, limits=(-180, 180), sign=1):
        found = None if limits is None else ir.Interval(*(degrees(value) for value in limits))
        return self._joint("revolute", axis, sign, found)

    def prismatic(self, axis=0, limits=(0, 1), sign=1):
        return self._joint("prismatic", axis, sign, None if limits is None else interval(*limits))

    def _joint(self, kind, axis, sign, limits):
        self.symbols += 1
        name = ("-" if sign < 0 else "") + "xyz"[axis]
        self.dofs.append(RobotDof((self.symbols,), kind, name, limits, None))
        return self._step(Joint(len(self.dofs) - 1, axis, sign))

    def turn(self, angle, axis=2):
        return self._step(Turn(axis, self.scalar(angle)))

    def move(self, x=0, y=0, z=0):
        return self._step(Offset((self.scalar(x), self.scalar(y), self.scalar(z))))

    def link(self, length, density=1):
        """A uniform rod along x."""
        self.bodies.append(
            RodBody(self.frame, 0, 1, self.scalar(length), self.scalar(density), None)
        )
        return self.move(length)

    def effector(self):
        self.effectors.append(self.frame)
        return self

    def model(self):
        return RobotModel(
            self.dimension,
            tuple(self.table.nodes),
            tuple(self.frames),
            tuple(self.dofs),
            tuple(self.parameters),
            tuple(self.bodies),
            tuple(self.effectors),
        )


def planar_arm(links, lower="1/2", upper=5, limits=(-180, 180), density=1):
    """The running example: joint, link, joint, link, ..., effector; every length a parameter."""
    arm = ArmBuilder()
    for _ in range(links):
        arm.revolute(limits=limits).link(arm.parameter(lower, upper), density)
    return arm.effector().model()


# --- forward kinematics without the compiler ----------------------------------------------------


def scalar_values(model, theta):
    """Every scalar of a model in floats."""
    values = []
    for node in model.scalars:
        match node:
            case Constant(value):
                values.append(float(value))
            case PiConstant():
                values.append(pi)
            case ParameterLeaf(index):
                values.append(theta[index])
            case Apply(operation, arguments, exponent):
                a = [values[i] for i in arguments]
                functions = {
                    "+": lambda a: a[0] + a[1],
                    "-": lambda a: a[0] - a[1],
                    "*": lambda a: a[0] * a[1],
                    "/": lambda a: a[0] / a[1],
                    "^": lambda a, e=exponent: a[0] ** e,
                    "neg": lambda a: -a[0],
                    "abs": lambda a: abs(a[0]),
                    "sqrt": lambda a: np.sqrt(a[0]),
                    "sin": lambda a: sin(a[0]),
                    "cos": lambda a: cos(a[0]),
                    "tan": lambda a: np.tan(a[0]),
                }
                values.append(functions[operation](a))
    return values


def rotation(axis, angle):
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = cos(angle)
    matrix[i, j], matrix[j, i] = -sin(angle), sin(angle)
    return matrix


def frames_of(model, q, theta):
    """Rotation (3, 3) and origin (3,) of every frame in the world, by products of frames."""
    values = scalar_values(model, theta)
    poses = [(np.eye(3), np.zeros(3))]
    for node in model.frames[1:]:
        turn, origin = poses[node.parent]
        match node.step:
            case Turn(axis, angle):
                turn = turn @ rotation(axis, values[angle])
            case Offset(vector):
                origin = origin + turn @ np.array([values[i] for i in vector])
            case Joint(dof, axis, sign) if model.dofs[dof].kind == "revolute":
                turn = turn @ rotation(axis, sign * q[dof])
            case Joint(dof, axis, sign):
                origin = origin + turn[:, axis] * sign * q[dof]
        poses.append((turn, origin))
    return poses


def effector_positions(model, q, theta):
    """World positions of all effectors, one row each."""
    poses = frames_of(model, q, theta)
    return np.array([poses[frame][1][: model.dimension] for frame in model.effectors])
