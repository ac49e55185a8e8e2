"""Continuations: the languages that may follow a call in a derivation, each represented once."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from compiler.words.intersection import BinaryGrammar
from compiler.words.left_corners import Group

# --- The lengths of words as bit sets: bit m is set if there is a word of length m ----------------


CACHE_LIMIT = 50_000


class WordLengths:
    """Lengths up to ``horizon``; ``inside[k]`` are those of the words of nonterminal number k."""

    def __init__(self, grammar: BinaryGrammar, horizon: int) -> None:
        self.grammar = grammar
        self.horizon = horizon
        self.mask = (1 << (horizon + 1)) - 1
        self.inside = _inside(grammar, self.mask)
        self._sums: dict[tuple[int, int], int] = {}

    def before(self, symbol: int, lengths: int) -> int:
        """The lengths of a word of a symbol followed by a word of one of ``lengths``."""
        if symbol < self.grammar.terminals:
            return (lengths << 1) & self.mask
        key = (symbol, lengths)
        known = self._sums.get(key)
        if known is None:
            if len(self._sums) >= CACHE_LIMIT:
                self._sums.clear()
            inside = self.inside[symbol - self.grammar.terminals]
            known = self._sums[key] = sumset(inside, lengths) & self.mask
        return known


def _inside(grammar: BinaryGrammar, mask: int) -> list[int]:
    first, rules = grammar.terminals, grammar.rules
    inside = [0] * len(rules)
    users: list[dict[int, None]] = [{} for _ in rules]
    for k, rights in enumerate(rules):
        for right in rights:
            for symbol in right:
                if symbol >= first:
                    users[symbol - first][k] = None
    todo = OrderedDict.fromkeys(range(len(rules)))
    while todo:
        k, _ = todo.popitem(last=False)
        bits = 0
        for right in rules[k]:
            parts = [2 if s < first else inside[s - first] for s in right]
            bits |= parts[0] if len(parts) == 1 else sumset(parts[0], parts[1])
        if bits & mask != inside[k]:
            inside[k] = bits & mask
            todo.update(users[k])
    return inside


def sumset(left: int, right: int) -> int:
    """All sums of an element of one bit set and an element of the other."""
    if left.bit_count() > right.bit_count():
        left, right = right, left
    result = 0
    while left:
        low = left & -left
        result |= right << (low.bit_length() - 1)
        left ^= low
    return result


# --- Continuations --------------------------------------------------------------------------------
#
# A continuation is a set of items: a symbol, and the continuation after it.  It is ``final`` if the
# word may end there.  (These are the return points of the graph-structured stack, Tomita 1985; used
# top-down as in GLL, Scott & Johnstone 2010.) No symbol derives the empty word here.  So a system
# of equations
#
# K_i = final_i + items_i + sum of X K_j
#
# has exactly one solution (Arden 1961; the same argument with words instead of letters).  If
# existing continuations satisfy the equations of new ones, they *are* the new ones, and nothing is
# created.  That keeps the ambiguous ``E -> E + E`` as small as an equivalent unambiguous grammar,
# without discarding any alternative.  For the same reason, an item X K may be omitted if there is
# an item X K' and K' is known to include K: the true languages satisfy the equations without it as
# well.


Item: TypeAlias = "tuple[int, Continuation]"
Part: TypeAlias = tuple[bool, frozenset[Item]]


@dataclass(frozen=True, slots=True, eq=False)
class Knot:
    """Continuations that were made together, one for each of ``members``.

    ``inner`` has, for each member, symbols before continuations of the knot, given by index.
    """

    members: tuple[int, ...]
    inner: tuple[tuple[tuple[int, int], ...], ...]
    points: tuple[Continuation, ...]


class Continuation:
    """A language that may follow; compared by identity.

    ``lengths``: the lengths of its words, if requested.  ``height``: the greatest number of
    successive continuations down to the end, where a knot counts once.  ``includes``: continuations
    all of whose words are also words of this one.
    """

    __slots__ = ("final", "height", "includes", "items", "knot", "lengths")

    def __init__(self, final: bool) -> None:  # noqa: FBT001
        self.final = final
        self.items: frozenset[Item] = frozenset()
        self.lengths = 0
        self.height = 0
        self.knot: Knot | None = None
        self.includes: set[Continuation] = set()


MOST_INCLUDED = 4
"""The most included continuations that are recorded for each one."""


def _include(point: Continuation, others: Iterable[Continuation]) -> None:
    for other in others:
        if other is not point and len(point.includes) < MOST_INCLUDED:
            point.includes.add(other)


def maximal(points: Iterable[Continuation]) -> list[Continuation]:
    """The continuations, without those that others among them include."""
    kept = dict.fromkeys(points)
    for point in list(kept):
        if point in kept:
            for other in point.includes:
                kept.pop(other, None)
    return list(kept)


def without_included(items: Iterable[Item]) -> frozenset[Item]:
    """The items, without those that others with the same symbol include."""
    kept = set(items)
    for item in tuple(kept):
        if item in kept:
            symbol, point = item
            for other in point.includes:
                kept.discard((symbol, other))
    return frozenset(kept)


class Continuations:
    """All continuations made so far; ``end`` is the end of the word."""

    def __init__(self, lengths: WordLengths | None) -> None:
        self.lengths = lengths
        self._known: dict[Part, Continuation] = {}
        self._knots: dict[tuple[tuple[int, ...], tuple[Part, ...]], Knot] = {}
        self._plugged: dict[tuple[Continuation, Continuation], Continuation] = {}
        self.end = self._of((True, frozenset()))

    def __len__(self) -> int:
        return len(self._known) + len(self._plugged)

    def add(
        self,
        group: Group,
        direct: Mapping[int, Sequence[Continuation]],
        points: dict[int, Continuation],
    ) -> None:
        """Store the continuation of each member of a group of called nonterminals in ``points``.

        Args:
            group: the group.
            direct: the continuations of nonterminals that are called from outside.
            points: the continuations of the callers in other groups.
        """
        parts: list[Part] = []
        candidates: list[Continuation] = []
        included: list[list[Continuation]] = []
        for place, frames in enumerate(group.outer):
            targets = [t for member in group.direct[place] for t in direct.get(member, ())]
            candidates += targets
            targets += [points[caller] for caller in group.above[place]]
            items = {(frame.symbol, points[frame.caller]) for frame in frames}
            items.update(*(target.items for target in maximal(targets)))
            parts.append((any(target.final for target in targets), without_included(items)))
            included.append(targets)
        if not any(group.inner):
            points[group.members[0]] = self._of(parts[0])
            _include(points[group.members[0]], included[0])
            return
        number = {member: place for place, member in enumerate(group.members)}
        inner = tuple(tuple((f.symbol, number[f.caller]) for f in row) for row in group.inner)
        knot = self._tied(group.members, inner, tuple(parts), candidates, included)
        points.update(zip(group.members, knot.points, strict=True))

    def plugged(self, items: frozenset[Item], below: Continuation) -> frozenset[Item]:
        """The items with the end replaced by ``below``."""
        for level in _levels(items, self._plugged, below):
            if level.knot is None:
                parts = [self._plugged_part(level, below, frozenset())]
                self._plugged[level, below] = self._of(parts[0])
                _include(self._plugged[level, below], [below] if level.final else [])
            else:
                inside = frozenset(level.knot.points)
                parts = [self._plugged_part(p, below, inside) for p in level.knot.points]
                included = [[below] if p.final else [] for p in level.knot.points]
                knot = self._tied(
                    level.knot.members, level.knot.inner, tuple(parts), [below], included
                )
                for old, new in zip(level.knot.points, knot.points, strict=True):
                    self._plugged[old, below] = new
        return without_included((symbol, self._plugged[target, below]) for symbol, target in items)

    def _plugged_part(
        self, point: Continuation, below: Continuation, knot: frozenset[Continuation]
    ) -> Part:
        """The part of a continuation with another end, without what leads into its own knot."""
        items = {
            (symbol, self._plugged[target, below])
            for symbol, target in point.items
            if target not in knot
        }
        if point.final:
            items |= below.items
        return point.final and below.final, without_included(items)

    def _of(self, part: Part) -> Continuation:
        known = self._known.get(part)
        if known is None:
            known = self._known[part] = Continuation(part[0])
            known.items = part[1]
            known.height = 1 + max((target.height for _, target in part[1]), default=-1)
            if self.lengths is not None:
                known.lengths = _sum(part, self.lengths)
        return known

    def _tied(
        self,
        members: tuple[int, ...],
        inner: tuple[tuple[tuple[int, int], ...], ...],
        parts: tuple[Part, ...],
        candidates: Sequence[Continuation],
        included: Sequence[Sequence[Continuation]],
    ) -> Knot:
        """The solution of the equations of a knot; the knot of a candidate if that satisfies them.

        ``included``: for each member, continuations that it includes.
        """
        known = self._knots.get((members, parts))
        if known is None:
            knots = dict.fromkeys(point.knot for point in candidates)
            for knot in knots:
                if knot is not None and _fulfils(knot, members, inner, parts):
                    known = knot
                    break
            else:
                known = self._new(members, inner, parts, included)
            self._knots[members, parts] = known
        for point, targets in zip(known.points, included, strict=True):
            _include(point, targets)
        return known

    def _new(
        self,
        members: tuple[int, ...],
        inner: tuple[tuple[tuple[int, int], ...], ...],
        parts: tuple[Part, ...],
        included: Sequence[Sequence[Continuation]],
    ) -> Knot:
        knot = Knot(members, inner, tuple(Continuation(final) for final, _ in parts))
        for point, targets in zip(knot.points, included, strict=True):
            _include(point, targets)
        whole = _with_inner(knot.points, inner, parts)
        height = 1 + max((t.height for _, items in parts for _, t in items), default=-1)
        for point, part in zip(knot.points, whole, strict=True):
            point.items = part[1]
            point.knot = knot
            point.height = height
            self._known[part] = point
        if self.lengths is not None:
            _settle(knot.points, whole, self.lengths)
        return knot


def _levels(
    items: frozenset[Item],
    done: Mapping[tuple[Continuation, Continuation], Continuation],
    below: Continuation,
) -> list[Continuation]:
    """The continuations reached from the items and not yet plugged, by height; one per knot."""
    found: dict[Continuation, None] = {}
    todo = [target for _, target in items]
    while todo:
        point = todo.pop()
        if point.knot is not None:
            point = point.knot.points[0]
        if point not in found and (point, below) not in done:
            found[point] = None
            for member in (point,) if point.knot is None else point.knot.points:
                todo += [target for _, target in member.items]
    return sorted(found, key=lambda point: point.height)


def _with_inner(
    points: Sequence[Continuation],
    inner: tuple[tuple[tuple[int, int], ...], ...],
    parts: Sequence[Part],
) -> list[Part]:
    """The parts, with the symbols before continuations of the knot, which are ``points``."""
    return [
        (final, without_included(items.union((symbol, points[place]) for symbol, place in row)))
        for (final, items), row in zip(parts, inner, strict=True)
    ]


def _fulfils(
    knot: Knot,
    members: tuple[int, ...],
    inner: tuple[tuple[tuple[int, int], ...], ...],
    parts: Sequence[Part],
) -> bool:
    """Whether the continuations of a knot solve these equations."""
    if knot.members != members:
        return False
    for point, (final, items), row in zip(knot.points, parts, inner, strict=True):
        own = items.union((symbol, knot.points[place]) for symbol, place in row)
        # A cheap test first: omitting what is included only removes items.
        if point.final != final or not point.items <= own:
            return False
        if point.items != without_included(own):
            return False
    return True


def _settle(points: Sequence[Continuation], whole: Sequence[Part], lengths: WordLengths) -> None:
    """Compute the lengths of mutually recursive continuations as a least fixpoint."""
    changed = True
    while changed:
        changed = False
        for point, part in zip(points, whole, strict=True):
            bits = _sum(part, lengths)
            if bits != point.lengths:
                point.lengths = bits
                changed = True


def _sum(part: Part, lengths: WordLengths) -> int:
    bits = int(part[0])
    for symbol, target in part[1]:
        bits |= lengths.before(symbol, target.lengths)
    return bits
