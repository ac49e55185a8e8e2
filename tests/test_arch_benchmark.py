"""Motions of pendulums with networks as controllers are in what the benchmark encloses them by.

The networks are small and made here; scipy simulates the equations of the competition.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pytest
from flint import arb
from scipy.integrate import solve_ivp

from benchmarks.network_pendulums import CASES, Case, enclosed, halves, network_law, pendulum, shown
from benchmarks.relu_network import Layer, ReluNetwork, read_network
from compiler.arrays import Array
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.zonotope import Zonotope

F = Fraction
ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "benchmarks" / "arch_closed_loop.py"


def random_network(sizes: tuple[int, ...], seed: int, scale: float) -> ReluNetwork:
    """Weights with five digits, as the published ones have them."""
    rng = np.random.default_rng(seed)
    layers = []
    for before, after in pairwise(sizes):
        weights = rng.uniform(-scale, scale, (after, before)).round(5).tolist()
        offsets = rng.uniform(-0.1, 0.1, after).round(5).tolist()
        rows = tuple(tuple(Fraction(repr(x)) for x in row) for row in weights)
        layers.append(Layer(rows, tuple(Fraction(repr(x)) for x in offsets)))
    return ReluNetwork(tuple(layers))


def outputs(network: ReluNetwork, x: Array) -> Array:
    """Those of one state, written out."""
    for number, layer in enumerate(network.layers):
        x = np.array(layer.weights, float) @ x + np.array(layer.offsets, float)
        if number + 1 < len(network.layers):
            x = np.where(x > 0, x, 0.0)
    return x


def rates(x: Array, torque: Array) -> Array:
    """The competition's equations, the mass matrix left as it is (m = l = 0.5, g = 1)."""
    n = len(torque)
    if n == 1:
        return np.array([x[1], 2 * np.sin(x[0]) + 8 * torque[0]])
    (a, b), (v, w) = x[:2], x[2:]
    mass = np.array([[2.0, np.cos(b - a)], [np.cos(b - a), 1.0]])
    right = [
        8 * torque[0] + w**2 * np.sin(b - a) + 4 * np.sin(a),
        8 * torque[1] - v**2 * np.sin(b - a) + 2 * np.sin(b),
    ]
    return np.concatenate([x[2:], np.linalg.solve(mass, right)])


def free(links: int, initial: tuple[tuple[str, str], ...], steps: int) -> Case:
    limits = (("-50", "50"),) * (2 * links)
    return Case("free", links, "", initial, limits, 0, "0.05", steps)


SINGLE = free(1, (("1", "1.175"), ("0", "0.2")), 8)
KINKED = free(1, (("-0.3", "0.3"), ("-0.2", "0.2")), 4)
DOUBLE = free(2, (("1", "1.1"), ("-0.3", "-0.2"), ("0", "0.1"), ("0.5", "0.6")), 5)
BENT = free(2, (("-0.1", "0.1"),) * 4, 3)
PUSH = ReluNetwork((Layer(((F(1), F(0)),), (F(0),)), Layer(((F(1),),), (F(0),))))
"""T = max(theta, 0)."""


@pytest.mark.parametrize(
    ("case", "network"),
    [
        (SINGLE, random_network((2, 10, 8, 1), 1, 0.6)),
        (KINKED, random_network((2, 10, 8, 1), 2, 0.6)),
        (KINKED, PUSH),
        (DOUBLE, random_network((4, 10, 8, 2), 3, 0.6)),
        (BENT, random_network((4, 10, 8, 2), 4, 0.6)),
    ],
    ids=["single", "kinked", "push", "double", "bent"],
)
def test_motions_stay_in_their_enclosure(case: Case, network: ReluNetwork) -> None:
    n, rng = case.links, np.random.default_rng(1)
    found = enclosed(case, network, case.box)
    assert found.status is Status.HOLDS
    assert found.complete(case)
    low, high = np.array(case.box, dtype=float).T
    corners = [np.array(signs) for signs in product((0.0, 1.0), repeat=2 * n)]
    pieces, reached = 3, []
    for share in [*corners, *rng.random((12, 2 * n))]:
        x = low + share * (high - low)
        for step in range(case.steps):
            torque = outputs(network, x)
            for piece in range(pieces):
                ran = solve_ivp(
                    lambda _, y, torque=torque: rates(y, torque),
                    (0, 0.05 / pieces), x, method="DOP853", rtol=1e-11, atol=1e-13,
                )  # fmt: skip
                x = ran.y[:, -1]
                time = step + Fraction(piece + 1, pieces)
                least, most = found.bounds(time, time, Fraction(case.period))
                assert (np.array(least) - 1e-9 <= x).all(), (step, piece)
                assert (x <= np.array(most) + 1e-9).all(), (step, piece)
        reached.append(x)
    spread = np.ptp(np.array(reached), axis=0)
    widths = [2 * float(item.rad()) for item in found.hulls[-1]]
    assert (np.array(widths) <= 3 * spread).all()


@pytest.mark.parametrize("seed", range(4))
def test_networks_are_within_their_affine_enclosures(seed: int) -> None:
    rng = np.random.default_rng(seed)
    network = random_network((3, 12, 9, 2), seed, 0.7)
    middle, columns = rng.normal(size=3) * 0.2, rng.normal(size=(5, 3)) * 0.3
    states = Zonotope([arb(x) for x in middle.tolist()], columns.T)
    found = network.over(states)
    gain = np.array([[float(x) for x in row] for row in found.gain.tolist()])
    offset = np.array([float(x) for x in found.offset.entries()])
    assert found.errors is not None
    errors = np.array([[float(x) for x in row] for row in found.errors.tolist()])
    off = []
    corners = np.array(list(product((-1.0, 1.0), repeat=5)))
    for factors in np.vstack([corners, rng.uniform(-1, 1, (200, 5))]):
        x = middle + factors @ columns
        off.append(outputs(network, x) - gain @ x - offset)
        assert network(x) == pytest.approx(outputs(network, x), abs=1e-12)
    most = np.abs(np.array(off)).max(axis=0)
    bound = np.abs(errors).sum(axis=1)
    assert (most <= bound + 1e-9).all()
    assert (most > 0.02 * bound).all()


