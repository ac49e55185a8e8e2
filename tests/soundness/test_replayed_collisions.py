"""Proved motions replayed in MuJoCo's dynamics: no contact in its checker, and none in Coal's.

1,000 instants of an arm in space whose links are boxes, capsules, cylinders, spheres and hulls of
meshes, beside obstacles and itself, and of a UR5.  The robot is what is exported, its controller
what the certificate says; the obstacles and the pairs that may touch are stated here again.
"""

from __future__ import annotations

import contextlib
import csv
import io
from collections.abc import Callable, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.mesh_files import WEDGE, binary_stl, tube

SPEC = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; }
module K { role joint; dof q: revolute y in [-150, 150] deg; }
module U { role link; const length = 0.3 m; }
module F { role link; const length = 0.25 m; }
module E { role effector; }
grammar Arm { start N; all: N -> B J I:K U M:K F E; }
semantics Arm {
  all {
    this.at = move(z, 0.2 m) * rot(z, J.q) * rot(y, I.q);
    this.two = this.at * move(x, U.length) * rot(y, M.q);
    solid(frame: this.at, mass: 1 kg, com: (0.15, 0, 0) m,
      inertia: (0.001, 0.01, 0.01, 0, 0, 0) kg*m^2);
    solid(frame: this.two, mass: 0.6 kg, com: (0.12, 0, 0) m,
      inertia: (0.0005, 0.004, 0.004, 0, 0, 0) kg*m^2);
    UPPER
    FORE
    box(frame: world * move(z, 5 cm), size: (10, 12, 10) cm);
    effector(frame: this.two * move(x, F.length));
  }
}
workspace W {
  space xyz;
  bounds box [-2, 2] x [-2, 2] x [-1, 2] m;
  region S box [0.3, 0.5] x [-0.1, 0.1] x [0.1, 0.3] m;
  target T box [-0.1, 0.1] x [0.3, 0.5] x [0.2, 0.4] m;
  obstacle O box [0.3, 0.4] x [0.28, 0.4] x [0, 0.6] m;
  obstacle P ball (0.1, 0.2, 0.55) m radius 8 cm;
}
task Go {
  robot Arm; workspace W; start in S at rest; reach T at rest;
  avoid O, P with body, margin 5 mm; avoid self with body, margin 2 mm;
  effort <= 30 N*m; gravity (0, 0, -9.81) m/s^2; horizon 25 steps of 0.05 s;
}
"""
SHAPES = {
    "hulls": (
        'hull(frame: this.at, file: "tube.stl", scale: 1 mm);',
        'hull(frame: this.two, file: "wedge.obj", scale: 1 mm);',
    ),
    "round": (
        "capsule(frame: this.at, axis: x, length: 30 cm, radius: 25 mm);",
        (
            "cylinder(frame: this.two, axis: x, length: 20 cm, radius: 2 cm);"
            " sphere(frame: this.two * move(x, 22 cm), radius: 25 mm);"
        ),
    ),
}
ARMS = Path(__file__).parents[2] / "benchmarks" / "arms"
INSTANTS = 1000
"""Of all steps together."""
CLOSE = 5e-3
"""So far, in rad, is MuJoCo's integration from the one that was planned with."""


