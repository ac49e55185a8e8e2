"""Questions about poses, and sound random robots to ask them of."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from compiler.encodings.pose_questions import PoseQuestion
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.normal_form import normalise
from grammar_lang import ir
from solvers.backends.smt import solve_script
from solvers.verdict import Fails, Holds
from tests.oracles.arms import ArmBuilder, number
from tests.oracles.planes import box_rows

START = (("0.8", "1.2"), ("1.0", "1.4"))
TARGET = (("3.5", "4.2"), ("3.8", "4.5"))
BENCH = ((0, 5), (0, 5))
EVERYWHERE = ((-99, 99),) * 3

SAT, UNSAT = Holds(None), Fails(None)


def decide(arm, asked=None):
    """Whether the poses exist, by the script of the normal form of a robot (or its builder)."""
    model = normalise(arm.model() if isinstance(arm, ArmBuilder) else arm)
    return solve_script(refutation_script(model, asked or question()))


def question(start=START, target=TARGET, bounds=BENCH, **effectors):
    """Boxes as a question; ``start`` may be None."""
    rows = [None if box is None else box_rows(*box).rows for box in (start, target, bounds)]
    return PoseQuestion(*rows, **effectors)


def box_about(point, width):
    """The box of a half width about a point of floats, exactly."""
    return tuple((Fraction(x) - width, Fraction(x) + width) for x in map(float, point))


def round_box_about(point, width):
    """A box that holds a point of floats: a half width about the nearest multiple of it."""
    centres = [round(float(x) / float(width)) * width for x in point]
    return tuple((x - width, x + width) for x in centres)


def random_robot(rng, dimension):
    """A small robot with turns, bends, sliders, choices, functions and branches."""
    arm = ArmBuilder(dimension)
    axes = (2,) if dimension == 2 else (0, 1, 2)
    for _ in range(int(rng.integers(1, 6))):
        axis = int(rng.choice(axes))
        slide = int(rng.integers(dimension))
        match int(rng.integers(7)):
            case 0 | 1:
                arm.revolute(axis, sign=int(rng.choice([-1, 1])))
            case 2:
                arm.prismatic(slide, (Fraction(-1, 2), 1), sign=int(rng.choice([-1, 1])))
            case 3:
                arm.turn(arm.degrees(int(rng.choice([90, -90, 180, 45, 30, 17]))), axis)
            case 4:
                bend = arm.parameter(Fraction(-1, 2), 1, name="bend", unit="")
                arm.turn(bend if rng.random() < 0.5 else arm.apply("neg", bend), axis)
            case 5:
                choices = ir.Choices((number("1/2"), ir.Unary("sqrt", number(2)), number(2)))
                arm.link(arm.parameter(choices))
            case _:
                arm.move(*(Fraction(int(n), 4) for n in rng.integers(-4, 5, size=dimension)))
        length = arm.parameter(Fraction(1, 2), Fraction(3, 2))
        arm.link(_length(arm, length, int(rng.integers(6))))
        if rng.random() < 0.2:
            arm.effector()
    return arm.effector().model()


def _length(arm, t, kind):
    """A positive or negative length as an expression of a parameter."""
    match kind:
        case 0:
            return arm.apply("sqrt", arm.apply("+", t, 1))
        case 1:
            return arm.apply("abs", arm.apply("-", t, 1))
        case 2:
            return arm.apply("/", 1, t)
        case 3:
            return arm.apply("neg", arm.apply("*", t, arm.apply("cos", t)))
        case _:
            return t


def random_design(rng, model):
    """Parameters (p,) in their domains, eighths where the domain is an interval."""
    values = []
    for parameter in model.parameters:
        match parameter.domain:
            case ir.Interval(lower, upper):
                values.append(rng.integers(8 * lower.value, 8 * upper.value, endpoint=True) / 8)
            case ir.Choices():
                values.append([0.5, np.sqrt(2), 2.0][int(rng.integers(3))])
    return np.array(values)


def random_pose(rng, model):
    """Coordinates (n,) within the limits of revolute joints of a half turn and of the sliders."""
    return np.array(
        [
            rng.uniform(-np.pi, np.pi) if dof.kind == "revolute" else rng.uniform(-0.5, 1)
            for dof in model.dofs
        ]
    )
