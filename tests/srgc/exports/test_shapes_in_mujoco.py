"""A robot with a shape of every kind in MJCF: what MuJoCo makes of it, against the spec by hand."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from srgc.cli import run
from tests.oracles import shaped_arm as arm

GEOM = mujoco.mjtGeom
SHAPES = {
    "B_0": [(GEOM.mjGEOM_CYLINDER, (0.15, 0.1), (0, 0, 0.1))],
    "Z_1_link": [
        (GEOM.mjGEOM_CAPSULE, (0.06, 0.15), (0, 0, 0.15)),
        (GEOM.mjGEOM_SPHERE, (0.09,), (0, 0, 0.3)),
    ],
    "Y_2_link": [(GEOM.mjGEOM_BOX, (0.15, 0.04, 0.05), (0.25, 0, 0))],
}  # fmt: skip
"""Half lengths and radii in metres, and where the middles are in the frame of the link."""


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> mujoco.MjModel:
    folder = tmp_path_factory.mktemp("shaped")
    claimed = arm.shaped_arm(folder / "out")
    assert run(["export", str(claimed), "--to", "mjcf", "-o", str(folder / "arm.xml")]) == 0
    return mujoco.MjModel.from_xml_path(str(folder / "arm.xml"))


@pytest.mark.parametrize("group", [2, 3])
@pytest.mark.parametrize("link", SHAPES)
def test_shapes(model: mujoco.MjModel, link: str, group: int) -> None:
    """For the eye (2) and for collisions (3)."""
    body = model.body(link).id
    found = [
        i for i in range(model.ngeom) if model.geom_bodyid[i] == body
        and model.geom_group[i] == group
    ]  # fmt: skip
    assert [model.geom_type[i] for i in found] == [kind for kind, _, _ in SHAPES[link]]
    for i, (_, size, place) in zip(found, SHAPES[link], strict=True):
        np.testing.assert_allclose(model.geom_size[i][: len(size)], size, rtol=1e-12)
        np.testing.assert_allclose(model.geom_pos[i], place, atol=1e-12)


def test_a_hull_has_its_corners(model: mujoco.MjModel) -> None:
    body = model.body("P_3_link").id
    (shown, hard) = (i for i in range(model.ngeom) if model.geom_bodyid[i] == body)
    assert [model.geom_group[i] for i in (shown, hard)] == [2, 3]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for geom in (shown, hard):
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        placed = data.geom_xpos[geom] + model.mesh_vert[first : first + count] @ (
            data.geom_xmat[geom].reshape(3, 3).T
        )
        frame = data.xmat[body].reshape(3, 3)
        own = (placed - data.xpos[body]) @ frame
        gaps = np.linalg.norm(own[:, None] - arm.CORNERS, axis=2)
        assert gaps.min(axis=0).max() < 1e-6
        assert gaps.min(axis=1).max() < 1e-6


def test_rotors_are_felt_and_limits_are_true(model: mujoco.MjModel) -> None:
    np.testing.assert_allclose(model.dof_armature, arm.ARMATURE, rtol=1e-14)
    assert list(model.dof_damping) == [0.3, 0, 0]
    for name, bounds, effort in zip(arm.JOINTS, arm.RANGES, arm.EFFORTS, strict=True):
        joint = model.joint(name)
        assert bool(model.jnt_limited[joint.id]) is (bounds is not None)
        if bounds is not None:
            assert tuple(joint.range) == bounds
        assert tuple(model.actuator(name).ctrlrange) == (-effort, effort)


def test_what_may_touch_is_excluded(model: mujoco.MjModel) -> None:
    """MuJoCo itself lets a body touch its parent, but not the one that is fixed in the world."""
    names = [model.body(i).name for i in range(model.nbody)]
    pairs = {(names[code >> 16], names[code & 0xFFFF]) for code in model.exclude_signature}
    assert {frozenset(pair) for pair in pairs} == {frozenset(pair) for pair in arm.TOUCHING}