def replayed(folder: Path, horizon: float) -> tuple[mujoco.MjModel, np.ndarray]:
    """The exported robot, and its coordinates at the instants in MuJoCo's own integration."""
    exported = folder / "robot.xml"
    assert run(["export", str(folder), "--to", "mjcf", "-o", str(exported)]) == 0
    text = exported.read_text(encoding="utf-8").replace('contact="disable"', 'contact="enable"')
    model = mujoco.MjModel.from_xml_string(text)
    certificate = result_files.read(folder)
    data, start = mujoco.MjData(model), [float(x) for x in certificate["start"]]
    n = model.nq
    data.qpos, data.qvel = start[:n], start[n:]
    # Contacts are looked at, not felt: they are switched off while time passes.
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.timestep = horizon / INSTANTS
    found, inputs = [data.qpos.copy()], np.array(certificate["inputs"], float)
    claims = {claim["kind"]: claim for claim in certificate.get("claims", [])}
    controller = claims.get("controller")
    for step, row in enumerate(inputs):
        data.ctrl[:] = row
        if controller is not None:
            off = np.concatenate([data.qpos, data.qvel])
            off -= np.array(controller["reference"][step], float)
            data.ctrl[:] -= np.array(controller["gains"][step], float) @ off
        for _ in range(INSTANTS // len(inputs)):
            mujoco.mj_step(model, data)
            found.append(data.qpos.copy())
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return model, np.array(found)


def coal_shape(coal: Any, model: mujoco.MjModel, geom: int) -> Any:
    """What a geom of MuJoCo is in Coal."""
    size = model.geom_size[geom]
    match model.geom_type[geom]:
        case mujoco.mjtGeom.mjGEOM_BOX:
            return coal.Box(*(2 * size))
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return coal.Sphere(size[0])
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return coal.Capsule(size[0], 2 * size[1])
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return coal.Cylinder(size[0], 2 * size[1])
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            points = coal.StdVec_Vec3s()
            points.extend(model.mesh_vert[first : first + count].astype(float))
            return coal.Convex.convexHull(points, False, "")
    raise AssertionError(model.geom_type[geom])


def placed(coal: Any, rotation: np.ndarray, origin: np.ndarray) -> Any:
    return coal.Transform3s(np.asarray(rotation).reshape(3, 3), np.asarray(origin))


def least_gaps(
    coal: Any,
    model: mujoco.MjModel,
    motion: np.ndarray,
    apart: Callable[[int, int], bool],
    fixed: Sequence[tuple[Any, Any]] = (),
) -> dict[str, float]:
    """The least distances (m) of bodies ``apart``, by their places, and from fixed solids."""
    data = mujoco.MjData(model)
    hard = [g for g in range(model.ngeom) if model.geom_group[g] == 3]
    bodies = sorted({int(model.geom_bodyid[g]) for g in hard})
    place = {g: bodies.index(int(model.geom_bodyid[g])) for g in hard}
    solids = {g: coal_shape(coal, model, g) for g in hard}
    pairs = [(a, b) for a, b in combinations(hard, 2) if apart(*sorted((place[a], place[b])))]
    assert pairs
    least = {"self": np.inf, "obstacles": np.inf, "mujoco": np.inf}
    asked, answer = coal.DistanceRequest(), coal.DistanceResult()
    for q in motion:
        data.qpos = q
        mujoco.mj_forward(model, data)
        at = {g: placed(coal, data.geom_xmat[g], data.geom_xpos[g]) for g in hard}
        for one, other in pairs:
            answer.clear()
            gap = coal.distance(solids[one], at[one], solids[other], at[other], asked, answer)
            least["self"] = min(least["self"], gap)
            own = mujoco.mj_geomDistance(model, data, one, other, 1.0, None)
            least["mujoco"] = min(least["mujoco"], own)
        for g in hard:
            for solid, where in fixed:
                answer.clear()
                gap = coal.distance(solids[g], at[g], solid, where, asked, answer)
                least["obstacles"] = min(least["obstacles"], gap)
    return least


def found_motion(
    spec: Path, folder: Path, horizon: float, *options: str
) -> tuple[mujoco.MjModel, np.ndarray]:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(spec), "-o", str(folder), "-q", *options]) == 0
        assert verify_directory(folder).outcome is Outcome.VALID
        model, motion = replayed(folder, horizon)
    assert len(motion) == INSTANTS + 1
    with (folder / "trajectory.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    planned = np.array([[float(row[f"q{i + 1}"]) for i in range(model.nq)] for row in rows])
    assert np.abs(motion[:: INSTANTS // (len(rows) - 1)] - planned).max() < CLOSE
    return model, motion


@pytest.mark.slow
@pytest.mark.parametrize("shapes", sorted(SHAPES))
def test_no_contact_at_a_thousand_instants(tmp_path: Path, shapes: str) -> None:
    coal = pytest.importorskip("coal")
    (tmp_path / "tube.stl").write_bytes(binary_stl(tube()))
    (tmp_path / "wedge.obj").write_text(WEDGE, encoding="utf-8")
    upper, fore = SHAPES[shapes]
    text = SPEC.replace("UPPER", upper).replace("FORE", fore)
    (tmp_path / "s.srg").write_text(text, encoding="utf-8")
    model, motion = found_motion(tmp_path / "s.srg", tmp_path / "out", 25 * 0.05)
    fixed = [
        (coal.Box(0.1, 0.12, 0.6), placed(coal, np.eye(3), np.array([0.35, 0.34, 0.3]))),
        (coal.Sphere(0.08), placed(coal, np.eye(3), np.array([0.1, 0.2, 0.55]))),
    ]
    # One joint connects the upper link with the base (its wrist has no body), and with the fore.
    least = least_gaps(coal, model, motion, lambda a, b: (a, b) == (0, 2), fixed)
    # What is proved, less the difference of two integrations.
    assert least["self"] > 0.002 - 1e-4
    assert least["mujoco"] > 0.002 - 1e-4
    assert least["obstacles"] > 0.005 - 1e-4


@pytest.mark.slow
def test_a_ur5_keeps_out_of_itself(tmp_path: Path) -> None:
    """Seven links, of which each touches the next ones that one joint connects it with."""
    coal = pytest.importorskip("coal")
    model, motion = found_motion(ARMS / "ur5_shaped.srg", tmp_path / "out", 20 * 0.1)
    least = least_gaps(coal, model, motion, lambda a, b: b - a > 1)
    assert least["self"] > 0.002 - 1e-4
    assert least["mujoco"] > 0.002 - 1e-4


@pytest.mark.slow
def test_an_arm_of_modules_keeps_out_of_itself_and_of_a_desk(tmp_path: Path) -> None:
    coal = pytest.importorskip("coal")
    spec = ARMS / "timor_desk.srg"
    model, motion = found_motion(spec, tmp_path / "out", 20 * 0.1, "--task", "Careful")
    boxes = [((160, 80, 5), (0, 0, 40)), ((30, 20, 4), (48, 16, 44.5))]
    boxes += [((10, 10, 40), (75 * x, 35 * y, 20)) for x in (-1, 1) for y in (-1, 1)]
    fixed = [
        (coal.Box(*(np.array(size) / 100)), placed(coal, np.eye(3), np.array(centre) / 100))
        for size, centre in boxes
    ]
    least = least_gaps(coal, model, motion, lambda a, b: b - a > 1, fixed)
    assert least["self"] > 0.002 - 1e-4
    assert least["mujoco"] > 0.002 - 1e-4
    assert least["obstacles"] > -1e-4


@pytest.mark.slow
def test_an_arm_of_six_joints_points_down_where_it_starts_and_ends(tmp_path: Path) -> None:
    coal = pytest.importorskip("coal")
    spec = ARMS / "timor_pointing.srg"
    model, motion = found_motion(spec, tmp_path / "out", 20 * 0.1)
    least = least_gaps(coal, model, motion, lambda a, b: b - a > 1)
    assert least["self"] > 0.002 - 1e-4
    assert least["mujoco"] > 0.002 - 1e-4
    data = mujoco.MjData(model)
    assert model.nsite == 1
    for q, most, low, high in (
        (motion[0], 20, (0.5, 0.15, 0.466), (0.6, 0.25, 0.54)),
        (motion[-1], 5, (-0.6, 0.15, 0.426), (-0.5, 0.25, 0.5)),
    ):
        data.qpos = q
        mujoco.mj_forward(model, data)
        down = -data.site_xmat[0].reshape(3, 3)[2, 2]
        assert np.degrees(np.arccos(min(1.0, down))) <= most + 0.1
        assert np.all(data.site_xpos[0] >= np.array(low) - 1e-3)
        assert np.all(data.site_xpos[0] <= np.array(high) + 1e-3)
