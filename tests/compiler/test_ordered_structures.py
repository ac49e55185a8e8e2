"""Structures in the order of an objective, against all structures of a family."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction

import pytest

from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.ordered_structures import Limit, structures_by, words_below
from compiler.robots.candidate import Candidate, candidates
from compiler.robots.normal_form import RobotFamily, family_of
from grammar_lang import ir
from grammar_lang.conditions import condition_of
from grammar_lang.load import load_text
from tests.oracles.small_families import SmallFamily

SEEDS = range(20)
SOME = [Fraction(n, d) for n in (0, 1, 2, 5) for d in (1, 3, 7)]
Labels = tuple[str, ...]


def family(seed: int) -> tuple[ir.Program, ir.Task, RobotFamily]:
    program = load_text(SmallFamily(seed).text, "family.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    return program, task, family_of(program, task)


def weighed(program: ir.Program, choose: random.Random, within: Fraction = Fraction(0)) -> Amount:
    """A sum of random weights of modules."""
    weights = {name: choose.choice(SOME) for name in program.modules}
    return Amount(ir.Objective("sum", within, "price", tuple(weights.items())), weights, exact=True)


def mass(program: ir.Program, task: ir.Task) -> Amount:
    (found,) = amounts(program, replace(task, minimize=(ir.Objective("mass"),)))
    return found


def own(amount: Amount, candidate: Candidate) -> Fraction:
    return amount.of_robot(candidate.derivation.word, candidate.model)


def weight(amount: Amount, word: Sequence[str]) -> Fraction:
    return sum((amount.weights.get(symbol, Fraction(0)) for symbol in word), Fraction(0))


def check(amount: Amount, found: Sequence[Candidate], expected: Iterable[Candidate]) -> None:
    """They are those that are expected, each once, in order."""
    labels = [each.derivation.labels for each in found]
    assert sorted(labels) == sorted(each.derivation.labels for each in expected)
    assert len(set(labels)) == len(labels)
    values = [own(amount, each) for each in found]
    assert values == sorted(values)


@pytest.mark.parametrize("seed", SEEDS)
def test_all_structures_in_order(seed: int) -> None:
    program, task, robots = family(seed)
    choose = random.Random(seed)
    for modules in (task.modules, 3):
        assert modules is not None
        every = list(candidates(robots, modules, None))
        for amount in (weighed(program, choose), mass(program, task)):
            found = list(structures_by(amount, robots, modules, (), None))
            check(amount, found, every)
            for bound in (choose.choice(SOME) * 3, Fraction(0)):
                words = list(words_below(amount, robots, modules, (), bound))
                light = {c.derivation.word for c in every}
                light = {word for word in light if weight(amount, word) < bound}
                assert len(words) == len(set(words))
                assert set(words) == light


def test_families_have_words_with_several_derivations() -> None:
    several = 0
    for seed in SEEDS:
        _, task, robots = family(seed)
        assert task.modules is not None
        every = [each.derivation.word for each in candidates(robots, task.modules, None)]
        several += len(set(every)) < len(every)
    assert several >= 2


@pytest.mark.parametrize("seed", SEEDS)
def test_limits(seed: int) -> None:
    """What is within limits, of which some are about masses that words bound only from below."""
    program, task, robots = family(seed)
    assert task.modules is not None
    choose = random.Random(100 + seed)
    every = list(candidates(robots, task.modules, None))
    first = weighed(program, choose, Fraction(1, 10))
    limits = [
        Limit(amount, choose.choice([own(amount, each) for each in every]))
        for amount in (first, mass(program, task))
    ]
    limits.append(Limit(first, Fraction(0), choose.choice([own(first, each) for each in every])))
    amount = weighed(program, choose)
    for some in (limits[:1], limits[1:2], limits[:2], limits[2:]):
        allowed = [c for c in every if all(own(each.amount, c) <= each.most for each in some)]
        check(amount, list(structures_by(amount, robots, task.modules, some, None)), allowed)
        bound = 1 + max(own(amount, each) for each in every)
        words = set(words_below(amount, robots, task.modules, some, bound))
        assert words == {
            each.derivation.word
            for each in every
            if all(weight(it.amount, each.derivation.word) <= it.most for it in some)
        }


@pytest.mark.parametrize("seed", SEEDS)
def test_narrowed_families(seed: int) -> None:
    program, task, robots = family(seed)
    assert task.modules is not None
    choose = random.Random(200 + seed)
    name = choose.choice(sorted(program.modules))
    condition = condition_of(f"count({name}) <= 1", robots.language.srg.terminals)
    narrowed = robots.with_condition(ir.NotAccept(condition))
    amount = weighed(program, choose)
    left = [
        each
        for each in candidates(robots, task.modules, None)
        if each.derivation.word.count(name) > 1
    ]
    check(amount, list(structures_by(amount, narrowed, task.modules, (), None)), left)


@pytest.mark.parametrize("seed", range(6))
def test_an_existing_robot_changes_no_order(seed: int) -> None:
    program, task, robots = family(seed)
    assert task.modules is not None
    every = list(candidates(robots, task.modules, None))
    origin = ir.Origin(every[-1].derivation.word, ())
    amount = weighed(program, random.Random(seed))
    check(amount, list(structures_by(amount, robots, task.modules, (), origin)), every)


def test_no_bound_on_modules() -> None:
    """The first words of an infinite family, within a limit that leaves finitely many."""
    program, task, robots = family(1)
    ones = dict.fromkeys(program.modules, Fraction(1))
    modules = Amount(ir.Objective("modules"), ones, exact=True)
    expected = list(candidates(robots, 4, None))
    found = structures_by(modules, robots, None, (), None)
    first = [next(found) for _ in expected]
    check(modules, first, expected)
    amount = weighed(program, random.Random(1))
    limit = Limit(modules, Fraction(4))
    check(amount, list(structures_by(amount, robots, None, [limit], None)), expected)
    assert task.modules is not None
