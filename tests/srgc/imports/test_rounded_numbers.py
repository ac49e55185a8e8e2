"""Numbers of an import have ten digits where that changes nothing, and more where it would."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from srgc.imports.quantities import Quantities, decimal_text
from srgc.imports.urdf.urdf_import import urdf_import
from tests.oracles.urdf_files import LIMIT, joint, robot
from tests.srgc.imports.test_urdf_pinocchio import Peer, agree

BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'


def digits(word: str) -> int:
    return len(word.partition("e")[0].replace(".", "").lstrip("-0").rstrip("0"))


def noisy_robot(seed: int, joints: int = 6) -> str:
    """Poses, masses and inertias of seventeen digits."""
    rng = np.random.default_rng(seed)
    parts = []
    for number in range(joints + 1):
        centre, angles = rng.uniform(-0.2, 0.2, 3), rng.uniform(-1, 1, 3)
        # Second moments of a body with these axes, so that it may exist.
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        second = axes @ np.diag(rng.uniform(0.001, 0.02, 3)) @ axes.T
        tensor = np.trace(second) * np.eye(3) - second
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        six = zip(names, tensor[np.triu_indices(3)].tolist(), strict=True)
        parts.append(
            f'<link name="l{number}"><inertial>'
            f'<origin xyz="{" ".join(map(repr, centre.tolist()))}"'
            f' rpy="{" ".join(map(repr, angles.tolist()))}"/>'
            f'<mass value="{float(rng.uniform(0.3, 3))!r}"/>'
            f"<inertia {' '.join(f'{name}={chr(34)}{value!r}{chr(34)}' for name, value in six)}/>"
            "</inertial></link>"
        )
        if number:
            place, turn = rng.uniform(-0.5, 0.5, 3), rng.uniform(-1.5, 1.5, 3)
            origin = (
                f'<origin xyz="{" ".join(map(repr, place.tolist()))}"'
                f' rpy="{" ".join(map(repr, turn.tolist()))}"/>'
            )
            ends = {"parent": f"l{number - 1}", "child": f"l{number}"}
            parts.append(joint("revolute", origin + LIMIT, name=f"j{number}", **ends))
    return robot(*parts)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_what_is_rounded_moves_as_before(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "noisy.urdf"
    path.write_text(noisy_robot(seed))
    text = urdf_import(path, effectors=["l6"]).text
    assert max(map(digits, re.findall(r"mass: (\S+) kg", text))) <= 10
    inertias = re.findall(r"inertia: \(([^)]*)\)", text)
    assert max(digits(word) for six in inertias for word in re.split(r",\s+", six)) <= 10
    agree(text, tmp_path, Peer(path, {}, "l6"))


def test_masses_of_a_density_are_rounded(tmp_path: Path) -> None:
    parts = (f'<link name="a">{BALL}</link>', f'<link name="b">{BALL}</link>')
    (tmp_path / "r.urdf").write_text(robot(*parts, joint("revolute", LIMIT)))
    found = urdf_import(tmp_path / "r.urdf", density=1000.0)
    # 4/3 pi 0.1^3 1000 = 4.18879020478..., and 0.4 m r^2 = 0.01675516081914...
    assert found.text.count("mass: 4.188790205 kg") == 2
    assert found.text.count("(0.01675516082, 0.01675516082, 0.01675516082, 0, 0, 0)") == 2
    exact = urdf_import(tmp_path / "r.urdf", density=1000.0, exact=True)
    (mass, _) = re.findall(r"mass: (\S+) kg", exact.text)
    assert abs(float(mass) - np.pi * 4 / 3) < 1e-13


def test_a_thin_plate_stays_a_body() -> None:
    """Moments about axes in a plate add up to that across it; rounded, they may not be less."""
    rng = np.random.default_rng(7)
    for _ in range(50):
        mass, a, b = rng.uniform(0.1, 3, 3).tolist()
        xx, yy = mass * b * b / 12, mass * a * a / 12
        text = Quantities().inertia((xx, yy, xx + yy, 0.0, 0.0, 0.0))
        x, y, z = map(Fraction, text[1:].split(", ")[:3])
        assert x + y - z >= -(x + y + z) / 10**14


@pytest.mark.parametrize(
    ("value", "due"),
    [
        (0.1 + 0.2, "0.3"), (1 / 3, "0.3333333333"), (1e-7 / 3, "0.00000003333333333"),
        (123456.7890123456, "123456.789"), (1e-13, "0"), (-0.0, "0"), (1e6, "1000000"),
    ],
)  # fmt: skip
def test_ten_digits(value: float, due: str) -> None:
    assert decimal_text(value) == due
