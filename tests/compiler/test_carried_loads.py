"""A robot with a load as an input: with it the robot with a payload, without it the one without."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.robots.robot_key import robot_key
from compiler.robots.state_and_input import input_bounds, robot_inputs
from compiler.tasks.carrying import load_inputs, transfer_of
from compiler.tasks.specification import input_errors, uncertain_masses
from compiler.words.structures import structures
from grammar_lang.load import load_text
from srgc.session import check_loaded
from tests.compiler.test_posed_robots import WRIST
from tests.oracles.formulas import program
from tests.oracles.small_specs import replaced

SPECS = Path(__file__).parents[2] / "specs"
GRAVITY = (Fraction(1), Fraction(-2), Fraction(-9))
LOAD = "carry 0.7 kg from S to T;"
ARM = WRIST.replace("L Z E", "L Z L E").replace("SHAPE", "").replace("POSE", "")


def numeric(clauses: str) -> NumericRobot:
    found = program(ARM.replace("effort <=", f"{clauses} effort <="))
    robots = family_of(found, found.tasks["P"])
    (derivation,) = structures(robots.language, 8)
    return NumericRobot(robot_graph(robots.robot(derivation), GRAVITY))


@pytest.mark.parametrize(("there", "payload"), [(1.0, "0.9 kg"), (0.0, "0.2 kg")])
def test_a_load_is_a_payload_while_it_is_there(there: float, payload: str) -> None:
    rng = np.random.default_rng(5)
    robot, same = numeric(f"{LOAD} payload 0.2 kg by effector 1;"), numeric(f"payload {payload};")
    assert (robot.m, same.m) == (same.m + 1, same.m)
    x, u = rng.uniform(-2, 2, (30, 6)), rng.uniform(-3, 3, (30, same.m))
    loaded = np.concatenate([u, np.full((30, 1), there)], axis=1)
    none = np.zeros(0)
    found, slopes = robot.acceleration(x, loaded, none)
    assert np.max(np.abs(found)) < 1e3
    expected, by_all = same.acceleration(x, u, none)
    assert np.allclose(found, expected, rtol=1e-10, atol=1e-10)
    # What steers is as it is there; a load steers nothing.
    assert np.allclose(np.delete(slopes, 6 + same.m, axis=2), by_all, rtol=1e-9, atol=1e-9)
    assert not slopes[:, :, 6 + same.m].any()
    masses = robot.mass_matrix(x[:, :3], none, loaded)
    assert np.allclose(masses, same.mass_matrix(x[:, :3], none), rtol=1e-12, atol=1e-12)
    step, other = (
        one.step(x, inputs, none, 0.01, 2) for one, inputs in ((robot, loaded), (same, u))
    )
    assert np.allclose(step.value, other.value, rtol=1e-10, atol=1e-10)


def test_the_robot_alone_is_what_has_no_inputs() -> None:
    """Its mass matrix, and what gravity and its rates ask, are without the load."""
    robot, empty = numeric(LOAD).graph, numeric("").graph
    rng = np.random.default_rng(6)
    for q, v in rng.uniform(-2, 2, (10, 2, 3)):
        for name, columns in (("mass_matrix", [q]), ("gravitational", [q]), ("bias", [q, v])):
            values = []
            for graph in (robot, empty):
                tail = [np.zeros(0), _constants(graph.constants)]
                values.append(np.asarray(getattr(graph, name)(*columns, *tail).full()))
            assert np.allclose(*values, rtol=1e-12, atol=1e-12), name


def _constants(constants: tuple[object, ...]) -> np.ndarray:
    return np.array([float(getattr(each, "value", np.pi)) for each in constants])


def test_the_graph_of_proofs_reads_the_load_wherever_it_is() -> None:
    """Among the inputs, among the held ones, and with an uncertain mass on top."""
    robot, rng = numeric(LOAD), np.random.default_rng(7)
    graph, m = robot.graph, robot.m
    held = graph.holding_inputs
    weighed = held.weighed([(len(graph.model.bodies) - 1,)])
    k, none = _constants(graph.constants), np.zeros(0)
    for _ in range(5):
        q, v, u = rng.uniform(-2, 2, 3), rng.uniform(-2, 2, 3), rng.uniform(-2, 2, m)
        u[-1] = rng.integers(2)
        plain = _column(graph.acceleration(q, v, u, none, k))
        inside = _column(held.acceleration(q, np.concatenate([v, u]), np.zeros(m), none, k))
        assert np.allclose(inside[:3], plain, rtol=1e-12)
        heavier = np.concatenate([v, u, [1.25]])
        found = _column(weighed.acceleration(q, heavier, np.zeros(m), none, k))
        other = numeric("carry 0.875 kg from S to T;").graph
        expected = _column(other.acceleration(q, v, u, none, _constants(other.constants)))
        assert np.allclose(found[:3], expected, rtol=1e-10, atol=1e-10)


def _column(value: ca.DM) -> np.ndarray:
    return np.asarray(value.full()).ravel()


def test_what_the_load_is_among_inputs() -> None:
    found = program(
        ARM.replace("effort <=", f"{LOAD} robust effort 2 %; robust payload 3 %; effort <=")
    )
    task = found.tasks["P"]
    robots = family_of(found, task)
    (derivation,) = structures(robots.language, 8)
    model = robots.robot(derivation)
    *_, last = robot_inputs(model)
    assert (last.is_load, last.name, last.unit) == (True, "load", "1")
    place = len(robot_inputs(model)) - 1
    assert all(place not in bound.inputs for bound in input_bounds(model, task))
    parts, most = input_errors(task, model)
    assert parts == (Fraction(1, 50),) * place + (Fraction(0),)
    assert not any(most)
    (mass,) = uncertain_masses(task, model)
    assert (mass.part, mass.bodies) == (Fraction(3, 100), (len(model.bodies) - 1,))
    without = program(ARM)
    other = family_of(without, without.tasks["P"]).robot(derivation)
    assert robot_key(model) != robot_key(other)


@pytest.mark.parametrize(
    ("column", "found"),
    [
        ("0011100", (2, 5)),
        ("1111111", (0, 7)),
        ("0000001", (6, 7)),
        ("0000000", None),
        ("0110110", None),
    ],
)
def test_when_a_load_is_there(column: str, found: tuple[int, int] | None) -> None:
    values = [Fraction(digit) for digit in column]
    assert transfer_of(values) == found
    if found is not None:
        inputs = load_inputs([found], len(column))
        assert inputs.ravel().tolist() == [float(value) for value in values]


@pytest.mark.parametrize("odd", ["1/2", "2", "-1"])
def test_half_a_load_is_none(odd: str) -> None:
    assert transfer_of([Fraction(0), Fraction(1), Fraction(odd), Fraction(0)]) is None


@pytest.mark.parametrize(
    ("clauses", "code", "said"),
    [
        (
            f"{LOAD} avoid S with effector;",
            "SRG0604",
            "the place of the load `S` lies wholly inside",
        ),
        ("carry 1 kg from S to Away;", "SRG0605", "the place of the load `Away` lies outside"),
        (f"{LOAD} satisfy always not S by effector 1;", "SRG0704", "contradicts itself"),
    ],
)
def test_places_of_loads_that_none_can_be_in(clauses: str, code: str, said: str) -> None:
    text = ARM.replace("effort <=", f"{clauses} effort <=").replace("reach T ", "reach T")
    text = text.replace("  target T", "  region Away box [5, 6] x [0, 1] x [0, 1] m;\n  target T")
    text = text.replace("start in S", "start in Home").replace(
        "  region Away", "  region Home box [0, 1] x [0, 1] x [-1, -0.5] m;\n  region Away"
    )
    found = check_loaded(load_text(text, "spec.srg"))
    errors = [each for each in found.diagnostics if each.severity.name == "ERROR"]
    assert [each.code.value for each in errors] == [code]
    assert said in errors[0].message


@pytest.mark.parametrize("clause", ["payload 1 kg;", "carry 1 kg from Tray to Press;"])
def test_who_carries_is_asked_of_families_with_several_effectors(clause: str) -> None:
    """Also where no formula is."""
    text = (SPECS / "two_arm.srg").read_text(encoding="utf-8")
    text = replaced(text, "reach Press by effector 2;", f"reach Press; {clause}")
    text = replaced(text, "start in Tray by effector 1", "start in Tray")
    found = check_loaded(load_text(text, "spec.srg"))
    errors = [each for each in found.diagnostics if each.severity.name == "ERROR"]
    assert ["which effector carries it?" in each.message for each in errors] == [True]
