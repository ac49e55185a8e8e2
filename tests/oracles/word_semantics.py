"""The meaning of sampled formulas on words, sample by sample, read off the definitions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from itertools import product

from compiler.tasks import sampled_formula as sf
from tests.oracles.formula_semantics import Signal

Cells = Sequence[Mapping[int, frozenset[str]]]


def true_at(formula: sf.SampledFormula, word: Cells, i: int) -> bool:
    """Whether ``formula`` is true of ``word`` at sample ``i``."""
    end = len(word) - 1
    match formula:
        case sf.Literal(region, effector, positive):
            inside = region in word[i][effector]
            return inside if positive else not inside
        case sf.Every(parts):
            return not any(not true_at(p, word, i) for p in parts)
        case sf.Some(parts):
            return any(true_at(p, word, i) for p in parts)
        case sf.Until(left, right):
            return true_at(right, word, i) or (
                i < end and true_at(left, word, i) and true_at(formula, word, i + 1)
            )
        case _:
            asked = [j for j in range(end + 1) if within(formula, i, j)]
            truths = [true_at(formula.part, word, j) for j in asked]
            if isinstance(formula, sf.Eventually | sf.SomewhereFrom):
                return True in truths
            return False not in truths


def within(
    formula: sf.Eventually | sf.Throughout | sf.SomewhereFrom | sf.ThroughoutFrom, i: int, j: int
) -> bool:
    """Whether an operator at sample i asks about sample j."""
    if isinstance(formula, sf.SomewhereFrom | sf.ThroughoutFrom):
        return j >= formula.sample
    return formula.first <= j - i and (formula.last is None or j - i <= formula.last)


def words(
    kinds: Sequence[frozenset[str]], steps: int, effectors: Sequence[int]
) -> Iterator[list[dict[int, frozenset[str]]]]:
    """All cell traces over samples 0 .. ``steps``, whatever the cells' neighbours."""
    each = list(product(kinds, repeat=len(effectors)))
    for choice in product(each, repeat=steps + 1):
        yield [dict(zip(effectors, at, strict=True)) for at in choice]


def signal_of(word: Cells, parts: int, changes: Sequence[Mapping[int, int]]) -> Signal:
    """The motion that follows a word on a grid of ``parts`` intervals between samples.

    ``changes[i][e]`` is the grid point, 1 .. parts - 1, at which effector e changes from its i-th
    cell to the next; there it is in both.
    """
    signal: list[dict[int, frozenset[str]]] = []
    for part in range(2 * parts * (len(word) - 1) + 1):
        i, inner = divmod(part, 2 * parts)
        signal.append({e: _between(word, changes, i, inner, e) for e in word[0]})
    return signal


def _between(
    word: Cells, changes: Sequence[Mapping[int, int]], i: int, inner: int, effector: int
) -> frozenset[str]:
    if inner == 0:
        return word[i][effector]
    instant = 2 * changes[i][effector]
    here = [] if inner > instant else [word[i][effector]]
    there = [] if inner < instant else [word[i + 1][effector]]
    return reduce(frozenset.union, [*here, *there])
