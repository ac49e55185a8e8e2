"""Robots whose effectors' frames matter: what of them is kept, and where their axes point."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.frame_table import SemanticsError
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot_key import robot_key
from compiler.words.structures import structures
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load_text
from solvers.verifier.proofs.scene import scene_of
from srgc.session import check_loaded
from tests.oracles.formulas import program
from tests.oracles.small_specs import TURNER, replaced

WRIST = """\
module B { role base; }
module Z { role joint; dof q: revolute z in [-170, 170] deg; }
module Y { role joint; dof q: revolute -y in [-170, 170] deg; }
module L { role link; const length = 0.6 m; }
module E { role effector; }
grammar Arm { start N; base: N -> B; roll: N -> N Z; lift: N -> N Y; link: N -> N L; tool: N -> N E;
  accept matches B Z L Y L Z E; }
semantics Arm {
  base { this.frame = world; }
  roll { this.frame = N.frame * rot(z, Z.q); }
  lift { this.frame = N.frame * rot(-y, Y.q); }
  link { this.frame = N.frame * move(x, L.length) * rot(x, 40 deg);
    rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m);
    SHAPE }
  tool { this.frame = N.frame; effector(frame: N.frame * rot(y, 90 deg)); }
}
workspace W {
  space xyz;
  bounds box [-3, 3] x [-3, 3] x [-3, 3] m;
  region S box [0, 1] x [0, 1] x [0, 1] m;
  target T box [-1, 0] x [0, 1] x [0, 1] m;
}
task P { robot Arm; workspace W; start in S; reach T POSE; effort <= 9 N*m;
  horizon 9 steps of 0.1 s; }
"""
POSE = "aligned z to (0, 0, -1) within 5 deg"


def family(pose: str, shape: str = "") -> RobotFamily:
    found = program(WRIST.replace("POSE", pose).replace("SHAPE", shape))
    return family_of(found, found.tasks["P"])


def numeric(pose: str, shape: str = "") -> NumericRobot:
    robots = family(pose, shape)
    (derivation,) = structures(robots.language, 7)
    model = robots.robot(derivation)
    return NumericRobot(robot_graph(model, (Fraction(0),) * 3))


def test_a_joint_that_only_turns_the_hand_is_kept_where_that_matters() -> None:
    posed, plain = numeric(POSE), numeric("")
    assert posed.n == 3
    assert plain.n == 2
    assert robot_key(posed.graph.model) != robot_key(plain.graph.model)


@pytest.mark.parametrize("shape", ["", "box(frame: N.frame, size: (1, 2, 3) cm);"])
def test_axes_of_the_hand(shape: str) -> None:
    found = numeric(POSE, shape)
    first = len(found.graph.model.effectors)
    rng = np.random.default_rng(3)
    for q in rng.uniform(-2, 2, (20, 3)):
        places = found.positions(q[None], np.zeros(0))[0]
        turned = Rotation.from_euler("z", q[0]) * Rotation.from_euler("x", 40, degrees=True)
        turned = turned * Rotation.from_euler("y", -q[1]) * Rotation.from_euler("x", 40, True)
        turned = turned * Rotation.from_euler("z", q[2]) * Rotation.from_euler("y", 90, True)
        (axes,) = found.spanning.axes
        columns = np.array([places[first + number] for number in axes]).T
        np.testing.assert_allclose(columns, turned.as_matrix(), atol=1e-12)
    assert numeric("", shape).spanning.axes == ()


def test_payloads_of_robots() -> None:
    """The robot with a payload is the one whose tool is so heavy."""
    single = replaced(TURNER, "accept contains EN and", "accept count(EN) == 1 and")
    loaded = program(replaced(single, "reach T;", "reach T; payload 1 kg;"))
    tool = "effector(frame: N.frame); }"
    heavy = program(replaced(single, tool, f"point(frame: N.frame, mass: 1 kg); {tool}"))
    one, two = (family_of(each, each.tasks["Turn"]) for each in (loaded, heavy))
    for a, b in zip(structures(one.language, 7), structures(two.language, 7), strict=True):
        assert a.word == b.word
        models = one.robot(a), two.robot(b)
        assert models[0].payloads == (len(models[0].bodies) - 1,)
        graphs = [robot_graph(model, (Fraction(-1), Fraction(2))) for model in models]
        robots = [NumericRobot(graph) for graph in graphs]
        n, p = robots[0].n, robots[0].p
        assert n == robots[1].n
        q, theta = np.linspace(0.3, 1.1, n)[None], np.linspace(1.1, 1.7, p)
        masses = [robot.mass_matrix(q, theta) for robot in robots]
        np.testing.assert_allclose(*masses, rtol=1e-13)


def test_a_payload_without_its_effector() -> None:
    found = program(replaced(TURNER, "reach T;", "reach T; payload 1 kg by effector 2;"))
    robots = family_of(found, found.tasks["Turn"])
    derivation = next(iter(structures(robots.language, 7)))
    with pytest.raises(SemanticsError, match="no effector 2 to carry"):
        robots.robot(derivation)
    found = program(replaced(TURNER, "reach T;", "reach T; payload 1 kg;"))
    robots = family_of(found, found.tasks["Turn"])
    several = next(d for d in structures(robots.language, 7) if d.word.count("EN") == 2)
    with pytest.raises(SemanticsError, match="not said which effector"):
        robots.robot(several)


def test_bodies_keep_their_names_beside_a_payload() -> None:
    text = replaced(TURNER, "accept contains EN and", "accept count(EN) == 1 and")
    text = replaced(text, "reach T;", "reach T; payload 1 kg;")
    text = replaced(text, "avoid O with effector", "avoid O with body")
    text = replaced(
        text,
        "rod(frame",
        "solid(frame: N.frame, mass: 1 kg, com: (0, 0, 0) m, inertia: 1 kg*m^2); rod(frame",
    )
    found = load_text(text, "spec.srg")
    assert check_loaded(found).program is not None
    assert found.program is not None
    task = found.program.tasks["Turn"]
    robots = family_of(found.program, task)
    derivation = next(d for d in structures(robots.language, 7) if "L" in d.word)
    model = robots.robot(derivation)
    cells = abstract(found.program.workspaces[task.workspace])
    scene = scene_of(found.program, task, model, cells, derivation)
    assert [scene.body(number) for number in range(len(model.colliders))] == [
        "body 1 (L at symbol 4)",
        "body 2 (L at symbol 4)",
    ]
