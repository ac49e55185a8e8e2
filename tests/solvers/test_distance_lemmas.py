"""Lemmas against each of the structures that they are about, and altered lemmas."""

from __future__ import annotations

from collections import Counter

import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.pose_questions import pose_questions
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from solvers.impossibility.distance_lemmas import distance_lemma
from solvers.impossibility.pose_search import find_poses
from tests.oracles.formulas import program
from tests.oracles.reaching_families import reaching_family

MOST, EFFECTORS = 30, 2
"""Structures of a family, and their effectors, that are looked at."""

FEW = (1, 3, 4, 5, 7, 12, 14, 20)
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


@pytest.mark.slow
@pytest.mark.parametrize("block", range(38))
def test_three_hundred_random_families(block: int) -> None:
    for seed in range(8 * block, 8 * block + 8):
        check_family(seed)
