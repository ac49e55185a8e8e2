"""The mass that moves with an effector, against mass matrices at random poses and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

from compiler.arrays import Array
from compiler.dynamics.energy_graph import EnergyGraph, energy_graph
from compiler.expressions.evaluators.balls import constant_ball, working_precision
from compiler.expressions.evaluators.intervals import INTERVALS, around
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_reach import DriveReach, drive_reach, out_of_reach
from compiler.unreachability.box_tree import Part
from compiler.unreachability.covered_poses import CoveredPoses
from compiler.unreachability.motion_conditions import motion_conditions
from tests.oracles.driven_chains import robot_of, uniform

ARM = """
module B { role base; port out: P; frame out = in; }
module L {
  role link;
  dof q: revolute z in [-150, 150] deg;
  param length in [0.4, 0.7] m;
  port in: P; port out: P;
  frame joint = in * rot(z, q);
  frame out = joint * move(x, length);
  BODY
}
module H { role effector; port in: P; HAND effector(frame: in); }
grammar G from ports { start B; with L, H; accept count(L) == 2; }
workspace W { SPACE bounds box BOUNDS m; target T box TARGET m; }
task P { robot G; workspace W; start at (0, 0); reach T; PAYLOAD effort <= 5 N*m;
  horizon 1 steps of STEP s; }
"""
ROD = "rod(frame: joint, axis: x, length: length, density: 1.5 kg/m);"
LENGTHS = np.array([0.5, 0.45])
"""The lengths at which masses are compared."""


def arm(body: str = ROD, hand: str = "", payload: str = "", step: str = "0.05") -> str:
    text = ARM.replace("BODY", body).replace("HAND", hand).replace("PAYLOAD", payload)
    text = text.replace("SPACE", "plane xy;").replace("BOUNDS", "[-2, 2] x [-2, 2]")
    return text.replace("TARGET", "[-0.2, 0.2] x [0.7, 0.9]").replace("STEP", step)


def values(
    model: RobotModel, graph: EnergyGraph, q: Array, theta: Array
) -> tuple[Array, Array, list[float]]:
    """The mass matrix, the Jacobian of the effector, and what moves with it, at one pose."""
    inputs = [*map(arb, q.tolist()), *map(arb, theta.tolist())]
    sides = [around(x) for x in (*inputs, *map(constant_ball, graph.constants))]
    n, d = len(model.dofs), model.dimension
    mass = np.array([float(x.low) for x in graph.mass.evaluate(sides, INTERVALS)]).reshape(n, n)
    places = [float(x.low) for x in graph.effectors.evaluate(sides, INTERVALS)]
    carried = [float(x.low) for x in graph.carried.evaluate(sides, INTERVALS)]
    return mass, np.array(places[d:]).reshape(n, d).T, carried


CASES = [
    (arm(), 1.5 * 0.45 / 4),
    (arm(hand="point(frame: in, mass: 300 g);"), 0.3 + 1.5 * 0.45 / 4),
    (arm(payload="payload 2 kg;"), 2 + 1.5 * 0.45 / 4),
    (arm(hand="solid(frame: in, mass: 1 kg, com: (0, 0, 0) m, inertia: 0.01 kg*m^2);"),
     1 + 1.5 * 0.45 / 4),
    # Nothing is known of a body whose centre is elsewhere, nor of rods that end elsewhere.
    (arm(hand="solid(frame: in, mass: 1 kg, com: (0.1, 0, 0) m, inertia: 0.01 kg*m^2);"),
     1.5 * 0.45 / 4),
    (arm("rod(frame: joint, axis: x, length: 0.9 * length, density: 1.5 kg/m);"), 0),
    (arm("rod(frame: out, axis: -x, length: length, density: 1.5 kg/m);"), 1.5 * 0.45 / 4),
    (arm(ROD + "drive q: rotor 0.02 kg*m^2;"), 1.5 * 0.45 / 4),
]  # fmt: skip


@pytest.mark.parametrize(("text", "wanted"), CASES)
def test_no_pose_moves_the_hand_with_less_mass(text: str, wanted: float) -> None:
    """1 / (n J M^-1 J' n) is the mass that a push along n feels: never less than what is said."""
    model, _, task = robot_of(text)
    graph = energy_graph(model, task.gravity)
    rng = np.random.default_rng(4)
    felt = list[float]()
    for _ in range(300):
        mass, slope, carried = values(model, graph, rng.uniform(-2.6, 2.6, 2), LENGTHS)
        assert carried[0] == pytest.approx(wanted, rel=1e-12)
        felt.append(1 / np.linalg.eigvalsh(slope @ np.linalg.solve(mass, slope.T)).max())
    assert min(felt) >= wanted * (1 - 1e-9)


def refuted(text: str, boxes: list[Part], halvings: tuple[int, int]) -> bool:
    model, workspace, task = robot_of(text)
    with working_precision(64):
        poses = CoveredPoses(motion_conditions(model, workspace, task))
        cover = poses.cover(poses.parameters_of(tuple(boxes)), uniform(halvings))
        drive = drive_reach(model, workspace, task)
        ((passage,),) = poses.demands.passages
        found = out_of_reach(drive, passage, cover.parameters, cover.leaves(passage))
    return found is not None


def test_a_mass_that_may_be_negative_bounds_nothing() -> None:
    """With a negative mass elsewhere, the whole may have less energy than the hand."""
    for less, known in (("0.3", False), ("0.1", True)):
        own = f"param m in [0.2, 0.5] kg; {ROD} point(frame: joint, mass: m - {less} kg);"
        text = arm(own, hand="point(frame: in, mass: 300 g);")
        model, workspace, task = robot_of(text)
        with working_precision(64):
            drive = drive_reach(model, workspace, task)
            poses = CoveredPoses(motion_conditions(model, workspace, task))
            parameters = poses.parameters_of(tuple(Part() for _ in model.parameters))
            tail = [*parameters, *(around(constant_ball(c)) for c in drive.graph.constants)]
            (mass,) = drive.carried(tail)
        assert (mass > 0) is known


def test_a_light_hand_is_held_back_by_what_it_carries(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lengths vary, so M^-1 is bounded poorly; 0.9 m in 0.05 s takes 216 N for 0.3 kg alone."""
    lower = Part().halves()[0].halves()[0].halves()[0]
    weak = arm(hand="point(frame: in, mass: 300 g);").replace("effort <= 5", "effort <= 15")
    assert refuted(weak, [lower, lower], (1, 5))
    assert not refuted(weak.replace("effort <= 15", "effort <= 4000"), [lower, lower], (1, 5))
    monkeypatch.setattr(DriveReach, "carried", lambda *_: [arb(0)])
    assert not refuted(weak, [lower, lower], (1, 5))
