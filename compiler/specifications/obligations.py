"""What a sampled formula needs of a word that satisfies it: which effector is where, and when.

Of a disjunction one part that holds is enough, of ``eventually`` one instant.  The needs suffice:
whatever word meets them satisfies the formula, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from compiler.specifications.word_formula import (
    Eventually,
    Every,
    Literal,
    SampledFormula,
    Some,
    SomewhereFrom,
    Throughout,
    ThroughoutFrom,
    Until,
    Word,
    nodes,
    parts_of,
    truth,
)

Demand: TypeAlias = tuple[SampledFormula, int]
"""A part and a sample at which it is to hold."""


@dataclass(frozen=True, slots=True)
class Obligation:
    """An effector (from 0) is inside a region, or not, from sample ``first`` to ``last``."""

    region: str
    effector: int
    inside: bool
    first: int
    last: int


def obligations(formula: SampledFormula, word: Word) -> tuple[Obligation, ...] | None:
    """What a word has to keep of itself to satisfy a formula; None if it does not satisfy it."""
    rows = truth(formula, word)
    if not rows[id(formula)][0]:
        return None
    demanded: dict[int, set[int]] = {id(formula): {0}}
    kept: dict[tuple[str, int, bool], set[int]] = {}
    for node in reversed([*nodes(formula)]):
        samples = demanded.get(id(node), set())
        if isinstance(node, Literal):
            key = node.region, node.effector - 1, node.positive
            kept.setdefault(key, set()).update(samples)
            continue
        for sample in sorted(samples):
            for part, at in _needs(node, sample, rows, len(word) - 1):
                demanded.setdefault(id(part), set()).add(at)
    return tuple(
        Obligation(*key, first, last)
        for key in sorted(kept)
        for first, last in _runs(sorted(kept[key]))
    )


def _runs(samples: Sequence[int]) -> Iterator[tuple[int, int]]:
    """The maximal runs of consecutive numbers."""
    first = 0
    for i in range(1, len(samples) + 1):
        if i == len(samples) or samples[i] != samples[i - 1] + 1:
            yield samples[first], samples[i - 1]
            first = i


def _needs(
    node: SampledFormula, sample: int, rows: Mapping[int, Sequence[bool]], last: int
) -> list[Demand]:
    """Which parts have to hold at which samples for a node that holds at a sample."""
    match node:
        case Every(parts=parts):
            return [(part, sample) for part in parts]
        case Some(parts=parts):
            return [next((part, sample) for part in parts if rows[id(part)][sample])]
        case Until(left=left, right=right):
            end = next(i for i in range(sample, last + 1) if rows[id(right)][i])
            return [(right, end), *((left, i) for i in range(sample, end))]
        case _:
            (part,) = parts_of(node)
            window = _window(node, sample, last)
            if isinstance(node, Throughout | ThroughoutFrom):
                return [(part, i) for i in window]
            return [(part, _middle([i for i in window if rows[id(part)][i]]))]


def _window(node: SampledFormula, sample: int, last: int) -> range:
    """The samples that an operator with a window looks at."""
    match node:
        case Eventually(first=first, last=end) | Throughout(first=first, last=end):
            return range(sample + first, last + 1 if end is None else min(sample + end, last) + 1)
        case SomewhereFrom(sample=since) | ThroughoutFrom(sample=since):
            return range(since, last + 1)
        case _:
            raise TypeError(node)


def _middle(samples: Sequence[int]) -> int:
    """The middle of the first run: far from both its ends."""
    first, last = next(_runs(samples))
    return (first + last) // 2
