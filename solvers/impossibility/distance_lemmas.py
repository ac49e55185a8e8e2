"""What a refuted structure teaches about others: conditions on words whose robots reach too little.

The numbers of modules of the refuted word are the first condition; it is weakened as far as the
bound on effectors still holds: a count that does not matter is left out, at first among words of
any length and then among those that the task's bound on modules admits; the others are raised, all
together first and then one after the other.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

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
from compiler.words.finite_automaton import Dfa, complement, intersection
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.lemma import DistanceLemma

MOST_OF_ONE = 100
"""Counts are not raised beyond."""
MOST_STATES = 80
"""Conditions are not weakened beyond: what is asked about takes time that grows with the square."""
GRID = 10**6
"""Normals are multiples of one part in so many."""


@dataclass(frozen=True, slots=True)
class _Counts:
    """How often modules occur, at least and at most, and the number of symbols at most.

    What is not said, or None, is not bounded.
    """

    least: Mapping[str, int]
    most: Mapping[str, int]
    length: int | None = None

    def condition(self) -> ir.Accept:
        """The condition on words."""
        parts = tuple(self.conditions())
        if not parts:  # every word
            return ir.Count(None, ">=", 1)
        return parts[0] if len(parts) == 1 else ir.AllOf(parts)

    def conditions(self) -> Iterator[ir.Count]:
        """Those that hold all at once, one by one."""
        if self.length is not None:
            yield ir.Count(None, "<=", self.length)
        for name, count in self.least.items():
            yield ir.Count(name, "==" if self.most.get(name) == count else ">=", count)
        for name, count in self.most.items():
            if self.least.get(name) != count:
                yield ir.Count(name, "<=", count)

    @property
    def rank(self) -> tuple[int, int]:
        """Greater is weaker in the task: fewer conditions on modules, then larger numbers."""
        return -len(self.least) - len(self.most), sum(self.most.values())

    def without_least(self, name: str) -> _Counts:
        return replace(self, least={k: v for k, v in self.least.items() if k != name})

    def without_most(self, name: str) -> _Counts:
        return replace(self, most={k: v for k, v in self.most.items() if k != name})

    def raised(self, names: Sequence[str], by: int) -> _Counts:
        """With so many more of some modules."""
        return replace(self, most={k: v + by * (k in names) for k, v in self.most.items()})


def distance_lemma(family: RobotFamily, task: ir.Task, word: Sequence[str]) -> DistanceLemma | None:
    """The lemma with the weakest condition found that the word of a refuted structure satisfies.

    Raises:
        OutOfTimeError: the limit of time was reached.
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
        """The symbols of a word within the bound on modules, with an edge between any two."""
        if self.modules is None:
            return None
        module = self.family.program.is_module
        plain = all(module(name) for name in self.family.language.srg.terminals)
        return self.modules if plain else 2 * self.modules - 1

    def bound(self, counts: _Counts) -> EffectorBound | None:
        """A bound that the effectors keep to and that excludes the place; None: none was found."""
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
        """That of the words that are accepted and satisfy all counts; None: it is too large.

        Counts of different modules multiply their states, and those of a large kit reach any
        number: so they come in one by one, and the first product that is too large ends it.
        """
        language = self.family.language
        automaton = language.accept
        for condition in counts.conditions():
            automaton = intersection(automaton, accept_dfa(condition, language.srg.terminals))
            if automaton.size > MOST_STATES:
                return None
        return automaton

    def weakened(self, counts: _Counts, bound: EffectorBound) -> tuple[_Counts, EffectorBound]:
        """Counts that cannot be weakened alone any more, with their bound.

        The length of words is among them only where that says more.
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
        return plain if self._covers(plain[0], within[0]) else within

    def _covers(self, one: _Counts, other: _Counts) -> bool:
        """Whether all words that satisfy the other counts satisfy one, too."""
        about = [self._automaton(counts) for counts in (one, other)]
        if about[0] is None or about[1] is None:
            return False
        return intersection(about[1], complement(about[0])).longest() == -1

    def _all_raised(self, counts: _Counts, bound: EffectorBound) -> tuple[_Counts, EffectorBound]:
        names = tuple(counts.most)
        for some in dict.fromkeys([names, *((name,) for name in names)]):
            counts, bound = self._raised(counts, bound, some)
        return counts, bound

    def _without(
        self, without: Callable[[_Counts, str], _Counts], counts: _Counts, bound: EffectorBound
    ) -> tuple[_Counts, EffectorBound]:
        """The same without the counts of one kind that do not matter."""
        for name in counts.most:
            weaker = without(counts, name)
            found = self.bound(weaker)
            if found is not None:
                counts, bound = weaker, found
        return counts, bound

    def _raised(
        self, counts: _Counts, bound: EffectorBound, names: Sequence[str]
    ) -> tuple[_Counts, EffectorBound]:
        """Counts of some modules raised as far as that goes: by doubling, then by halving.

        That of one among others is not raised beyond the bound on modules, which says it already.
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
    """Bounds that the effectors may keep to, and that exclude the place if there is room."""
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
    """The greatest (sign 1) or the least (-1) of some bounds, rounded outwards."""
    found: Fraction | None = None
    for each in around:
        bounds = outward(measure(each))
        if bounds is None:
            return None
        value = bounds[1] if sign > 0 else bounds[0]
        found = value if found is None or sign * (value - found) > 0 else found
    return found
