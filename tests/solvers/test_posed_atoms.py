"""Formulas that ask for poses, along a tube: bounds against dense samples by scipy."""

from __future__ import annotations

from dataclasses import fields, replace
from fractions import Fraction
from functools import lru_cache
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.tasks.monitor import AtomKey
from grammar_lang import ir
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.region_distance import region_distance
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.turned import posed_region
from tests.oracles.driven_tips import (
    ACCURACY,
    FINE,
    PULL,
    STEP,
    STEPS,
    depths,
    horizon_task,
    inputs,
    model,
    polytope,
    segments,
    tilted_square,
    tips,
)
from tests.oracles.formulas import formulas
from tests.oracles.sampled_robustness import robustness
from tests.oracles.some_cases import examples

F = Fraction
RATE = FINE / STEP
NEAR = 5e-3
"""Metres that a tip may travel between two samples."""
WITHIN = F(7, 10)
"""Radians; both rods come into each pose and leave it."""
ALONG = ir.Aligned("x", (F(3), F(-1)), ir.Num(WITHIN))
ACROSS = ir.Aligned("-y", (F(-1), F(-4)), ir.Num(WITHIN))
TURNED = ir.Oriented((("z", ir.Num(F(3, 2))), ("-z", ir.Num(F(13, 10)))), ir.Num(WITHIN))
POSES: tuple[tuple[ir.Pose, ...], ...] = ((), (ALONG,), (ACROSS,), (TURNED,), (ALONG, TURNED))
KEYS = tuple(AtomKey(*key) for key in product("AC", (1, 2), POSES))


def off(pose: ir.Pose, angles: Array) -> Array:
    """By how much a frame turned by angles is off a pose, in rad."""
    match pose:
        case ir.Aligned(axis="x", direction=(x, y)):
            due = np.arctan2(float(y), float(x))
        case ir.Aligned(axis="-y", direction=(x, y)):
            due = np.arctan2(float(y), float(x)) + np.pi / 2
        case _:
            due = 3 / 2 - 13 / 10
    return np.asarray(np.abs((angles - due + np.pi) % (2 * np.pi) - np.pi))


@lru_cache
def known(seed: int) -> dict[AtomKey, Array]:
    """By atom how deep its point is in the region where it is in the pose; else -inf."""
    motion, shapes = tips(seed), regions(seed)
    elbow, tip = motion.points[:, 1], motion.points[:, 0]
    angles = {2: np.arctan2(elbow[:, 1], elbow[:, 0])}
    angles[1] = np.arctan2((tip - elbow)[:, 1], (tip - elbow)[:, 0])
    found = {}
    for key in KEYS:
        there = depths(shapes[key.region], motion.points[:, key.effector - 1])
        for pose in key.poses:
            there = np.where(off(pose, angles[key.effector]) <= float(WITHIN), there, -np.inf)
        found[key] = there
    return found


def regions(seed: int) -> dict[str, list]:
    """Large squares about the places of the tip, and of the elbow, after 1 s."""
    motion = tips(seed)
    return {
        "A": list(tilted_square(motion.at(F(1), 1), F(6, 10))),
        "C": list(tilted_square(motion.at(F(1), 2), F(5, 10))),
    }


@lru_cache
def proved(seed: int) -> FormulaProof:
    with working_precision(ACCURACY.bits):
        point_map, tube = segments(seed)
        graph, shapes = robot_graph(model(), PULL), regions(seed)
        found = {}
        for key in KEYS:
            region = region_distance(polytope(shapes[key.region]))
            posed = posed_region(graph, region, key.poses, key.effector - 1)
            found[key] = posed if key.poses else region
        proof = FormulaProof(point_map, found, horizon_task())
        for segment in tube:
            proof.add(segment, [ball(x) for x in inputs(seed)[segment.number]])
        return proof


def test_both_rods_come_into_poses_and_leave_them() -> None:
    assert STEPS * STEP == 3
    for key in KEYS:
        turned = [np.isfinite(known(seed)[key]) for seed in (0, 1)]
        assert any(map(np.any, turned)), key
        assert not key.poses or not all(map(np.all, turned)), key


@pytest.mark.parametrize("seed", [0, 1])
@settings(max_examples=examples(12, 60), deadline=None)
@given(formulas(3, 2, deep=6, poses=POSES))
def test_random_formulas(seed: int, formula: ir.Formula) -> None:
    with working_precision(ACCURACY.bits):
        found = proved(seed).verdict(formula)
    true = float(robustness(formula, known(seed), RATE, STEP)[0])
    if found.status is Status.UNDECIDED:
        # Where it turns on a pose, a length does not say how close it is.
        assert abs(true) <= NEAR or turns_on_a_pose(seed, formula)
        return
    sign = 1 if found.status is Status.HOLDS else -1
    assert sign * true > -NEAR
    bound, size = sign * found.robustness, sign * true
    assert bound >= 0
    assert bound <= size + NEAR or turns_on_a_pose(seed, formula)


def turns_on_a_pose(seed: int, formula: ir.Formula) -> bool:
    """Whether a formula has other values where poses are a little wider or narrower.

    Each atom for itself: a proof does not know that two of them are one, as in `A implies A`.
    """
    motion, atoms = known(seed), list[AtomKey]()
    named = apart(formula, atoms)
    chance = np.random.default_rng(0)
    drawn = chance.integers(-2, 3, size=(200, len(atoms)))
    values = set()
    for shifts in (*np.full((5, len(atoms)), np.arange(-2, 3)[:, None]), *drawn):
        moved = {
            key._replace(region=f"{key.region} {number}"): np.roll(motion[key], shift)
            for number, (key, shift) in enumerate(zip(atoms, shifts, strict=True))
        }
        values.add(round(float(robustness(named, moved, RATE, STEP)[0]), 1))
    return len(values) > 1


def apart(formula: ir.Formula, atoms: list[AtomKey]) -> ir.Formula:
    """The formula with another region in each atom; ``atoms`` gets those that were there."""
    if isinstance(formula, ir.Atom):
        atoms.append(AtomKey(formula.region, formula.effector or 1, formula.poses))
        return replace(formula, region=f"{formula.region} {len(atoms) - 1}")
    parts = {
        each.name: apart(getattr(formula, each.name), atoms)
        for each in fields(formula)
        if each.name in {"operand", "left", "right"}
    }
    return replace(formula, **parts)


def test_a_pose_at_an_instant() -> None:
    """Out of a pose the region does not count, in either sign."""
    turned = ir.Atom("A", 1, poses=(ALONG,))
    angles = known(0)[AtomKey("A", 1, (ALONG,))]
    at = int(np.flatnonzero(~np.isfinite(angles))[0]) // FINE + 1
    there = ir.Window(STEP * at, STEP * at)
    with working_precision(ACCURACY.bits):
        proof = proved(0)
        assert proof.verdict(ir.Eventually(turned, there)).status is Status.FAILS
        never = proof.verdict(ir.Always(ir.Not(turned), there))
    assert never.status is Status.HOLDS
    assert never.robustness == np.inf
