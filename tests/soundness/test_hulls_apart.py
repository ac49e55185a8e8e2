"""An arm of meshes, found and proved, held against MuJoCo's own distances of the meshes.

The margin that the task asks for is then moved to just below and just above what MuJoCo finds: the
same motion is proved with the one, and not with the other.
"""

from __future__ import annotations

import shutil
from itertools import combinations
from pathlib import Path

import mujoco
import numpy as np
import pytest

from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.command_line import quiet
from tests.oracles.exported_motions import replay
from tests.oracles.mesh_files import WEDGE, binary_stl, tube

SPEC = """\
module Foot  { role base; }
module Spin  { role joint; dof q: revolute z in [-170, 170] deg; }
module Elbow { role joint; dof q: revolute y in [-150, 150] deg rate in [-4, 4] rad/s; }
module Hand  { role effector; }
grammar Arm {
  start N;
  foot: N -> Foot; spin: N -> N Spin; upper: N -> N Elbow; fore: N -> N Elbow; hand: N -> N Hand;
  accept matches Foot Spin Elbow Elbow Hand;
}
semantics Arm {
  foot { this.frame = move(z, 36 cm);
         hull(frame: world * rot(y, -90 deg), file: "tube.stl", scale: 1 mm); }
  spin { this.frame = N.frame * rot(z, Spin.q);
         solid(frame: this.frame, mass: 1 kg, com: (0, 0, 0) m,
               inertia: (0.01, 0.01, 0.01, 0, 0, 0) kg*m^2); }
  upper { let f = N.frame * rot(y, Elbow.q); this.frame = f * move(x, 35 cm);
          solid(frame: f, mass: 1 kg, com: (15, 0, 0) cm,
                inertia: (0.002, 0.03, 0.03, 0, 0, 0) kg*m^2);
          hull(frame: f * rot(x, 20 deg), file: "tube.stl", scale: 1 mm); }
  fore { let f = N.frame * rot(y, Elbow.q); this.frame = f * move(x, 27 cm);
         solid(frame: f, mass: 1 kg, com: (12, 0, 0) cm,
               inertia: (0.002, 0.01, 0.01, 0, 0, 0) kg*m^2);
         hull(frame: f * rot(x, 50 deg), file: "wedge.obj", scale: 1 mm); }
  hand { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Cell {
  space xyz;
  bounds box [-1.5, 1.5] x [-1.5, 1.5] x [-0.3, 1.5] m;
  region R box [0.1, 0.25] x [-0.1, 0.1] x [0.05, 0.15] m;
  target T box [-0.1, 0.1] x [0.1, 0.25] x [0.05, 0.15] m;
  obstacle Post box [0.2, 0.24] x [0.2, 0.24] x [0, 0.1] m;
}
task Move {
  robot Arm; workspace Cell;
  start in R at rest; reach T;
  avoid Post with body, margin 5 mm;
  avoid self with body, margin MARGIN m;
  gravity (0, 0, -9.81) m/s^2;
  effort <= 40 N*m;
  horizon 12 steps of 0.1 s;
}
"""
POST = np.array([[x, y, z] for x in (0.2, 0.24) for y in (0.2, 0.24) for z in (0.0, 0.1)])
MARGIN = 0.005
ASKED = "shape 1 to shape 2", "shape 1 to shape 3"
"""Those of the foot, 48 corners, with the upper link, as many, and the fore link, 8."""
HARD = 3
"""The group of geoms that collide."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scratch = tmp_path_factory.mktemp("hulls_apart")
    (scratch / "tube.stl").write_bytes(binary_stl(tube()))
    (scratch / "wedge.obj").write_text(WEDGE, encoding="utf-8")
    (scratch / "spec.srg").write_text(SPEC.replace("MARGIN", str(MARGIN)), encoding="utf-8")
    assert quiet("synth", scratch / "spec.srg", "-o", scratch / "out", "-q") == 0
    return scratch / "out"


@pytest.fixture(scope="module")
def least(folder: Path) -> dict[str, float]:
    """The least distances in MuJoCo of meshes from each other and from the post, by their names."""
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported) == 0
    text = exported.read_text(encoding="utf-8")
    states = replay(text, result_files.read(folder)).states
    spec = mujoco.MjSpec.from_string(text)
    mesh = spec.add_mesh(name="post")
    mesh.uservert = POST.ravel().tolist()
    post = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="post", group=HARD)
    post.name = "post"
    model = spec.compile()
    model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-9, 300
    data, found = mujoco.MjData(model), dict[str, float]()
    hard = [geom for geom in range(model.ngeom) if model.geom_group[geom] == HARD]
    assert len(hard) == 4
    foot, other, *links = sorted(hard, key=lambda geom: int(model.geom_bodyid[geom]))
    if model.geom(foot).name == "post":
        foot, other = other, foot
    names = {foot: "shape 1", links[0]: "shape 2", links[1]: "shape 3", other: "Post"}
    for state in states[np.linspace(0, len(states) - 1, 1000).astype(int)]:
        data.qpos[:] = state[: model.nq]
        mujoco.mj_kinematics(model, data)
        for one, two in combinations([*links, foot, other], 2):
            pair = " to ".join(sorted([names[one], names[two]], key=lambda n: (n == "Post", n)))
            apart = mujoco.mj_geomDistance(model, data, one, two, 5.0, None)
            found[pair] = min(found.get(pair, np.inf), apart)
    return found


def conditions(folder: Path) -> dict[str, CheckedCondition]:
    """By the names of the two, without those of modules; those of shapes alone."""
    found = {}
    for each in verify_directory(folder).conditions:
        if each.name.startswith("clearance of ") and "body" not in each.name:
            names = each.name.removeprefix("clearance of ").split(" to ")
            found[" to ".join(name.split(" (")[0] for name in names)] = each
    return found


@pytest.mark.slow
def test_margins_are_those_of_mujoco(folder: Path, least: dict[str, float]) -> None:
    assert verify_directory(folder).outcome is Outcome.VALID
    told = conditions(folder)
    assert {*ASKED, "shape 1 to Post", "shape 2 to Post", "shape 3 to Post"} == set(told)
    for pair, condition in told.items():
        distance = least[pair] - MARGIN
        assert condition.margin <= distance + 2e-6
        assert condition.margin >= 0.97 * distance - 1e-3
    assert min(least[pair] for pair in told) > MARGIN


@pytest.mark.slow
@pytest.mark.parametrize("off", [-3e-4, 3e-5, 1e-3])
def test_the_same_motion_with_another_margin(
    folder: Path, least: dict[str, float], off: float, tmp_path: Path
) -> None:
    """Just below the least distance it is proved, just above it never; far above it is refuted."""
    pairs = {pair: distance for pair, distance in least.items() if "Post" not in pair}
    nearest = min(pairs, key=lambda pair: pairs[pair] if pair in ASKED else np.inf)
    asked = f"margin {pairs[nearest] + off:.9f} m"
    copy = shutil.copytree(folder, tmp_path / "copy")
    (copy / "design.json").unlink()  # It tells of the spec as it was.
    result_files.alter_spec(copy, f"margin {MARGIN} m", asked, sign=True)
    told = conditions(copy)
    status = told[nearest].status
    if off < 0:
        assert {each.status for each in told.values()} == {Status.HOLDS}
        assert 0 < told[nearest].margin < -off + 1e-5
    else:
        assert status is not Status.HOLDS
    if off >= 1e-3:
        assert status is Status.FAILS
