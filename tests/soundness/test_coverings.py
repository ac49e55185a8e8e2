"""Coverings that nobody searched for: accepted only where brute force finds no way either."""

from __future__ import annotations

import random
from collections import Counter

import numpy as np
import pytest

from compiler.robots.normal_form import family_of
from grammar_lang.load import load_text
from solvers.verifier.refutations.box_check import why_not
from tests.oracles.random_sweeps import counterexample, flooded
from tests.oracles.random_tasks import RandomTask, random_task
from tests.oracles.some_cases import campaign
from tests.oracles.spec_figures import figures_of


def halved(
    letters: str, chance: random.Random | None, depth: int, leaf: str, first: int = 0
) -> str:
    """A tree that halves the letters in turn; with chance some of its parts less deep."""
    if depth == 0 or not letters or (chance is not None and chance.random() < 0.05):
        return leaf
    letter = letters[first % len(letters)] if chance is None else chance.choice(letters)
    below = (halved(letters, chance, depth - 1, leaf, first + 1) for _ in range(2))
    return letter + "".join(below)


def covering(
    parameters: int, coordinates: int, depth: int, chance: random.Random | None = None
) -> str:
    """The same division of the coordinates in each of four (or two) boxes of parameters."""
    inner = halved("abcdefgh"[:coordinates], chance, depth * coordinates, ".")
    outer = halved("ABCDEFGH"[:parameters], None, min(2 * parameters, 2), "@")
    return "boxes 1\n" + outer.replace("@", f"|{inner}") + "\n"


def answers(task: RandomTask, depth: int, chance: random.Random | None) -> list[str | None]:
    """What the checker has against a covering, structure by structure."""
    program = load_text(task.text, "task.srg").program
    assert program is not None
    (duty,) = program.tasks.values()
    family = family_of(program, duty)
    found = []
    for word in task.words:
        labels = {"JO": "joint", "P": "slide", "Y": "tilt", "L": "link", "S": "solid"}
        names = [{**labels, "K": "last", "EN": "tool", "B": "base"}[s] for s in word[::2]]
        model = family.robot(family.replay(tuple(reversed(names))))
        text = covering(len(model.parameters), len(model.dofs), depth, chance)
        found.append(why_not(text, model, program.workspaces["W"], duty))
    return found


def connected(task: RandomTask, seed: int, count: int, side: int) -> bool:
    """Whether brute force finds a robot that can be led from the start to the target.

    On a coarse grid: poses that touch on it may still be parted by an obstacle that is thinner.
    """
    figures = figures_of(task.text)
    lengths = counterexample(task, figures, count, seed)
    if lengths is None:
        return False
    free = [len(task.free_lengths(word)) for word in task.words]
    pairs = zip(task.words, free, strict=True)
    return any(flooded(task, figures, word, lengths[:n], side) for word, n in pairs)


def judged(seed: int, depth: int, count: int, side: int) -> tuple[bool, bool]:
    """Whether brute force finds a way, and whether a covering is accepted that denies it."""
    task = random_task(seed)
    chance = random.Random(seed) if seed % 2 else None
    refused = answers(task, depth, chance)
    way = connected(task, seed, count, side)
    if way:
        assert any(reason is not None for reason in refused), seed
    return way, all(reason is None for reason in refused)


@pytest.mark.parametrize(
    ("seed", "way", "accepted"),
    [(7, True, False), (8, True, False), (13, True, False), (15, True, False),
     (18, False, True), (22, False, True), (23, False, True)],
)  # fmt: skip
def test_no_covering_denies_a_way_that_there_is(seed, way, accepted):
    assert judged(seed, 4, 100_000, 120) == (way, accepted)


@pytest.mark.parametrize("part", campaign(range(10), 4))
def test_no_covering_denies_a_way_that_there_is_at_length(part):
    seen = Counter(judged(seed, 5, 1_000_000, 400) for seed in range(20 * part, 20 * part + 20))
    assert seen[True, True] == 0
    assert seen[True, False] >= 2
    assert seen[False, True] >= 1


def test_flooding_is_stopped_by_a_wall_and_not_by_a_gap():
    """An oracle of the oracle: seeds whose target is in reach, with and without joint limits."""
    task = random_task(12)
    figures = figures_of(task.text)
    lengths = counterexample(task, figures, 200_000, 0)
    assert lengths is not None
    assert flooded(task, figures, task.words[0], lengths, 200)
    assert np.all(lengths >= task.low)
    far = figures_of(task.text.replace("bounds box [-2.60, 2.60]", "bounds box [-2.60, -2.50]"))
    assert counterexample(task, far, 200_000, 0) is None
