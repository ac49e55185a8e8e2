"""The smallest robots of a task with all joints of their words, for checks that must be fast."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from compiler.checks.starting_robots import PASSED_OVER
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation
from compiler.words.structures import structures_of
from grammar_lang import ir

MOST_ROBOTS = 100
"""The most robots considered."""
LONGEST = 200
"""Longer words are skipped."""


def smallest_robots(program: ir.Program, task: ir.Task) -> Iterator[tuple[Derivation, RobotModel]]:
    """Derivations with their robots, as their rules build them; none if hard to compute."""
    family = family_of(program, task)
    try:
        words = family.language.words(max_length=LONGEST, max_modules=task.modules)
        for derivation in islice(structures_of(family.language, words), MOST_ROBOTS):
            yield derivation, family.built(derivation)
    except PASSED_OVER:
        return
