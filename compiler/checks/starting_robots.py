"""The robots that fit the coordinates that a task gives, if there are few."""

from __future__ import annotations

from itertools import islice

from compiler.checks.task_checks import dof_counter
from compiler.robots.candidate import robot_in_task
from compiler.robots.frame_table import SemanticsError
from compiler.robots.given_start import GivenStart, given_start
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.words.budget import BudgetExceededError
from compiler.words.finite_automaton import AutomatonTooLargeError, intersection
from compiler.words.intersection import CHECKED_RULES, IntersectionTooLargeError
from compiler.words.language import restrict
from compiler.words.structures import InfiniteAmbiguityError, structures_of
from grammar_lang import ir

PASSED_OVER: tuple[type[Exception], ...] = (
    AutomatonTooLargeError,
    BudgetExceededError,
    InfiniteAmbiguityError,
    IntersectionTooLargeError,
    SemanticsError,
)
"""The errors for which a check skips the robots of a family."""
MOST_ROBOTS = 8
"""Families with more robots are skipped: a check must be fast."""


def starting_robots(
    program: ir.Program, task: ir.Task, start: ir.StartAt
) -> tuple[tuple[RobotModel, GivenStart], ...] | None:
    """The robots with these degrees of freedom, in normal form; None if there are too many.

    It is also None if a word is infinitely ambiguous, or a robot is undefined.
    """
    try:
        family = family_of(program, task)
        whole = family.language
        counter = dof_counter(program, whole.srg.terminals, start)
        accept = intersection(whole.accept, counter)
        language = restrict(whole.srg, accept, CHECKED_RULES)
        if not language.is_finite(max_modules=task.modules):
            return None
        words = language.words(max_modules=task.modules)
        known = list(islice(structures_of(language, words), MOST_ROBOTS + 1))
    except PASSED_OVER:
        return None
    if len(known) > MOST_ROBOTS:
        return None
    found = []
    for derivation in known:
        try:
            model = robot_in_task(family, task.origin, derivation)
        except SemanticsError:
            continue
        found.append((model, given_start(model, start)))
    return tuple(found)
