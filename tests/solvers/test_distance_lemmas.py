"""Lemmas against each of the structures that they are about, and altered lemmas."""

from __future__ import annotations

import random
from collections import Counter
from itertools import product

import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.pose_questions import pose_questions
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from compiler.time_limits.time_limit import OutOfTimeError, time_limit
from compiler.words.acceptance import accept_dfa
from grammar_lang import ir
from solvers.impossibility.distance_lemmas import _Counts, distance_lemma
from solvers.impossibility.pose_search import find_poses
from tests.oracles.formulas import program
from tests.oracles.reaching_families import reaching_family
from tests.oracles.some_cases import campaign

MOST, EFFECTORS = 30, 2
"""Structures of a family, and their effectors, that are looked at."""

FEW = (1, 3, 4, 5, 6, 7, 12, 14, 16, 20)
"""Families of all kinds that take little time."""


def check_family(seed: int) -> Counter[str]:
    """No poses are found of any structure that a lemma is about."""
    found = program(reaching_family(seed))
    (task,) = found.tasks.values()
    family = family_of(found, task)
    seen: Counter[str] = Counter()
    lemmas: list[object] = []
    workspace = found.workspaces[task.workspace]
    for candidate in candidates(family, 5, None):
        if candidate.number >= MOST or candidate.model is None:
            break
        if len(candidate.model.effectors) > EFFECTORS:
            continue
        word = candidate.derivation.word
        numeric = NumericRobot(robot_graph(candidate.model, task.gravity))
        about = [lemma for lemma in lemmas if lemma.is_about(word)]  # type: ignore[attr-defined]
        reached = all(find_poses(numeric, q, seed) for q in pose_questions(workspace, task))
        seen["reached"] += reached
        if about:
            seen["learnt"] += 1
            assert not reached, (seed, word)
        elif not reached:
            lemma = distance_lemma(family, task, word)
            if lemma is not None:
                assert lemma.is_about(word)
                lemmas.append(lemma)
                seen[lemma.claim().argument] += 1
    return seen


def test_random_families() -> None:
    seen: Counter[str] = Counter()
    for seed in FEW:
        seen += check_family(seed)
    assert seen["learnt"] > 60
    assert seen["reached"] > 5
    assert seen["too far"] > 9
    assert seen["too near"] > 2


@pytest.mark.parametrize("block", campaign(range(38), 10))
def test_three_hundred_random_families(block: int) -> None:
    for seed in range(8 * block, 8 * block + 8):
        check_family(seed)


LENGTHS = (0.425, 0.475, 0.55, 0.6, 0.675, 0.7, 0.775, 0.8)
"""Of the limbs of a kit, in metres; the hand is at most so far from the base as their sum."""


def kit(distance: float) -> ir.Program:
    """An arm of at most two limbs, whose hand has to be at some distance."""
    names = ", ".join(f"Limb{n}" for n in range(len(LENGTHS)))
    limbs = "\n".join(
        f"module Limb{n} {{ role link; const length = {length} m; dof q: revolute z; port in: S;"
        " frame joint = in * rot(z, q); port out: S; frame out = joint * move(x, length);"
        " rod(frame: joint, axis: x, length: length, density: 1 kg/m); }"
        for n, length in enumerate(LENGTHS)
    )
    return program(
        f"""
        module Base {{ role base; port out: S; frame out = in; }}
        {limbs}
        module Hand {{ role effector; port in: S; effector(frame: in); }}
        grammar Arm from ports {{ start Base; with {names}, Hand; }}
        workspace Table {{
          plane xy; bounds box [-2, 2] x [-2, 2] m;
          region Home box [{distance}, {distance + 0.01}] x [-0.01, 0.01] m;
          target Bin box [-0.2, 0.1] x [1.2, 1.5] m;
        }}
        task Sort {{
          robot Arm; workspace Table; start in Home at rest; reach Bin;
          effort <= 10 N*m; modules <= 4; horizon 30 steps of 0.1 s;
        }}
        """
    )


@pytest.mark.parametrize("distance", [1.3, 1.54])
def test_a_kit(distance: float) -> None:
    """What is learnt of the shortest word is about all limbs of which no two are long enough."""
    found = kit(distance)
    (task,) = found.tasks.values()
    family = family_of(found, task)
    lemma = distance_lemma(family, task, ("Base", "Hand"))
    assert lemma is not None
    for pair in product(range(len(LENGTHS)), repeat=2):
        length = sum(LENGTHS[n] for n in pair)
        about = lemma.is_about(("Base", *(f"Limb{n}" for n in pair), "Hand"))
        if length >= distance:
            assert not about, pair
        elif 2 * max(LENGTHS[n] for n in pair) < distance:
            assert about, pair


def test_the_limit_of_time_ends_the_weakening() -> None:
    found = kit(1.54)
    (task,) = found.tasks.values()
    family = family_of(found, task)
    calls = iter(range(1000))
    with time_limit(lambda: next(calls) >= 5), pytest.raises(OutOfTimeError):
        distance_lemma(family, task, ("Base", "Hand"))
    assert next(calls) < 20


def test_the_size_of_a_condition_is_known_before_it_is_built() -> None:
    choose = random.Random(3)
    for _ in range(200):
        most = {name: choose.randint(0, 3) for name in "abcd" if choose.random() < 0.7}
        some = [name for name in "abcd" if choose.random() < 0.4]
        least = {name: choose.randint(0, most.get(name, 3)) for name in some}
        counts = _Counts(least, most, choose.choice([None, 4]))
        automaton = accept_dfa(counts.condition(), tuple("abcde"))
        assert automaton.size <= counts.states + 1