def test_a_network_on_a_point_is_exact() -> None:
    network = random_network((2, 6, 6, 1), 7, 0.8)
    found = network.over(Zonotope.point([arb("0.25"), arb(-1)]))
    value = (found.gain * 1).tolist()[0]
    at = float(value[0]) * 0.25 - float(value[1]) + float(found.offset[0, 0])
    assert found.errors is None
    assert at == pytest.approx(outputs(network, np.array([0.25, -1.0]))[0], abs=1e-12)


def test_torques_of_links_are_those_of_joints() -> None:
    """The second joint turns the second link against the first, which feels the reaction."""
    law = network_law(pendulum(2), random_network((4, 2), 0, 1.0))
    assert law.turn == ((1, 1), (0, 1))
    assert network_law(pendulum(1), random_network((2, 1), 0, 1.0)).turn == ((1,),)


def test_boxes_are_cut_until_limits_are_shown() -> None:
    """A limit that one tube does not keep, and those of both halves do."""
    case = free(1, (("0.8", "1.6"), ("0", "0.2")), 4)
    network = random_network((2, 10, 8, 1), 2, 0.6)
    whole = enclosed(case, network, case.box)
    parts = [enclosed(case, network, half) for half in halves(case.box)]
    last = case.steps - 1
    wide = float(whole.hulls[-1][0].upper())
    close = max(float(part.hulls[-1][0].upper()) for part in parts)
    assert close < wide
    limit = repr((close + wide) / 2)
    tight = replace(case, first=last, limits=(("-50", limit), None))
    assert enclosed(tight, network, tight.box).status is Status.UNDECIDED
    found = shown(tight, network, tight.box)
    assert (found.status, len(found.parts), found.tried) == (Status.HOLDS, 2, 3)
    assert found.widths(case.steps)[0] < whole.hulls[-1][0].rad() * 2


def test_limits_are_refuted_by_a_state() -> None:
    """theta'' = 2 sin(theta) without a controller: it falls."""
    still = ReluNetwork((Layer(((Fraction(0), Fraction(0)),), (Fraction(0),)),))
    state = replace(SINGLE, initial=(("1", "1"), ("0", "0")))
    fallen = replace(state, limits=(("0.9", "1.1"), None))
    assert shown(fallen, still, fallen.box).status is Status.FAILS
    # A state on its limit is not decided, and cannot be cut.
    edge = replace(state, limits=(("1", "3"), None))
    found = shown(edge, still, edge.box)
    assert (found.status, found.tried) == (Status.UNDECIDED, 1)


def test_boxes_are_cut_along_angles_first() -> None:
    lower, upper = halves(SINGLE.box)
    assert lower[1] == upper[1] == (0, Fraction("0.2"))
    assert lower[0][1] == upper[0][0] == Fraction("1.0875")
    wide = (lower[0], (Fraction(0), Fraction(1)))
    assert halves(wide)[0] == (lower[0], (0, Fraction(1, 2)))
    assert {len(case.box) // 2 - case.links for case in CASES} == {0}


NNET = """\
// a comment
2, 2, 1, 2,
2, 2, 1,
0
0
0
0
0
1.5, -2,
0.25, 1,
0.1,
-0.2,
2, -1,
0.05,
"""


def test_networks_are_read_from_their_text_format(tmp_path: Path) -> None:
    file = tmp_path / "small.nnet"
    file.write_text(NNET, encoding="utf-8")
    found = read_network(file)
    assert found.layers[0].weights == ((Fraction("1.5"), Fraction(-2)), (Fraction("0.25"), 1))
    # 2 max(1.5 + 0.1, 0) - max(0.25 - 0.2, 0) + 0.05
    assert found(np.array([1.0, 0.0])) == pytest.approx([3.2])
    file.write_text(NNET.replace("2, -1,\n0.05,\n", "2, -1,\n"), encoding="utf-8")
    with pytest.raises(ValueError, match="has not the numbers of its layers"):
        read_network(file)


def test_a_missing_network_is_named(tmp_path: Path) -> None:
    command = [sys.executable, str(SCRIPT), "--networks", str(tmp_path), "--cases", "single 2024"]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    assert "single 2024       no file controller_single_pendulum.nnet in the folder" in ran.stdout


def test_enclosures_over_an_interval_hold_those_of_instants() -> None:
    still = ReluNetwork((Layer(((Fraction(0), Fraction(0)),), (Fraction(0),)),))
    found = enclosed(SINGLE, still, SINGLE.box)
    period = Fraction(SINGLE.period)
    low, high = found.bounds(Fraction(3, 2), Fraction(7, 2), period)
    for instant in (Fraction(3, 2), Fraction(2), Fraction(11, 4), Fraction(7, 2)):
        least, most = found.bounds(instant, instant, period)
        assert all(a <= b for a, b in zip(low, least, strict=True))
        assert all(a >= b for a, b in zip(high, most, strict=True))
    # Both angle and rate grow, so that the range begins at its first instant.
    first = found.bounds(Fraction(3, 2), Fraction(3, 2), period)[0]
    assert low == pytest.approx(first, abs=1e-3)
