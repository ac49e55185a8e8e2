"""Robots with dry friction: closed forms, an integrator by hand, and what is not refuted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import arb
from scipy.integrate import quad

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.rubbing_joints import with_dry_friction
from compiler.expressions.evaluators.balls import ball, constant_ball, working_precision
from compiler.expressions.tape import tape
from grammar_lang import ir
from solvers.trajectory.friction_inputs import AT_REST, friction_inputs
from solvers.trajectory.rubbing_motion import rubbing_motion
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.certified_tube import certified_tube
from solvers.verifier.claims.certificate import FoundClaim
from solvers.verifier.claims.spec_copy import claimed_task, read_claim
from solvers.verifier.found_check import claimed_robot
from solvers.verifier.proofs.checked_condition import decisive
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, TubeSegment, tube
from solvers.verifier.proofs.sticking_field import sticking_field
from solvers.verifier.proofs.trajectory_proof import prove_motion, scene_of
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import InitialSet
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import geared_arm, result_files
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import WORLD, Builder, rod_chain
from tests.oracles.rod_pair import rod_pair
from tests.oracles.rubbing_chain import RubbingChain
from tests.oracles.small_specs import replaced

F = Fraction
ROOT = Path(__file__).parents[2]
ACCURACY = Accuracy(12, 96, 1e-12)


def rubbing_graph(friction: list[Fraction], pull: tuple[Fraction, Fraction]) -> RobotGraph:
    model = rod_chain(len(friction))
    sizes = [ir.Num(size) if size else None for size in friction]
    dofs = (replace(dof, coulomb=size) for dof, size in zip(model.dofs, sizes, strict=True))
    return robot_graph(replace(model, dofs=tuple(dofs)), pull)


def field_of(graph: RobotGraph, lengths: list[Fraction], friction: list[Fraction]) -> VectorField:
    rubs = with_dry_friction(graph)
    tail = (*map(ball, lengths), *map(constant_ball, rubs.constants))
    return VectorField(
        tape(rubs.balance), tape(rubs.variation), len(friction), tail, 0, tape(rubs.input_slopes),
        friction=tuple((i, ball(size)) for i, size in enumerate(friction) if size),
    )  # fmt: skip


def segments_of(
    lengths: list[Fraction], friction: list[Fraction], start: list[Fraction],
    inputs: list[list[Fraction]], step: Fraction,
) -> list[TubeSegment]:  # fmt: skip
    with working_precision(ACCURACY.bits):
        field = field_of(rubbing_graph(friction, (F(0), F(0))), lengths, friction)
        rows = [[ball(u) for u in row] for row in inputs]
        return list(tube(field, box_at(start), rows, ball(step), ACCURACY))


def test_a_rod_starts_stops_and_stays() -> None:
    """J = l^3 / 3: it slides with (u -+ c) / J, rests while |u| <= c, and its rate is then zero."""
    c, inertia = F(3, 10), F(8, 3)
    inputs = [F(8, 10), F(0), F(-1, 5), F(29, 100), F(-8, 10)]
    found = segments_of([F(2)], [c], [F(0), F(0)], [[u] for u in inputs], F(1))
    up, down, harder = (F(8, 10) - c) / inertia, c / inertia, (c + F(1, 5)) / inertia
    rate = up - down
    stop = rate / harder
    rest = up / 2 + up - down / 2 + rate * stop / 2
    last = rest - (F(8, 10) - c) / inertia / 2
    wanted = [
        (up / 2, up), (up / 2 + up - down / 2, rate), (rest, F(0)), (rest, F(0)),
        (last, -(F(8, 10) - c) / inertia),
    ]  # fmt: skip
    ends = {int(each.steps[1]): each.end for each in found if each.steps[1].denominator == 1}
    for number, values in enumerate(wanted, 1):
        for item, value in zip(ends[number], values, strict=True):
            assert abs(item - ball(value)) < 1e-8
            assert item.rad() < 1e-8
    assert ends[3][1].is_zero()
    assert ends[4][1].is_zero()
    # It stops within the third second, where its tube passes through rest.
    assert any(2 < each.steps[1] < 3 and each.end[1].is_zero() for each in found)


def test_a_singular_mass_matrix_ends_a_tube_though_a_joint_sticks() -> None:
    """Two massless links with one mass at their end: M is singular where they are stretched.

    The inertia that is left with the first joint at rest is m l^2 everywhere.
    """
    builder, mass = Builder(), F(1, 2)
    elbow = builder.move(builder.joint(WORLD), "x", builder.number(1))
    tip = builder.move(builder.joint(elbow), "x", builder.number(F(7, 10)))
    builder.point(tip, builder.number(mass))
    builder.effector(tip)
    model, size = builder.build(), F(50)
    first, second = model.dofs
    rubs = replace(model, dofs=(replace(first, coulomb=ir.Num(size)), second))
    with working_precision(ACCURACY.bits):
        field = field_of(robot_graph(rubs, (F(0), F(0))), [], [size, F(0)])
        turning = [F(0), F(1, 2), F(0), F(-1)]
        inputs = [[arb(0), arb(0)]]
        apart = list(tube(field, box_at(turning), inputs, ball(F(1, 4)), ACCURACY))
        assert apart[-1].steps[1] == 1
        with pytest.raises(EnclosureFailure):
            list(tube(field, box_at(turning), inputs, arb(1), ACCURACY))


def box_at(state: list[Fraction]) -> InitialSet:
    return InitialSet(tuple(map(ball, state)))


@pytest.mark.parametrize("held", [{0}, {1}, {0, 2}])
def test_a_sticking_joint_is_rigid(held: set[int]) -> None:
    """The others have the accelerations of a chain some of whose rates do not change."""
    rng = np.random.default_rng(sum(held))
    lengths = [F(13, 10), F(9, 10), F(7, 10)]
    sizes, pull = [F(1, 2), F(1, 3), F(1, 4)], (F(1, 2), F(-3))
    x, u = rng.uniform(-1, 1, 6), rng.uniform(-1, 1, 3)
    for joint in held:
        x[3 + joint] = 0.0
    mass, turned, weight = chain_dynamics(
        np.array(lengths, float), np.ones(3), x[:3], x[3:], [0.5, -3.0]
    )
    moving = [joint for joint in range(3) if joint not in held]
    wanted = np.zeros(3)
    wanted[moving] = np.linalg.solve(mass[np.ix_(moving, moving)], (u - turned - weight)[moving])
    with working_precision(96):
        field = sticking_field(
            field_of(rubbing_graph(sizes, pull), lengths, sizes), frozenset(held)
        )
        inputs = [arb(value) for value in (*u, 0, 0, 0)]
        found = field.acceleration([arb(value) for value in x], inputs)
    assert np.array([float(item) for item in found]) == pytest.approx(wanted, abs=1e-12)


def test_what_inputs_add_is_the_mean_sign_of_the_rate() -> None:
    """By quadrature: sliding one way, turning back within a step, at rest."""
    friction = [F(1, 2), F(1, 3)]
    numeric = NumericRobot(rubbing_graph(friction, (F(0), F(-1))))
    rates = np.array([[0.0, 0.0], [0.8, 0.0], [-0.4, 0.0], [-0.5, -0.3]])
    x = np.concatenate([np.zeros((4, 2)), rates], axis=1)
    planned = Trajectory(x, np.zeros((3, 2)), np.array([1.2, 0.7]))
    found = friction_inputs(numeric, planned)
    for step in range(3):
        for joint in range(2):
            v, w = rates[step, joint], rates[step + 1, joint]
            mean = quad(lambda s: np.sign(v + s * (w - v)), 0, 1, points=[abs(v) / 1.2])[0]  # noqa: B023
            assert found[step, joint] == pytest.approx(float(friction[joint]) * mean, abs=1e-5)


def test_nothing_is_added_at_rest() -> None:
    numeric = NumericRobot(rubbing_graph([F(1, 2), F(1, 3)], (F(0), F(-1))))
    x = np.zeros((3, 4))
    x[:, 2], x[1, 3] = [0.9 * AT_REST, -0.9 * AT_REST, 0.0], 0.5
    planned = Trajectory(x, np.zeros((2, 2)), np.array([1.2, 0.7]))
    assert friction_inputs(numeric, planned)[:, 0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_motions_in_floats_are_those_of_the_oracle(seed: int) -> None:
    rng = np.random.default_rng(seed)
    friction = [F(int(x), 100) for x in rng.integers(5, 60, 2)]
    numeric = NumericRobot(rubbing_graph(friction, (F(1, 2), F(-2))))
    lengths = np.array([1.3, 0.8])
    u = rng.uniform(-2, 2, (6, 2))
    x = np.concatenate([rng.uniform(-1, 1, 2), rng.uniform(-0.5, 0.5, 2) * [0, 1]])
    found = rubbing_motion(numeric, Trajectory(x[None, :], u, lengths), 0.2)
    chain = RubbingChain(lengths, [0.5, -2.0], np.array(friction, float))
    for row, state in zip(u, found[1:], strict=True):
        x = chain.moved(x, row, 0.2)
        assert state == pytest.approx(x, abs=1e-7)


JOINTS = """\
module Big { role joint;
  dof q: revolute z in [-170, 170] deg rate in [-3, 3] rad/s effort <= 12 N*m;
  drive q: coulomb 0.7 N*m; }
