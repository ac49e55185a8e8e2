"""The SMT-LIB reading: with all values fixed a solver finds the values of the graph."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import z3
from pysmt.smtlib.parser import SmtLibParser

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.body_smt import model_script
from compiler.expressions.scalars import Constant
from compiler.robots.robot import WORLD, RobotModel
from grammar_lang import ir
from tests.oracles.random_robots import random_robot
from tests.oracles.robots import Builder, interval, rod_chain

UNIT_POINTS = [(3, 4, 5), (5, -12, 13), (-8, 15, 17), (7, 24, 25), (-20, -21, 29), (12, 35, 37)]
HALF_POINTS = [(20, 21, 29), (35, 12, 37), (45, 28, 53)]
"""Pythagorean triples: exact points of the unit circle; cosines of halved angles are positive."""


def numeral(value: Fraction) -> str:
    size = f"(/ {abs(value.numerator)}.0 {value.denominator}.0)"
    return size if value >= 0 else f"(- {size})"


def fixed(script: str) -> tuple[str, dict[str, float]]:
    """Equations that fix all that is declared freely, and the values they fix."""
    lines, values = [], {}
    declared = [line.split()[1] for line in script.splitlines() if line.startswith("(declare-fun")]
    circles = iter(UNIT_POINTS * 3)
    halves = iter(HALF_POINTS * 3)
    lengths = iter(Fraction(n, 7) for n in range(8, 80))
    for name in declared:
        if name.startswith("cos_"):
            angle = name.removeprefix("cos_")
            a, b, c = next(halves if "_over_" in angle else circles)
            for function, side in (("cos", a), ("sin", b)):
                lines.append(f"(assert (= {function}_{angle} {numeral(Fraction(side, c))}))")
            whole, _, divisor = angle.partition("_over_")
            values[whole] = math.atan2(b, a) * int(divisor or 1)
        elif name[0] in "q" or name.startswith("theta"):
            values.setdefault(name, math.nan)
    for name, value in values.items():
        if name in declared:
            exact = next(lengths) / 8 if math.isnan(value) else Fraction(value)
            values[name] = float(exact)
            lines.append(f"(assert (= {name} {numeral(exact)}))")
    return "\n".join(lines), values


def solved(script: str, names: list[str]) -> dict[str, float]:
    """The values of defined functions in a model of the script."""
    asked = "\n".join(f"(declare-fun at_{n} () Real)(assert (= at_{n} {n}))" for n in names)
    solver = z3.Solver()
    solver.from_string(f"{script}\n{asked}")
    assert solver.check() == z3.sat
    model = solver.model()
    found = {}
    for name in names:
        value = model.eval(z3.Real(f"at_{name}"), model_completion=True)
        if z3.is_algebraic_value(value):
            value = value.approx(30)
        found[name] = float(value.as_fraction())
    return found


def entries(model: RobotModel) -> list[str]:
    n = len(model.dofs)
    mass = [f"M_{i + 1}_{j + 1}" for i in range(n) for j in range(i, n)]
    return mass + [
        f"e_{i + 1}_{a}" for i in range(len(model.effectors)) for a in "xyz"[: model.dimension]
    ]


def graph_values(model: RobotModel, values: dict[str, float]) -> dict[str, float]:
    """The graph in doubles, at the fixed values."""
    graph, n = robot_graph(model), len(model.dofs)
    q = np.array([values[f"q{i + 1}"] for i in range(n)])
    theta = np.array([values[f"theta{i + 1}"] for i in range(len(model.parameters))])
    k = np.array([float(c.value) if isinstance(c, Constant) else math.pi for c in graph.constants])

    def read(name: str) -> Array:
        return np.asarray(getattr(graph, name)(q, theta, k).full())

    mass, tips = read("mass_matrix"), read("effectors").ravel()
    numbers = [mass[i, j] for i in range(n) for j in range(i, n)] + list(tips)
    return dict(zip(entries(model), map(float, numbers), strict=True))


def without_limits(model: RobotModel) -> RobotModel:
    """The same robot, so that the test may choose any values."""
    dofs = tuple(replace(dof, range=None) for dof in model.dofs)
    wide = interval(-100, 100)
    parameters = tuple(replace(p, domain=wide) for p in model.parameters)
    return replace(model, dofs=dofs, parameters=parameters)


@pytest.mark.parametrize(
    ("seed", "dimension", "joints"),
    [(s, 2, 1 + s % 3) for s in range(8)] + [(s, 3, 2) for s in range(7)],
)
def test_fixed_values_give_the_values_of_the_graph(seed: int, dimension: int, joints: int) -> None:
    model = without_limits(random_robot(seed, dimension, joints))
    script = model_script(robot_graph(model))
    equations, values = fixed(script)
    found = solved(script + equations, entries(model))
    expected = graph_values(model, values)
    scale = max(1.0, *map(abs, expected.values()))
    for name in entries(model):
        assert found[name] == pytest.approx(expected[name], abs=1e-7 * scale), name


def test_two_rods_are_exact() -> None:
    model = rod_chain(2)
    script = model_script(robot_graph(model))
    values = {"theta1": "1.0", "theta2": "0.5", "cos_q1": "0.6", "sin_q1": "0.8",
              "cos_q2": "(/ 5.0 13.0)", "sin_q2": "(- (/ 12.0 13.0))"}  # fmt: skip
    equations = "\n".join(f"(assert (= {name} {value}))" for name, value in values.items())
    solver = z3.Solver()
    d11 = Fraction(1, 3) + Fraction(1, 2) + Fraction(1, 24) + Fraction(1, 4) * Fraction(5, 13)
    tip = (
        Fraction(3, 5) + (Fraction(3, 5) * Fraction(5, 13) + Fraction(4, 5) * Fraction(12, 13)) / 2
    )
    exact = f"(and (= M_1_1 {numeral(d11)}) (= e_1_x {numeral(tip)}) (= M_2_2 (/ 1.0 24.0)))"
    solver.from_string(f"{script}{equations}(assert (not {exact}))")
    assert solver.check() == z3.unsat


def test_limits_bind() -> None:
    """A joint within 60 degrees and a slide of 2 m; a length of 1 or 3."""
    builder = Builder()
    sixty = ir.Binary("/", ir.Pi(), ir.Num(Fraction(3)))
    joint = builder.joint(WORLD, "z", range_=ir.Interval(ir.Unary("neg", sixty), sixty))
    slide = builder.joint(joint, "x", "prismatic", interval(0, 2))
    builder.effector(builder.link(slide, builder.parameter()))
    model = builder.build()
    choices = ir.Choices((ir.Num(Fraction(1)), ir.Num(Fraction(3))))
    model = replace(model, parameters=(replace(model.parameters[0], domain=choices),))
    script = model_script(robot_graph(model))
    asked = {
        "(= e_1_x 5.0)": z3.sat,
        "(> (+ (* e_1_x e_1_x) (* e_1_y e_1_y)) 25.01)": z3.unsat,
        "(< e_1_x 0.499)": z3.unsat,
        "(and (= q2 0.0) (= sin_q1 0.0) (= e_1_x 2.0))": z3.unsat,
        "(> q2 2.0)": z3.unsat,
        "(and (> cos_q1 0.49) (< cos_q1 0.51))": z3.sat,
    }
    for formula, verdict in asked.items():
        solver = z3.Solver()
        solver.from_string(f"{script}(assert {formula})")
        assert solver.check() == verdict, formula


def test_a_choice_of_angles_is_one_choice() -> None:
    """A bend of -90, 30 or 120 degrees, halved: value, cosine and sine go together."""
    builder = Builder()
    bend = builder.table.binary("/", builder.parameter(name="bend"), builder.number(2))
    frame = builder.turn(builder.joint(WORLD), "z", bend)
    builder.effector(builder.link(frame, builder.number(1)))
    angles = [ir.Binary("*", ir.Num(Fraction(n, 180)), ir.Pi()) for n in (-90, 30, 120)]
    model = builder.build()
    parameter = replace(model.parameters[0], domain=ir.Choices(tuple(angles)))
    script = model_script(robot_graph(replace(model, parameters=(parameter,))))
    script += "(assert (= cos_q1 1.0))(assert (> theta1 0.0))"
    asked = {
        "true": z3.sat,
        "(and (> e_1_x 0.4999) (< e_1_x 0.5001))": z3.sat,
        "(and (> e_1_x 0.5001) (< e_1_x 0.9659))": z3.unsat,
        "(< e_1_y 0.2588)": z3.unsat,
        "(and (< theta1 1.0) (> e_1_y 0.2589))": z3.unsat,
        "(and (> theta1 1.0) (> e_1_y 0.8660) (< e_1_y 0.8661))": z3.sat,
    }
    for formula, verdict in asked.items():
        solver = z3.Solver()
        solver.from_string(f"{script}(assert {formula})")
        assert solver.check() == verdict, formula


def test_quotients_roots_and_absolute_values() -> None:
    builder = Builder()
    table, t = builder.table, builder.parameter(-4, 4)
    size = table.unary("abs", t)
    root = table.unary("sqrt", table.binary("+", size, builder.number(1)))
    frame = builder.link(builder.joint(WORLD), table.binary("/", builder.number(3), root))
    frame = builder.turn(frame, "z", table.unary("tan", builder.number(1)))
    builder.effector(builder.link(builder.joint(frame), table.unary("sqrt", builder.number(2))))
    model = builder.build()
    script = model_script(robot_graph(model))
    a, b = (3, 4, 5), (5, -12, 13)
    points = {"cos_q1": a[:1] + a[2:], "sin_q1": a[1:], "cos_q2": b[:1] + b[2:], "sin_q2": b[1:]}
    equations = "\n".join(
        f"(assert (= {name} {numeral(Fraction(*pair))}))" for name, pair in points.items()
    )
    found = solved(f"{script}{equations}(assert (= theta1 (- 3.0)))", ["M_1_1", "M_2_2"])
    values = {"q1": math.atan2(4, 3), "q2": math.atan2(-12, 5), "theta1": -3.0}
    expected = graph_values(model, values)
    assert found["M_2_2"] == pytest.approx(expected["M_2_2"], abs=1e-7)
    assert expected["M_2_2"] == pytest.approx(2**1.5 / 3)


def test_a_root_is_not_negative() -> None:
    builder = Builder()
    root = builder.table.unary("sqrt", builder.parameter(1, 4))
    builder.effector(builder.link(builder.joint(WORLD), root))
    script = model_script(robot_graph(builder.build())) + "(assert (= cos_q1 1.0))"
    for formula, verdict in {"(< e_1_x 0.99)": z3.unsat, "(= e_1_x 1.5)": z3.sat}.items():
        solver = z3.Solver()
        solver.from_string(f"{script}(assert {formula})")
        assert solver.check() == verdict


@pytest.mark.parametrize("factor", [Fraction(3), Fraction(-5, 2), Fraction(7), Fraction(-4)])
def test_multiples_of_an_angle(factor: Fraction) -> None:
    builder = Builder()
    t = builder.parameter(-100, 100)
    bend = builder.table.binary("*", builder.number(factor), t)
    frame = builder.turn(builder.joint(WORLD), "z", bend)
    builder.effector(builder.link(frame, builder.number(1)))
    model = builder.build()
    script = model_script(robot_graph(model))
    equations, values = fixed(script)
    found = solved(script + equations, entries(model))
    angle = values["q1"] + float(factor) * values["theta1"]
    assert found["e_1_x"] == pytest.approx(math.cos(angle), abs=1e-12)
    assert found["e_1_y"] == pytest.approx(math.sin(angle), abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_other_parsers_read_it(seed: int) -> None:
    model = random_robot(seed, 2 + seed % 2, 2)
    script = model_script(robot_graph(model))
    commands = SmtLibParser().get_script(io.StringIO(script)).commands
    defined = [command.args[0] for command in commands if command.name == "define-fun"]
    assert [name for name in defined if name[0] in "Me"] == entries(model)


def test_a_robot_without_joints() -> None:
    builder = Builder()
    builder.effector(builder.link(WORLD, builder.number(3)))
    script = model_script(robot_graph(builder.build()))
    assert solved(script, ["e_1_x", "e_1_y"]) == {"e_1_x": 3.0, "e_1_y": 0.0}
