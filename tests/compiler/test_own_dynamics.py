"""Modules with dynamics of their own, against formulas written down by hand."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key
from compiler.robots.state_and_input import (
    input_bounds,
    robot_inputs,
    robot_states,
    unbounded_kinds,
)
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import load_text
from tests.oracles.formulas import program
from tests.oracles.robots import evaluate

SPEC = """\
module B { role base; }
module M { role joint; dof q: revolute z in [-3, 3]; const k = 0.8 N*m/A; param R in [1, 2] V/A;
  state i A = 0.5 A; input v in [-24, 12] V;
  der(i) = (v - R * i - k * rate(q)) / (0.3 V*s/A); torque(q) = k * i; }
module F { role joint; dof q: revolute z in [-2, 2]; torque(q) = u - 0.3 N*m*s * rate(q); }
module S { role joint; dof q: revolute z; torque(q) = -4 N*m * sin(q); }
module A { role joint; dof q: revolute z; state t N*m; der(t) = (u - t) / 0.2 s; torque(q) = t; }
module J { role joint; dof q: revolute z in [-1, 1]; }
module L { role link; param length in [0.5, 5] m; }
module E { role effector; }
module G { role effector; state w = 1; input a in [0, 1]; der(w) = (a - w) / (1 s); }
edge eps;
grammar Arm {
  start N;
  base: N -> B; motor: N -> N eps M; friction: N -> N eps F; spring: N -> N eps S;
  lag: N -> N eps A; joint: N -> N eps J; link: N -> N eps L;
  tool: N -> N eps E; grip: N -> N eps G;
}
semantics Arm {
  base { this.frame = world; }
  motor { this.frame = N.frame * rot(z, M.q); }
  friction { this.frame = N.frame * rot(z, F.q); }
  spring { this.frame = N.frame * rot(z, S.q); }
  lag { this.frame = N.frame * rot(z, A.q); }
  joint { this.frame = N.frame * rot(z, J.q); }
  link { this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: 2 kg/m); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
  grip { this.frame = N.frame; effector(frame: N.frame); }
}
workspace W { plane xy; bounds box [-9, 9] x [-9, 9] m; region P box [1, 2] x [1, 2] m; }
task T { robot Arm; workspace W; start in P; reach P; effort <= 7 N*m; horizon 4 steps of 0.1 s; }
"""

PROGRAM = program(SPEC)
LABELS = {"B": "base", "M": "motor", "F": "friction", "S": "spring", "A": "lag", "J": "joint"}
LABELS |= {"L": "link", "E": "tool", "G": "grip"}


def robot(modules: str) -> RobotModel:
    family = RobotFamily(PROGRAM, PROGRAM.grammars["Arm"], 2)
    return family.robot(family.replay(tuple(LABELS[m] for m in reversed(modules.split()))))


def test_a_motor_a_link_and_a_joint_with_friction() -> None:
    model = robot("B M L F L E")
    graph = robot_graph(model)
    rng = np.random.default_rng(1)
    for _ in range(5):
        q, v = rng.uniform(-2, 2, (2, 2))
        current, voltage, u = rng.uniform(-5, 5, 3)
        resistance, *lengths = theta = rng.uniform(1, 2, 3)
        found = evaluate(
            graph, "acceleration", q, np.array([*v, current]), np.array([voltage, u]), theta
        )
        plain = robot("B J L J L E")
        torques = np.array([0.8 * current, u - 0.3 * v[1]])
        expected = evaluate(robot_graph(plain), "acceleration", q, v, torques, np.array(lengths))
        np.testing.assert_allclose(found[:2], expected, rtol=1e-12)
        slope = (voltage - resistance * current - 0.8 * v[0]) / 0.3
        np.testing.assert_allclose(found[2], slope, rtol=1e-12)


def test_what_the_state_and_input_vectors_hold() -> None:
    model = robot("B M L F L J L A L S L E")
    states, inputs = robot_states(model), robot_inputs(model)
    assert [(s.symbol, s.name, s.unit) for s in states] == [(2, "i", "A"), (14, "t", "N*m")]
    assert [s.initial for s in states] == [ir.Num(Fraction(1, 2)), None]
    # The spring has no input, the motor only its voltage.
    assert [(i.symbol, i.name, i.dof) for i in inputs] == [
        (2, "v", None), (6, "u", 1), (10, "u", 2), (14, "u", 3)
    ]  # fmt: skip
    bounds = input_bounds(model, PROGRAM.tasks["T"])
    assert [(b.inputs, int(b.lower), int(b.upper), b.effort) for b in bounds] == [
        ((1, 2, 3), -7, 7, True), ((0,), -24, 12, False)
    ]  # fmt: skip
    assert bounds[1].margin((Fraction(10), Fraction(0), Fraction(0), Fraction(0))) == 2
    assert unbounded_kinds(model, PROGRAM.tasks["T"]) == []


def test_joints_with_dynamics_of_their_own_are_not_merged() -> None:
    assert [dof.symbols for dof in robot("B J J L E").dofs] == [(2, 4)]
    assert [dof.symbols for dof in robot("B J F L E").dofs] == [(2,), (4,)]
    assert [dof.symbols for dof in robot("B M J L E").dofs] == [(2,), (4,)]


def test_what_moves_nothing_is_lost_with_its_states_and_inputs() -> None:
    model = robot("B J L M E")
    assert (model.removed, model.own) == ((6,), ())
    assert [item.name for item in robot_inputs(model)] == ["u"]
    kept = robot("B M L M E")
    assert [own.symbol for own in kept.own] == [2]
    assert kept.own[0].bound_dofs == {"q": 0}


def test_states_that_no_torque_reads_are_left_out() -> None:
    assert robot("B J L G").own == ()


def test_robots_differ_by_their_own_dynamics() -> None:
    keys = {robot_key(robot(word)) for word in ("B J L E", "B M L E", "B F L E", "B S L E")}
    assert len(keys) == 4
    assert robot_key(robot("B J L E")) == robot_key(robot("B J L G"))


@pytest.mark.parametrize("word", ["B M L F L E", "B F L M L S L E", "B A L S L E"])
def test_absolute_angles_describe_the_same_system(word: str) -> None:
    """With q = D y the two graphs give y'' with D y'' = q'', and the same derivatives of states."""
    model = robot(word)
    n, r, m = len(model.dofs), len(robot_states(model)), len(robot_inputs(model))
    coordinates = absolute_angles(model)
    pull = (Fraction(1, 3), Fraction(-9))
    graph, own = robot_graph(model, pull, coordinates), robot_graph(model, pull)
    d = np.array(coordinates.rows, dtype=float)
    rng = np.random.default_rng(7)
    for _ in range(3):
        y, rates = rng.uniform(-2, 2, (2, n))
        s, u = rng.uniform(-2, 2, r), rng.uniform(-2, 2, m)
        theta = rng.uniform(1, 2, len(model.parameters))
        found = evaluate(graph, "acceleration", y, np.array([*rates, *s]), u, theta)
        expected = evaluate(own, "acceleration", d @ y, np.array([*(d @ rates), *s]), u, theta)
        np.testing.assert_allclose(d @ found[:n], expected[:n], rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(found[n:], expected[n:], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("kept", "needed"), [("motor", False), ("spring", False), ("lag", True), ("friction", True)]
)
def test_an_effort_is_asked_for_where_an_input_is_free_only(kept: str, *, needed: bool) -> None:
    text = SPEC.replace("effort <= 7 N*m; ", "")
    for name in {"motor", "friction", "spring", "lag", "joint"} - {kept}:
        text = re.sub(rf"{name}: N -> N eps .;|{name} {{.*}}", "", text)
    found = load_text(text, "a.srg").diagnostics
    errors = [item.message for item in found if item.severity is Severity.ERROR]
    assert errors == (["task `T` bounds no effort of the revolute joints"] if needed else [])
