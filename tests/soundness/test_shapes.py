"""Robots with shapes, found and proved, replayed in MuJoCo with its own distances of geoms."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import mujoco
import numpy as np
import pytest

from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.exported_motions import replay

SPEC = """\
module Foot  { role base; }
module Spin  { role joint; dof q: revolute z in [-170, 170] deg; }
module Elbow { role joint; dof q: revolute y in [-150, 150] deg rate in [-4, 4] rad/s; }
module Upper { role link; const length = 0.6 m; const mass = 1.5 kg; }
module Fore  { role link; const length = 0.4 m; const mass = 1 kg; }
module Hand  { role effector; }
grammar Arm {
  start N;
  foot: N -> Foot; spin: N -> N Spin; turn: N -> N Elbow; upper: N -> N Upper; fore: N -> N Fore;
  hand: N -> N Hand;
  accept matches Foot Spin Elbow Upper Elbow Fore Hand;
}
semantics Arm {
  foot { this.frame = move(z, 30 cm);
         cylinder(frame: world, axis: z, length: 25 cm, radius: 10 cm); }
  spin { this.frame = N.frame * rot(z, Spin.q); sphere(frame: this.frame, radius: 8 cm);
         solid(frame: this.frame, mass: 1 kg, com: (0, 0, 0) m,
               inertia: (0.01, 0.01, 0.01, 0, 0, 0) kg*m^2); }
  turn { this.frame = N.frame * rot(y, Elbow.q); }
  upper { this.frame = N.frame * move(x, Upper.length);
          rod(frame: N.frame, axis: x, length: Upper.length, density: Upper.mass / Upper.length);
          box(frame: N.frame * move(x, Upper.length / 2), size: (56, 8, 6) cm); }
  fore { this.frame = N.frame * move(x, Fore.length);
         solid(frame: N.frame, mass: Fore.mass, com: (20, 0, 0) cm,
               inertia: (0.002, 0.03, 0.03, 0, 0, 0) kg*m^2);
         cylinder(frame: N.frame * rot(z, 3 deg), axis: x, length: 35 cm, radius: 4 cm); }
  hand { this.frame = N.frame; capsule(frame: N.frame, axis: -x, length: 6 cm, radius: 5 cm);
         effector(frame: N.frame); }
}
workspace Cell {
  space xyz;
  bounds box [-1.5, 1.5] x [-1.5, 1.5] x [-0.3, 1.5] m;
  region R box [0.5, 0.7] x [-0.1, 0.1] x [0.1, 0.3] m;
  obstacle Wall polytope { 3*x + y <= 1.9; 3*x + y >= 1.1; y >= 0.30; y <= 0.38; z >= -0.3;
                           z <= 0.35; } m;
  target T box [0, 0.2] x [0.5, 0.7] x [0.15, 0.35] m;
}
task Move {
  robot Arm; workspace Cell;
  start in R at rest; reach T;
  avoid Wall with body, margin 5 mm;
  avoid self with body, margin 5 mm;
  bounds with body;
  gravity (0, 0, -9.81) m/s^2;
  effort <= 40 N*m;
  horizon 16 steps of 0.1 s;
}
"""
WALL = np.array([[x, y, z] for y in (0.30, 0.38) for x in ((1.1 - y) / 3, (1.9 - y) / 3)
                 for z in (-0.3, 0.35)])  # fmt: skip
INSTANTS = 1000
HARD = 3
"""The group of geoms that collide."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthesised(tmp_path_factory.mktemp("shapes"), SPEC)


@pytest.fixture(scope="module")
def least(folder: Path) -> dict[tuple[str, str], float]:
    """The least distances in MuJoCo of what is on different bodies, and from the wall.

    Pairs are named by the kinds of the two geoms.
    """
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported) == 0
    text = exported.read_text(encoding="utf-8")
    states = replay(text, result_files.read(folder)).states
    instants = np.linspace(0, len(states) - 1, INSTANTS).astype(int)
    spec = mujoco.MjSpec.from_string(text)
    mesh = spec.add_mesh(name="wall")
    mesh.uservert = WALL.ravel().tolist()
    wall = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="wall", group=HARD)
    wall.name = "wall"
    model = spec.compile()
    data, found = mujoco.MjData(model), dict[tuple[str, str], float]()
    excluded = {(int(each) >> 16, int(each) & 0xFFFF) for each in model.exclude_signature}
    hard = [geom for geom in range(model.ngeom) if model.geom_group[geom] == HARD]
    names = {geom: mujoco.mjtGeom(model.geom_type[geom]).name[7:].lower() for geom in hard}
    for state in states[instants]:
        data.qpos[:] = state[: model.nq]
        mujoco.mj_kinematics(model, data)
        for one, two in combinations(hard, 2):
            bodies = int(model.geom_bodyid[one]), int(model.geom_bodyid[two])
            allowed = bodies[0] == bodies[1] or bodies in excluded or bodies[::-1] in excluded
            if allowed and "mesh" not in {names[one], names[two]}:
                continue
            apart = mujoco.mj_geomDistance(model, data, one, two, 5.0, None)
            pair = names[one], names[two]
            pair = pair[::-1] if pair[0] == "mesh" else pair
            found[pair] = min(found.get(pair, np.inf), apart)
    return found


@pytest.fixture(scope="module")
def proved(folder: Path) -> dict[str, CheckedCondition]:
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    return {each.name: each for each in report.conditions}


SHAPES = {1: "cylinder", 2: "sphere", 3: "box", 4: "cylinder", 5: "capsule"}
"""The shapes by their numbers in reports: of foot, spin, upper, fore and hand."""


@pytest.mark.slow
def test_margins_are_those_of_mujoco(
    least: dict[tuple[str, str], float], proved: dict[str, CheckedCondition]
) -> None:
    """Nothing touches, and every margin is at most the least distance, and close to it."""
    assert min(least.values()) > 0.005
    told = dict[tuple[str, str], float]()
    for name, condition in proved.items():
        if not name.startswith("clearance of shape"):
            continue
        first, second = name.removeprefix("clearance of ").split(" to ")
        pair = (
            SHAPES[int(first.split()[1])],
            ("mesh" if second == "Wall" else SHAPES[int(second.split()[1])]),
        )
        told[pair] = min(told.get(pair, np.inf), condition.margin + 0.005)
    assert told.keys() == least.keys()
    for pair, distance in least.items():
        assert told[pair] <= distance + 1e-5
        assert told[pair] >= 0.95 * distance - 1e-3


@pytest.mark.slow
def test_a_thicker_hand_is_refuted(folder: Path, least: dict[tuple[str, str], float]) -> None:
    """The same motion with a capsule that is 2 mm too thick for the distance that it keeps."""
    room = min(apart for pair, apart in least.items() if "capsule" in pair)
    radius = 0.05 + room - 0.005 + 0.002
    changed = f"capsule(frame: N.frame, axis: -x, length: 6 cm, radius: {radius:.6f} m)"
    old = "capsule(frame: N.frame, axis: -x, length: 6 cm, radius: 5 cm)"
    result_files.alter_spec(folder, old, changed, sign=True)
    report = verify_directory(folder)
    result_files.alter_spec(folder, changed, old, sign=True)
    assert report.outcome is Outcome.REFUTED
    assert "clearance of shape 5" in str(report.reason) or "shape 5" in str(report.reason)
