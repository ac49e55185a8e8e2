"""What a refuted structure teaches about others: conditions on words whose robots reach too little.

The numbers of modules of the refuted word are the first condition; it is weakened as far as the
bound on effectors still holds: a count that does not matter is left out, the others are raised,
all together first and then one after the other.
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
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import intersection
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
    """How often modules occur, at least and at most; None: as often as they like."""

    least: Mapping[str, int]
    most: Mapping[str, int]

    def condition(self) -> ir.Accept:
        """The condition on words."""
        parts: list[ir.Accept] = []
        for name, count in self.least.items():
            if self.most.get(name) == count:
                parts.append(ir.Count(name, "==", count))
            else:
                parts.append(ir.Count(name, ">=", count))
        for name, count in self.most.items():
            if self.least.get(name) != count:
                parts.append(ir.Count(name, "<=", count))
        if not parts:  # every word
            return ir.Count(None, ">=", 1)
        return parts[0] if len(parts) == 1 else ir.AllOf(tuple(parts))

    @property
    def rank(self) -> tuple[int, int]:
        """Greater is weaker: fewer conditions, then larger numbers."""
        return -len(self.least) - len(self.most), sum(self.most.values())

    def without_least(self, name: str) -> _Counts:
        return replace(self, least={k: v for k, v in self.least.items() if k != name})

    def without_most(self, name: str) -> _Counts:
        return replace(self, most={k: v for k, v in self.most.items() if k != name})

    def raised(self, names: Sequence[str], by: int) -> _Counts:
        """With so many more of some modules."""
        return replace(self, most={k: v + by * (k in names) for k, v in self.most.items()})


def distance_lemma(family: RobotFamily, task: ir.Task, word: Sequence[str]) -> DistanceLemma | None:
    """The lemma with the weakest condition found that the word of a refuted structure satisfies."""
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

    def bound(self, counts: _Counts) -> EffectorBound | None:
        """A bound that the effectors keep to and that excludes the place; None: none was found."""
        condition = counts.condition()
        language = self.family.language
        try:
            automaton = intersection(language.accept, accept_dfa(condition, language.srg.terminals))
            if automaton.size > MOST_STATES:
                return None
            placements = placements_within(self.family, automaton)
        except ValueError:
            return None
        for bound in _bounds(placements, self.place):
            if bound.excludes(self.place) and keep_to(bound, placements):
                return bound
        return None

    def weakened(self, counts: _Counts, bound: EffectorBound) -> tuple[_Counts, EffectorBound]:
        """Counts that cannot be weakened alone any more, with their bound."""
        for without in (_Counts.without_least, _Counts.without_most):
            for name in counts.most:
                weaker = without(counts, name)
                found = self.bound(weaker)
                if found is not None:
                    counts, bound = weaker, found
        names = list(counts.most)
        for some in dict.fromkeys([tuple(names), *((name,) for name in names)]):
            counts, bound = self._raised(counts, bound, some)
        return counts, bound

    def _raised(
        self, counts: _Counts, bound: EffectorBound, names: Sequence[str]
    ) -> tuple[_Counts, EffectorBound]:
        """Counts of some modules raised as far as that goes: by doubling, then by halving.

        That of one among others is not raised beyond the bound on modules, which says it already.
        """
        step, known, most = 1, 0, MOST_OF_ONE
        if self.modules is not None and len(names) < len(counts.most):
            most = max(0, self.modules - min(counts.most[name] for name in names))
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
