"""The shipped robots with motors, slides and L-shaped links, against kinematics written by hand."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from tests.oracles import result_files
from tests.oracles.planar_chain import chain_dynamics
from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
Made = Callable[[str], Path]
Values = Mapping[int, float]


def turn(axis: str, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    if axis == "y":
        return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def lifted(word: Sequence[str], joints: Values, values: Values) -> Array:
    """Modules of Figure 1: everything happens about and along z."""
    at, frame = np.array([0, 0, 0.3]), np.eye(3)
    for place, symbol in enumerate(word):
        if symbol == "JO":
            frame = frame @ turn("z", joints[place])
        elif symbol in ("C", "LL"):
            at = at + frame[:, 2] * values[place]
        if symbol == "LL":
            frame = frame @ turn("y", np.pi / 2)
            at = at + frame[:, 2] * values[place]
    return at


def in_plane(word: Sequence[str], joints: Values, values: Values) -> Array:
    at, heading = 0j, 0.0
    for place, symbol in enumerate(word):
        if symbol in ("R", "M", "JO"):
            heading += joints[place]
        elif symbol == "K":
            heading += values[place]
        elif symbol in ("P", "L"):
            at += (joints[place] if symbol == "P" else values[place]) * np.exp(1j * heading)
    return np.array([at.real, at.imag])


TIPS = {"l_shaped": lifted, "prismatic": in_plane, "motor_arm": in_plane}
ENDS = {
    "l_shaped": ([(0.3, 0.5), (0.1, 0.3), (0.4, 0.6)], [(-0.2, 0), (0.3, 0.5), (0.7, 0.9)]),
    "prismatic": ([(0.35, 0.5), (0, 0.15)], [(1.2, 1.35), (0.6, 0.75)]),
    "motor_arm": ([(0.9, 1.2), (-0.3, 0)], [(-0.5, -0.3), (0.3, 0.5)]),
}
"""Where the effector is at the first and at the last instant."""


def table(folder: Path) -> list[dict[str, str]]:
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def within(point: Array, box: Sequence[tuple[float, float]]) -> bool:
    return all(low < x < high for x, (low, high) in zip(point, box, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(TIPS))
def test_a_robot_is_found_and_verified(name: str, srgc: Run, made: Made) -> None:
    folder = made(name) / "out"
    ran = srgc("verify", folder, "--spec", ROOT / "specs" / f"{name}.srg")
    assert (ran.status, ran.out.splitlines()[0]) == (0, "valid: found, level validated")
    design = result_files.read(folder, "design.json")
    values = {item["symbol"]: item["value"] for item in design["parameters"]}
    places = [dof["symbols"][0] for dof in design["dofs"]]
    tips = []
    for row in table(folder):
        joints = {place: float(row[f"q{i}"]) for i, place in enumerate(places, 1)}
        tips.append(TIPS[name](design["word"], joints, values))
        given = [float(row[f"e1_{axis}"]) for axis in "xyz"[: len(tips[-1])]]
        np.testing.assert_allclose(given, tips[-1], atol=1e-9)
    start, end = ENDS[name]
    assert within(tips[0], start)
    assert within(tips[-1], end)


@pytest.mark.slow
def test_the_motor_arm_moves_as_its_equations_say(made: Made) -> None:
    """Two uniform rods with a mass at the tip, a motor and a damper, integrated by DOP853."""
    folder = made("motor_arm") / "out"
    design = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    assert design["word"] == ["B", "eps", "M", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN"]
    lengths = np.array([item["value"] for item in design["parameters"]])
    rows = table(folder)
    state = np.array([float(rows[0][name]) for name in ("q1", "q2", "qd1", "qd2", "s1")])
    assert list(state[2:]) == [0, 0, 0]
    for row, after in pairwise(rows):
        voltage, effort = float(row["u1"]), float(row["u2"])

        def slope(_: float, x: Array, voltage: float = voltage, effort: float = effort) -> Array:
            mass, coriolis = arm(lengths, x[:2], x[2:4])
            force = np.array([0.8 * x[4], effort - 0.3 * x[3]])
            current = (voltage - 1.5 * x[4] - 0.8 * x[2]) / 0.3
            return np.array([*x[2:4], *np.linalg.solve(mass, force - coriolis), current])

        state = solve_ivp(slope, (0, 0.1), state, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        listed = [float(after[name]) for name in ("q1", "q2", "qd1", "qd2", "s1")]
        np.testing.assert_allclose(listed, state, atol=2e-3)


def arm(lengths: Array, q: Array, v: Array) -> tuple[Array, Array]:
    """M and c: rods of 1.2 kg/m by the oracle of chains, and a point of 0.3 kg at the tip."""
    mass, coriolis, _ = chain_dynamics(lengths, np.full(2, 1.2), q, v, (0.0, 0.0))
    l1, l2 = lengths
    s1, c1 = np.sin(q[0]), np.cos(q[0])
    s12, c12 = np.sin(q.sum()), np.cos(q.sum())
    jacobian = np.array([[-l1 * s1 - l2 * s12, -l2 * s12], [l1 * c1 + l2 * c12, l2 * c12]])
    squares = np.array([v[0] ** 2, v.sum() ** 2])
    drift = -np.array([[l1 * c1, l2 * c12], [l1 * s1, l2 * s12]]) @ squares
    return mass + 0.3 * jacobian.T @ jacobian, coriolis + 0.3 * jacobian.T @ drift
