"""All plans of small problems, by trying everything; and problems to try."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product
from typing import TypeAlias

from hypothesis import strategies as st

from compiler.tasks.sampled_formula import is_timed, sampled
from compiler.tasks.specification import PlannedEffector, PlanningProblem
from grammar_lang import ir
from tests.oracles.formulas import formulas
from tests.oracles.word_semantics import true_at

Cells: TypeAlias = tuple[int, ...]


def walks(problem: PlanningProblem, one: PlannedEffector, length: int) -> Iterator[Cells]:
    """The walks of one effector with so many cells; by samples it may stay."""
    paths: list[Cells] = [(cell,) for cell in one.start if cell not in one.forbidden]
    for _ in range(length - 1):
        paths = [
            (*path, cell)
            for path in paths
            for cell in (*problem.neighbours[path[-1]], *path[-1:] * problem.by_samples)
            if cell not in one.forbidden
        ]
    for path in paths:
        if one.end is None or path[-1] in one.end:
            yield path


@dataclass(frozen=True)
class Case:
    """A problem with the formula it was made from; steps are 1 s."""

    problem: PlanningProblem
    formula: ir.Formula | None


def is_plan(case: Case, words: tuple[Cells, ...]) -> bool:
    """Whether words of equal length are bounded and satisfy the formula."""
    problem = case.problem
    if sum(a != b for word in words for a, b in pairwise(word)) > problem.changes:
        return False
    if case.formula is None:
        return problem.by_samples or len(set(words[0])) == len(words[0])
    numbers = [one.effector + 1 for one in problem.effectors]
    at = [
        {n: problem.propositions[cell] for n, cell in zip(numbers, cells, strict=True)}
        for cells in zip(*words, strict=True)
    ]
    # Untimed formulas are about as many positions as there are.
    return true_at(sampled(case.formula, Fraction(1), len(at) - 1), at, 0)


def brute_force(case: Case) -> list[tuple[Cells, ...]]:
    """All plans, as words: a cell per sample, or per position."""
    problem = case.problem
    k = problem.steps if problem.by_samples else problem.changes
    lengths = range(k if problem.by_samples else 0, k + 1)
    found = []
    for length in lengths:
        each = [list(walks(problem, one, length + 1)) for one in problem.effectors]
        found += [words for words in product(*each) if is_plan(case, words)]
    return found


def without_stays(word: Cells) -> Cells:
    """The cells of a word in the order they are entered."""
    return tuple(cell for i, cell in enumerate(word) if i == 0 or cell != word[i - 1])


def changes(words: tuple[Cells, ...]) -> int:
    """The changes of cell of all words together."""
    return sum(len(without_stays(word)) - 1 for word in words)


@st.composite
def graphs(draw: st.DrawFn, most: int) -> tuple[Cells, ...]:
    """Neighbours per cell of a random graph."""
    count = draw(st.integers(1, most))
    cell = st.integers(0, count - 1)
    edges = draw(st.sets(st.tuples(cell, cell).filter(lambda e: e[0] < e[1])))
    return tuple(
        tuple(sorted({b for e in edges for a, b in (e, e[::-1]) if a == i})) for i in range(count)
    )


@st.composite
def cases(draw: st.DrawFn, *, effectors: int, by_samples: bool) -> Case:
    """Random problems, two out of three with a formula; untimed ones have a bound of changes."""
    steps = draw(st.integers(0, 4 if effectors == 1 else 2))
    neighbours = draw(graphs(4 if effectors == 1 else 3))
    cells = st.sets(st.integers(0, len(neighbours) - 1), max_size=3).map(lambda s: tuple(sorted(s)))
    regions = st.sampled_from([frozenset(kind) for kind in ("", "A", "C", "AC")])
    formula = draw(
        st.none() | formulas(steps, effectors, deep=4) | formulas(steps, effectors, deep=4)
    )
    if formula is not None and not by_samples and is_timed(formula):
        formula = untimed(formula)
    planned = tuple(
        PlannedEffector(
            e,
            draw(cells.filter(bool)),
            draw(st.just(()) | cells),
            draw(st.none() | cells.filter(bool)),
        )
        for e in range(effectors)
    )
    problem = PlanningProblem(
        neighbours,
        tuple(draw(regions) for _ in neighbours),
        planned,
        None if formula is None else sampled(formula, Fraction(1), steps),
        by_samples,
        steps,
        draw(st.sampled_from([steps * effectors, max(0, steps - 1)])),
    )
    return Case(problem, formula)


def untimed(formula: ir.Formula) -> ir.Formula:
    """The formula with windows that reach from now to the end, and without ``next``."""
    ever = ir.Window(Fraction(0), None)
    match formula:
        case ir.Atom():
            return formula
        case ir.Not(operand=f) | ir.Next(operand=f):
            return ir.Not(untimed(f))
        case ir.And(operands=fs):
            return ir.And(tuple(map(untimed, fs)))
        case ir.Or(operands=fs):
            return ir.Or(tuple(map(untimed, fs)))
        case ir.Implies(left=a, right=b):
            return ir.Implies(untimed(a), untimed(b))
        case ir.Until(left=a, right=b):
            return ir.Until(untimed(a), untimed(b))
        case ir.Always(operand=f):
            return ir.Always(untimed(f), ever)
        case ir.Eventually(operand=f):
            return ir.Eventually(untimed(f), ever)
        case ir.Last(operand=f):
            return ir.Last(Fraction(0), untimed(f))
