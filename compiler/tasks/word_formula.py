"""Formulas about cell traces: the demands of a search on the samples of a motion.

They are in negation normal form, over samples 0 .. k. Parts are shared: a formula is a graph of
objects, which must be walked by identity.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Literal:
    """The effector (from 1) is in a cell inside the region, or in one that is not.

    Cells do not determine the orientation of its frame: it is in all ``poses`` there or, if
    ``away``, in none of them. A ``transfer`` is the number of a load, and whether it is picked up
    or put down.
    """

    region: str
    effector: int
    positive: bool
    poses: tuple[ir.Pose, ...] = ()
    away: bool = False
    transfer: tuple[int, bool] | None = None


@dataclass(frozen=True, slots=True)
class Every:
    """All parts hold; true if there are none."""

    parts: tuple[SampledFormula, ...]


@dataclass(frozen=True, slots=True)
class Some:
    """At least one part holds; false if there are none."""

    parts: tuple[SampledFormula, ...]


@dataclass(frozen=True, slots=True)
class Eventually:
    """At some existing sample from ``first`` to ``last`` later (None: to the end)."""

    part: SampledFormula
    first: int
    last: int | None


@dataclass(frozen=True, slots=True)
class Throughout:
    """At all existing samples from ``first`` to ``last`` later (None: to the end)."""

    part: SampledFormula
    first: int
    last: int | None


@dataclass(frozen=True, slots=True)
class SomewhereFrom:
    """At some sample from the ``sample``-th on, independent of the present sample."""

    part: SampledFormula
    sample: int


@dataclass(frozen=True, slots=True)
class ThroughoutFrom:
    """At all samples from the ``sample``-th on, independent of the present sample."""

    part: SampledFormula
    sample: int


@dataclass(frozen=True, slots=True)
class Until:
    """``right`` at some sample from the present one on, and ``left`` at all samples before it."""

    left: SampledFormula
    right: SampledFormula


SampledFormula: TypeAlias = (
    Literal | Every | Some | Eventually | Throughout | SomewhereFrom | ThroughoutFrom | Until
)
Word: TypeAlias = Sequence[Mapping[int, frozenset[str]]]
"""For each sample and effector (from 1) the propositions of its cell."""

TRUE: Final = Every(())
FALSE: Final = Some(())
ONE_LATER: Final = Eventually(TRUE, 1, 1)
"""There is another sample."""


# --- constructors that keep formulas small -------------------------------------------------------


def every(parts: Iterable[SampledFormula]) -> SampledFormula:
    """The conjunction."""
    found: list[SampledFormula] = []
    for part in parts:
        found += part.parts if isinstance(part, Every) else [part]
    if any(part == FALSE for part in found if isinstance(part, Some)):
        return FALSE
    found = _once(found)
    return found[0] if len(found) == 1 else Every(tuple(found))


def some(parts: Iterable[SampledFormula]) -> SampledFormula:
    """The disjunction."""
    found: list[SampledFormula] = []
    for part in parts:
        found += part.parts if isinstance(part, Some) else [part]
    if any(part == TRUE for part in found if isinstance(part, Every)):
        return TRUE
    found = _once(found)
    return found[0] if len(found) == 1 else Some(tuple(found))


def _once(parts: Sequence[SampledFormula]) -> list[SampledFormula]:
    """The parts without repetitions, literals by value and others by identity."""
    found = {part if isinstance(part, Literal) else id(part): part for part in parts}
    return list(found.values())


def throughout(part: SampledFormula, first: int, last: int | None) -> SampledFormula:
    """``part`` at all samples of a window."""
    match part:
        case Every(parts=parts):
            return every(throughout(one, first, last) for one in parts)
        case Throughout(part=inner, first=0, last=reach):
            end = None if last is None or reach is None else last + reach
            return Throughout(inner, first, end)
        case _:
            return part if first == last == 0 else Throughout(part, first, last)


def eventually(part: SampledFormula, first: int, last: int | None) -> SampledFormula:
    """``part`` at some sample of a window."""
    match part:
        case Some(parts=parts):
            return some(eventually(one, first, last) for one in parts)
        case Eventually(part=inner, first=0, last=reach):
            end = None if last is None or reach is None else last + reach
            return Eventually(inner, first, end)
        case _:
            return part if first == last == 0 else Eventually(part, first, last)


def next_sample(part: SampledFormula) -> SampledFormula:
    """There is another sample, and ``part`` holds there."""
    return eventually(part, 1, 1)


# --- formulas about one effector's cell ---------------------------------------------------------


def _literals(state: SampledFormula) -> Iterator[Literal]:
    stack = [state]
    while stack:
        match stack.pop():
            case Literal() as literal:
                yield literal
            case Every(parts=parts) | Some(parts=parts):
                stack.extend(parts)
            case other:
                raise TypeError(f"not about one instant: {other}")


def is_monotone(state: SampledFormula) -> bool:
    """Whether a formula about one instant only requires being in regions, a closed set."""
    return all(literal.positive for literal in _literals(state))


def both_cells(state: SampledFormula) -> SampledFormula:
    """The formula at a common point of the present and the next cell."""
    match state:
        case Literal(positive=positive):
            return eventually(state, 0, 1) if positive else throughout(state, 0, 1)
        case Every(parts=parts):
            return every(both_cells(part) for part in parts)
        case Some(parts=parts):
            return some(both_cells(part) for part in parts)
        case other:
            raise TypeError(f"not about one instant: {other}")


def dense_state(state: SampledFormula) -> SampledFormula:
    """The formula from a sample to the next, including the change of cells between them."""
    cells = throughout(state, 0, 1)
    match state:
        case Some(parts=parts):
            open_parts = [part for part in parts if not is_monotone(part)]
            # With one non-closed part: if neither cell meets another part, both meet this one.
            if len(open_parts) <= 1 and all(isinstance(part, Literal) for part in open_parts):
                return cells
            return every((cells, both_cells(state)))
        case Every(parts=parts):
            return every(dense_state(part) for part in parts)
        case _:
            return cells


# --- the meaning on a word -----------------------------------------------------------------------


def holds(formula: SampledFormula, word: Word, i: int = 0) -> bool:
    """Whether a cell trace satisfies a formula at its i-th sample."""
    return truth(formula, word)[id(formula)][i]


def truth(formula: SampledFormula, word: Word) -> dict[int, list[bool]]:
    """For each part of a formula, by identity, its truth at every sample."""
    rows: dict[int, list[bool]] = {}
    for node in nodes(formula):
        rows[id(node)] = _row(node, rows, word)
    return rows


def nodes(formula: SampledFormula) -> Iterator[SampledFormula]:
    """The formula and all its parts, each object once, parts before wholes."""
    seen: set[int] = set()
    stack = [(formula, False)]
    while stack:
        node, complete = stack.pop()
        if complete:
            yield node
        elif id(node) not in seen:
            seen.add(id(node))
            stack.append((node, True))
            stack.extend((part, False) for part in reversed(parts_of(node)))


def parts_of(formula: SampledFormula) -> tuple[SampledFormula, ...]:
    """The direct parts."""
    match formula:
        case Literal():
            return ()
        case Every(parts=parts) | Some(parts=parts):
            return parts
        case Until(left=left, right=right):
            return left, right
        case _:
            return (formula.part,)


def _row(node: SampledFormula, rows: Mapping[int, list[bool]], word: Word) -> list[bool]:
    """The truth of a node at every sample, from the truth of its parts."""
    count = len(word)
    parts = [rows[id(part)] for part in parts_of(node)]
    match node:
        case Literal(region=region, effector=effector, positive=positive):
            return [(region in at[effector]) is positive for at in word]
        case Every():
            return [all(part[i] for part in parts) for i in range(count)]
        case Some():
            return [any(part[i] for part in parts) for i in range(count)]
        case Eventually(first=first, last=last):
            return [any(_window(parts[0], i, first, last)) for i in range(count)]
        case Throughout(first=first, last=last):
            return [all(_window(parts[0], i, first, last)) for i in range(count)]
        case SomewhereFrom(sample=sample):
            return [any(parts[0][sample:])] * count
        case ThroughoutFrom(sample=sample):
            return [all(parts[0][sample:])] * count
        case Until():
            row = [False] * (count + 1)
            for i in reversed(range(count)):
                row[i] = parts[1][i] or (parts[0][i] and row[i + 1])
            return row[:count]


def _window(row: Sequence[bool], i: int, first: int, last: int | None) -> Sequence[bool]:
    return row[i + first :] if last is None else row[i + first : i + last + 1]


# --------------------------------------------------------------------------------------------------
# What a sampled formula requires of a word that satisfies it: which effector is where, and when.
#
# For a disjunction one part that holds is enough, for ``eventually`` one instant. The requirements
# are sufficient: any word that meets them also satisfies the formula.


NecessaryCondition: TypeAlias = tuple[SampledFormula, int]
"""A part and a sample at which it must hold."""


@dataclass(frozen=True, slots=True)
class Obligation:
    """An effector (from 0) is inside a region, or not, from sample ``first`` to ``last``.

    Inside, its frame is in all ``poses`` or, if ``away``, in none of them. A ``transfer`` of a load
    is as in a literal.
    """

    region: str
    effector: int
    inside: bool
    first: int
    last: int
    poses: tuple[ir.Pose, ...] = ()
    away: bool = False
    transfer: tuple[int, bool] | None = None


def obligations(formula: SampledFormula, word: Word) -> tuple[Obligation, ...] | None:
    """The properties that a word must keep to satisfy a formula; None if it does not satisfy it."""
    rows = truth(formula, word)
    if not rows[id(formula)][0]:
        return None
    demanded: dict[int, set[int]] = {id(formula): {0}}
    kept: dict[Literal, set[int]] = {}
    for node in reversed([*nodes(formula)]):
        samples = demanded.get(id(node), set())
        if isinstance(node, Literal):
            kept.setdefault(node, set()).update(samples)
            continue
        for sample in sorted(samples):
            for part, at in _needs(node, sample, rows, len(word) - 1):
                demanded.setdefault(id(part), set()).add(at)
    return tuple(
        Obligation(
            kind.region,
            kind.effector - 1,
            kind.positive,
            first,
            last,
            kind.poses,
            kind.away,
            kind.transfer,
        )
        for kind in sorted(kept, key=lambda kind: (kind.region, kind.effector, kind.positive))
        for first, last in _runs(sorted(kept[kind]))
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
) -> list[NecessaryCondition]:
    """Which parts must hold at which samples for a node that holds at a sample."""
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
            window = _samples_of(node, sample, last)
            if isinstance(node, Throughout | ThroughoutFrom):
                return [(part, i) for i in window]
            return [(part, _middle([i for i in window if rows[id(part)][i]]))]


def _samples_of(node: SampledFormula, sample: int, last: int) -> range:
    """The samples that an operator with a window covers."""
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
