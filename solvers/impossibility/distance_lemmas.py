"""Distance lemmas: conditions on words that no robot which reaches a region satisfies.

The search starts from a refuted word. Its condition first fixes how often each module occurs. It
is then weakened as long as the bound on the effectors still holds. Counts that do not matter are
dropped, for words of any length or only for words within the task's bound on modules. The other
counts are raised, first all together, then one by one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import prod

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.discretisation.hull_distance import nearest_to_zero
from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.exact_numbers import outward
from compiler.lemmas.effector_bounds import (
    PRECISION,
    BallBound,
    EffectorBound,
    HalfSpaceBound,
    keep_to,
    place_of,
    placements_within,
)
from compiler.lemmas.frame_placement import Around, Placement
from compiler.robots.normal_form import RobotFamily
from compiler.tasks.necessary import stops
from compiler.time_limits.time_limit import check_time
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import AutomatonTooLargeError, Dfa, intersection
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.lemma import DistanceLemma

MOST_OF_ONE = 100
"""The largest count that is tried."""
MOST_STATES = 80
"""The largest automaton of a condition: the time to bound its effectors grows with the square."""
MOST_ALONE = 2_000
"""The largest automaton of a condition without ``accept``."""
GRID = 10**6
"""Normals are rounded to multiples of 1 / GRID."""


@dataclass(frozen=True, slots=True)
class _Counts:
    """Bounds on how often each module occurs, and on the length of the word.

    A module without an entry is not bounded, nor is the length if it is None.
    """

    least: Mapping[str, int]
    most: Mapping[str, int]
    length: int | None = None

    def condition(self) -> ir.Accept:
        """All bounds as one condition on words."""
        parts = tuple(self.conditions())
        if not parts:  # every word
            return ir.Count(None, ">=", 1)
        return parts[0] if len(parts) == 1 else ir.AllOf(parts)

    def conditions(self) -> Iterator[ir.Count]:
        """The bounds as separate conditions."""
        if self.length is not None:
            yield ir.Count(None, "<=", self.length)
        for name, count in self.least.items():
            yield ir.Count(name, "==" if self.most.get(name) == count else ">=", count)
        for name, count in self.most.items():
            if self.least.get(name) != count:
                yield ir.Count(name, "<=", count)

    @property
    def rank(self) -> tuple[int, int]:
        """A measure of weakness: fewer bounds on modules, then larger counts."""
        return -len(self.least) - len(self.most), sum(self.most.values())

    @property
    def states(self) -> int:
        """The states of the automaton of all bounds, but for one that rejects."""
        counts = {**self.least, **self.most}
        counts = {name: max(count, self.least.get(name, 0)) for name, count in counts.items()}
        return prod(count + 1 for count in counts.values()) * ((self.length or 0) + 1)

    def without_least(self, name: str) -> _Counts:
        return replace(self, least={k: v for k, v in self.least.items() if k != name})

    def without_most(self, name: str) -> _Counts:
        return replace(self, most={k: v for k, v in self.most.items() if k != name})

    def raised(self, names: Sequence[str], by: int) -> _Counts:
        """The upper bounds of the named modules raised by ``by``."""
        return replace(self, most={k: v + by * (k in names) for k, v in self.most.items()})


def distance_lemma(family: RobotFamily, task: ir.Task, word: Sequence[str]) -> DistanceLemma | None:
    """The lemma with the weakest condition found for the word of a refuted structure.

    Returns:
        None if no bound excludes a region that the task has to reach.

    Raises:
        OutOfTimeError: the time limit was reached.
    """
    workspace = family.program.workspaces[task.workspace]
    used = {symbol.name for production in family.grammar.productions for symbol in production.right}
    modules = [name for name in family.program.modules if name in used]
    occurring = Counter(word)
    counts = _Counts(
        {name: occurring[name] for name in modules if occurring[name]},
        {name: occurring[name] for name in modules},
    )
    best: tuple[_Counts, str, EffectorBound] | None = None
    for region in dict.fromkeys(stop.region for stop in stops(family.program, task)):
        place = place_of(workspace, region)
        if place.is_empty or not place.is_bounded:
            continue
        search = _Weakening(family, place, task.modules)
        bound = search.bound(counts)
        if bound is not None:
            weakest, bound = search.weakened(counts, bound)
            if best is None or weakest.rank > best[0].rank:
                best = weakest, region, bound
    if best is None:
        return None
    condition = best[0].condition()
    automaton = accept_dfa(condition, family.language.srg.terminals)
    return DistanceLemma(condition, automaton, best[1], best[2])


@dataclass(frozen=True, slots=True)
class _Weakening:
    family: RobotFamily
    place: Polytope
    modules: int | None

    @property
    def longest(self) -> int | None:
        """The most symbols of a word within the bound on modules, edges between them included."""
        if self.modules is None:
            return None
        module = self.family.program.is_module
        plain = all(module(name) for name in self.family.language.srg.terminals)
        return self.modules if plain else 2 * self.modules - 1

    def bound(self, counts: _Counts) -> EffectorBound | None:
        """A bound that holds for all effectors and excludes the place; None if none was found."""
        check_time()
        try:
            automaton = self._automaton(counts)
            if automaton is None:
                return None
            placements = placements_within(self.family, automaton)
        except ValueError:
            return None
        for bound in _bounds(placements, self.place):
            if bound.excludes(self.place) and keep_to(bound, placements):
                return bound
        return None

    def _automaton(self, counts: _Counts) -> Dfa | None:
        """The automaton of accepted words that satisfy all counts; None if it is too large.

        The states of different counts multiply, so the product for a large kit would not end. It is
        not begun if it is large without ``accept``; with it, counts are added one by one.
        """
        if counts.states > MOST_ALONE:
            return None
        language = self.family.language
        automaton = language.accept
        for condition in counts.conditions():
            automaton = intersection(automaton, accept_dfa(condition, language.srg.terminals))
            if automaton.size > MOST_STATES:
                return None
        return automaton

    def weakened(self, counts: _Counts, bound: EffectorBound) -> tuple[_Counts, EffectorBound]:
        """Weaken the counts one by one as far as a bound holds; return both.

        The length of the word is bounded only if that makes the condition weaker.
        """
        counts, bound = self._without(_Counts.without_least, counts, bound)
        counts, bound = self._without(_Counts.without_most, counts, bound)
        plain = self._all_raised(counts, bound)
        if self.longest is None:
            return plain
        short = replace(counts, length=self.longest)
        counts, bound = self._without(_Counts.without_most, short, bound)
        if len(counts.most) == len(short.most):
            return plain
        within = self._all_raised(counts, bound)
        return within if self._has_more(within[0], plain[0]) else plain

    def _has_more(self, one: _Counts, other: _Counts) -> bool:
        """Whether a word of the family within the bound on modules satisfies only ``one``."""
        only = ir.AllOf((one.condition(), ir.NotAccept(other.condition())))
        try:
            words = self.family.with_condition(only).language.words(max_modules=self.modules)
            return next(iter(words), None) is not None
        except AutomatonTooLargeError:
            return False

    def _all_raised(self, counts: _Counts, bound: EffectorBound) -> tuple[_Counts, EffectorBound]:
        """Raise all counts together, then each alone."""
        names = tuple(counts.most)
        for some in dict.fromkeys([names, *((name,) for name in names)]):
            counts, bound = self._raised(counts, bound, some)
        return counts, bound

    def _without(
        self, without: Callable[[_Counts, str], _Counts], counts: _Counts, bound: EffectorBound
    ) -> tuple[_Counts, EffectorBound]:
        """Drop each lower or upper bound, by ``without``, that the effectors do not need."""
        for name in counts.most:
            weaker = without(counts, name)
            found = self.bound(weaker)
            if found is not None:
                counts, bound = weaker, found
        return counts, bound

    def _raised(
        self, counts: _Counts, bound: EffectorBound, names: Sequence[str]
    ) -> tuple[_Counts, EffectorBound]:
        """Raise the named counts as far as a bound holds, by doubling, then by bisection.

        A count that is raised alone stays within the task's bound on modules.
        """
        step, known, most = 1, 0, MOST_OF_ONE
        alone = len(names) < len(counts.most) or counts.length is not None
        if self.modules is not None and alone:
            most = max(0, self.modules - min((counts.most[name] for name in names), default=0))
        going_up = True
        while names and step:
            found = None
            if known + step <= most:
                found = self.bound(counts.raised(names, known + step))
            if found is not None:
                known, bound = known + step, found
            else:
                going_up = False
            step = 2 * step if going_up else step // 2
        return counts.raised(names, known), bound


def _bounds(placements: Sequence[Placement], place: Polytope) -> Iterator[EffectorBound]:
    """Candidate bounds on the effectors at some placements; they still have to be proved."""
    vertices = np.array([[float(x) for x in vertex] for vertex in place.vertices])
    if not placements:
        yield _beyond(np.ones(vertices.shape[1]), (), vertices)
    for around in zip(*(place.views for place in placements), strict=True):
        boxes = [_corners(each, vertices.shape[1]) for each in around]
        if not all(np.isfinite(corners).all() for corners in boxes):
            continue
        corners = np.concatenate(boxes)
        apart = (vertices[:, None] - corners[None]).reshape(1, -1, vertices.shape[1])
        normal = nearest_to_zero(apart)[0]
        if np.linalg.norm(normal) > 0:
            yield _beyond(normal / np.linalg.norm(normal), around, vertices)
        yield _away(corners.mean(axis=0), around)


def _corners(around: Around, dimension: int) -> Array:
    """The corners (2^d, d) of a box."""
    ends = [
        (float(side.low), float(side.high)) if side.finite else (-np.inf, np.inf)
        for side in around.box[:dimension]
    ]
    return np.array(list(product(*ends)))


def _beyond(normal: Array, around: Sequence[Around], vertices: Array) -> HalfSpaceBound:
    exact = tuple(Fraction(round(float(x) * GRID), GRID) for x in normal)
    least = Fraction(float(np.min(vertices @ normal))) - 1
    with working_precision(PRECISION):
        reach = _most(lambda each: each.furthest(exact), around, 1)
    return HalfSpaceBound(exact, least if reach is None else reach)


def _away(centre: Array, around: Sequence[Around]) -> BallBound:
    exact = tuple(Fraction(round(float(x) * GRID), GRID) for x in centre)
    with working_precision(PRECISION):
        distance = _most(lambda each: each.nearest(exact), around, -1)
    return BallBound(exact, Fraction(0) if distance is None else max(distance, Fraction(0)))


def _most(measure: Callable[[Around], arb], around: Sequence[Around], sign: int) -> Fraction | None:
    """The greatest (sign 1) or least (sign -1) measure, rounded outwards; None if infinite."""
    found: Fraction | None = None
    for each in around:
        bounds = outward(measure(each))
        if bounds is None:
            return None
        value = bounds[1] if sign > 0 else bounds[0]
        found = value if found is None or sign * (value - found) > 0 else found
    return found