module Small { role joint; dof q: revolute z in [-170, 170] deg effort <= 5 N*m;
  drive q: coulomb 0.25 N*m; }
"""
TASK = "gravity (0, -2) m/s^2; horizon 10 steps of 0.2 s;"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    asked = f"reach T at rest for 0.3 s; control open loop; {TASK}"
    return synthesised(tmp_path_factory.mktemp("friction"), rod_pair(JOINTS, asked))


def test_a_design_moves_as_was_proved(folder: Path) -> None:
    """An integrator by hand, from event to event, stays in the tube and rests where it is asked."""
    assert verify_directory(folder).outcome is Outcome.VALID
    certificate = result_files.read(folder)
    known = certified_tube(folder)
    chain = RubbingChain(
        np.array([0.6, 0.45]), [0.0, -2.0], np.array([0.7, 0.25]), np.array([1.0, 2.0])
    )
    x = np.array([float(value) for value in certificate["start"]])
    for step, row in enumerate(certificate["inputs"]):
        x = chain.moved(x, np.array([float(value) for value in row]), 0.2)
        outside, _ = known.distances(np.array([0.2 * (step + 1)]), x[None, :])
        assert outside.max() < 1e-6
    assert np.abs(x[2:]).max() < 1e-3
    tip = [0.6 * np.cos(x[0]) + 0.45 * np.cos(x[0] + x[1]),
           0.6 * np.sin(x[0]) + 0.45 * np.sin(x[0] + x[1])]  # fmt: skip
    assert -0.3 <= tip[0] <= 0.2
    assert 0.6 <= tip[1] <= 0.9


@pytest.mark.parametrize("size", ["0", "11/10"])
def test_the_same_inputs_do_not_do_with_other_friction(folder: Path, size: str) -> None:
    """Without friction, and with more of it than was taken into account."""
    claimed = claimed_task(folder, read_claim(folder))
    assert isinstance(claimed.claim, FoundClaim)
    robot = claimed_robot(claimed.claim, claimed.program, claimed.task)
    first, second = robot.model.dofs
    other = replace(first, coulomb=ir.Num(F(size)) if F(size) else None)
    model = replace(robot.model, dofs=(other, second))
    scene = scene_of(claimed.program, claimed.task, model, claimed.cells, robot.derivation)
    worst = decisive(prove_motion(scene, robot.motion))
    assert worst is not None
    assert worst.status is Status.FAILS


def disturbed_flywheel() -> str:
    """It turns by a quarter, and is slow at the end."""
    text = replaced(
        geared_arm.FLYWHEEL,
        "target T box [-0.3, 0.3] x [-0.3, 0.3] m",
        "target T box [-0.1, 0.1] x [0.2, 0.3] m",
    )
    asked = (
        "reach T rates <= 0.05 rad/s; control feedback; robust start 0.2 deg, 0.2 deg/s; "
        "robust effort 0.2 % of bound; horizon 16 steps of 0.125 s;"
    )
    return replaced(text, "reach T; horizon 10 steps of 0.125 s;", asked)


def disturbed_arm() -> str:
    """The arm of two rods of ``specs``, with dry friction on its joints."""
    text = (ROOT / "specs" / "robust_arm.srg").read_text(encoding="utf-8")
    drive = "deg; drive q: coulomb 0.3 N*m; }"
    text = replaced(text, "revolute z in [-160, 160] deg; }", f"revolute z in [-160, 160] {drive}")
    return replaced(text, "effort <= 10 N*m;", "effort <= 10 N*m; control feedback;")


@pytest.mark.slow
@pytest.mark.parametrize("text", [disturbed_flywheel, disturbed_arm])
def test_all_disturbed_motions_against_dry_friction(
    tmp_path: Path, text: Callable[[], str]
) -> None:
    folder = synthesised(tmp_path, text())
    assert verify_directory(folder).outcome is Outcome.VALID


CRANE = """\
module Rail { role base; }
module Lift { role joint; dof s: prismatic y in [-2, 2] m effort <= 5 N; DRIVE }
module Hook { role effector; }
grammar Crane { start N; all: N -> Rail Lift Hook; }
semantics Crane {
  all { this.frame = move(y, Lift.s); point(frame: this.frame, mass: 1 kg);
    effector(frame: this.frame); }
}
workspace Shaft {
  plane xy;
  bounds box [-1, 1] x [-2, 2] m;
  region Top box [-0.1, 0.1] x [0.9, 1.1] m;
  target Bottom box [-0.1, 0.1] x [-0.1, 0.1] m;
}
task Lower {
  robot Crane; workspace Shaft; start in Top at restHELD; reach Bottom at rest;
  gravity (0, -9.81) m/s^2; horizon 20 steps of 0.1 s;
}
"""
IMPOSSIBLE, UNKNOWN = 3, 4


@pytest.mark.parametrize("held", ["", " held"])
def test_a_drive_that_only_friction_helps_to_brake_is_not_refuted(
    tmp_path: Path, held: str
) -> None:
    """5 N do not hold 9.81 N; with 6 N of friction the load rests, falls with 3.81 and brakes."""
    for drive, code in (("", IMPOSSIBLE), ("drive s: coulomb 6 N;", UNKNOWN)):
        spec = tmp_path / "crane.srg"
        spec.write_text(CRANE.replace("DRIVE", drive).replace("HELD", held), encoding="utf-8")
        assert quiet("synth", spec, "-o", tmp_path / "out", "-q", "--force") == code


CART = """\
module B { role base; }
module P { role joint; dof s: prismatic x in [0, 2] m; drive s: coulomb FRICTION N; }
module J { role joint; dof q: revolute z in [-170, 170] deg; drive q: coulomb 0.1 N*m; }
module L { role link; param length in [0.4, 0.7] m; }
module E { role effector; }
grammar G { start N; all: N -> B P J L E; }
semantics G {
  all {
    this.cart = move(x, P.s);
    this.arm = this.cart * rot(z, J.q);
    point(frame: this.cart, mass: 2 kg);
    rod(frame: this.arm, axis: x, length: L.length, density: 2 kg/m);
    effector(frame: this.arm * move(x, L.length));
  }
}
workspace W {
  plane xy;
  bounds box [-1, 3] x [-2, 2] m;
  region Home box [0.4, 0.9] x [-0.2, 0.2] m;
  target T box [1, 1.5] x [0.2, 0.6] m;
}
task Go {
  robot G; workspace W; start in Home at rest; reach T at rest; effort <= 10 N*m; effort <= 40 N;
  horizon 15 steps of 0.1 s;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("friction", ["40", "60"])
def test_nothing_is_found_with_inputs_beyond_their_bounds(tmp_path: Path, friction: str) -> None:
    """What friction takes is all that there is, or more: the cart moves for the arm beside it."""
    spec = tmp_path / "cart.srg"
    spec.write_text(CART.replace("FRICTION", friction), encoding="utf-8")
    status = quiet("synth", spec, "-o", tmp_path / "out", "-q", "--time-limit", 25)
    assert status in (0, UNKNOWN)
    assert status == UNKNOWN or verify_directory(tmp_path / "out").outcome is Outcome.VALID
