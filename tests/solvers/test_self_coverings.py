"""Coverings of arms that keep out of themselves: none where a straight way in joint space is clear.

Arms of three links in the plane with random lengths and radii, by distances of shapely.
"""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.unreachability.box_tree import text
from compiler.unreachability.motion_conditions import motion_conditions
from compiler.words.structures import structures
from grammar_lang.load import load_text
from solvers.impossibility.box_search import CoveringBudget, find_covering
from solvers.verifier.refutations.box_check import why_not
from tests.oracles.some_cases import examples

SPEC = """\
module B {{ role base; }}
module J {{ role joint; dof q: revolute z in [-160, 160] deg; }}
module L {{ role link; const one = {0:.3f} m; const two = {1:.3f} m; const three = {2:.3f} m; }}
module E {{ role effector; }}
grammar Arm {{ start N; arm: N -> B J L J J E; }}
semantics Arm {{
  arm {{
    this.a = rot(z, J1.q);
    this.b = this.a * move(x, L.one) * rot(z, J2.q);
    this.c = this.b * move(x, L.two) * rot(z, J3.q);
    rod(frame: this.a, axis: x, length: L.one, density: 1 kg/m, radius: {3:.3f} m);
    rod(frame: this.b, axis: x, length: L.two, density: 1 kg/m);
    rod(frame: this.c, axis: x, length: L.three, density: 1 kg/m, radius: 2 cm);
    effector(frame: this.c * move(x, L.three));
  }}
}}
workspace W {{
  plane xy;
  bounds box [-9, 9] x [-9, 9] m;
  region S box [{4:.3f}, {5:.3f}] x [{6:.3f}, {7:.3f}] m;
  target T box [{8:.3f}, {9:.3f}] x [{10:.3f}, {11:.3f}] m;
}}
task Go {{
  robot Arm; workspace W; start in S at rest; reach T;
  avoid self with body, margin 1 cm; effort <= 10 N*m; horizon 10 steps of 0.1 s;
}}
"""
EFFORT = CoveringBudget(1500, 1500, 60)
ROUGH = 0.002
"""Metres by which numbers in the text may be off."""


def places(lengths: Array, q: Array) -> Array:
    """Where joints and tip are in a pose, (4, 2)."""
    angles = np.cumsum(q)
    steps = lengths[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


def gap(lengths: Array, radius: float, q: Array) -> float:
    """By how much the last link is farther from the first one than it has to be."""
    at = places(lengths, q)
    one, three = shapely.LineString(at[:2]), shapely.LineString(at[2:])
    return float(one.distance(three)) - radius - 0.02 - 0.01


def found(numbers: list[float]) -> bool:
    """Whether a covering is found, which the verifier accepts."""
    program = load_text(SPEC.format(*numbers), "spec.srg").program
    assert program is not None
    task = program.tasks["Go"]
    family = family_of(program, task)
    (derivation,) = structures(family.language, 6)
    model, workspace = family.robot(derivation), program.workspaces[task.workspace]
    graph = robot_graph(model, task.gravity)
    covering = find_covering(motion_conditions(model, workspace, task), graph, EFFORT)
    return covering is not None and why_not(text(covering.tree), model, workspace, task) is None


def about(place: Array, half: float) -> list[float]:
    return [place[0] - half, place[0] + half, place[1] - half, place[1] + half]


def cases(seed: int) -> tuple[bool, bool]:
    """Whether a straight way is clear, and whether a covering is found."""
    rng = np.random.default_rng(seed)
    lengths = np.round(rng.uniform((0.8, 0.3, 0.6), (1.2, 0.7, 1.1)), 3)
    radius = round(float(rng.uniform(0.02, 0.15)), 3)
    start, end = rng.uniform(-2.7, 2.7, (2, 3))
    way = [start + s * (end - start) for s in np.linspace(0, 1, 200)]
    clear = all(gap(lengths, radius, q) > ROUGH for q in way)
    regions = [about(places(lengths, q)[-1], 0.02) for q in (start, end)]
    return clear, found([*lengths, radius, *regions[0], *regions[1]])


@pytest.mark.parametrize("block", range(2))
def test_no_clear_way_is_excluded(block: int) -> None:
    count = examples(6, 30)
    seen = [cases(seed) for seed in range(count * block, count * (block + 1))]
    assert (True, True) not in seen
    assert any(clear for clear, _ in seen)
