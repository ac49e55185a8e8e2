"""What may follow a call, each such language once.

A continuation is a set of items: a symbol, and the continuation after it; it is ``final`` where the
word may end.  (The return points of the graph-structured stack, Tomita 1985; top-down as in GLL,
Scott & Johnstone 2010.)  Symbols derive no empty word here.  So a system of equations

    K_i = final_i + items_i + sum of X K_j

has exactly one solution (Arden 1961; the same argument over words in place of letters), and
continuations that fulfil the equations of new ones *are* these: nothing new is made.  That keeps
the ambiguous ``E -> E + E`` as small as a grammar that was written without the ambiguity, and no
alternative is discarded for it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from compiler.grammars.left_corners import Group
from compiler.reading.word_lengths import WordLengths

Item: TypeAlias = "tuple[int, Continuation]"
Part: TypeAlias = tuple[bool, frozenset[Item]]


class Continuation:
    """A language that may follow; compared by identity.

    ``lengths``: those of its words, where asked for.  ``group``: nonterminals that call each other
    with their continuations, where it was made together with others.
    """

    __slots__ = ("final", "group", "items", "lengths")

    def __init__(self, final: bool) -> None:  # noqa: FBT001
        self.final = final
        self.items: frozenset[Item] = frozenset()
        self.lengths = 0
        self.group: tuple[tuple[int, ...], tuple[Continuation, ...]] | None = None


class Continuations:
    """All continuations made so far; ``end`` is the end of the word."""

    def __init__(self, lengths: WordLengths | None) -> None:
        self.lengths = lengths
        self._known: dict[Part, Continuation] = {}
        self._groups: dict[tuple[tuple[int, ...], tuple[Part, ...]], Sequence[Continuation]] = {}
        self.end = self._of((True, frozenset()))

    def __len__(self) -> int:
        return len(self._known)

    def add(
        self,
        group: Group,
        direct: Mapping[int, Sequence[Continuation]],
        points: dict[int, Continuation],
    ) -> None:
        """Give each member of a group of called nonterminals its continuation, in ``points``.

        Args:
            group: the group.
            direct: the continuations of nonterminals that are called from outside.
            points: those of the callers in other groups.
        """
        parts: list[Part] = []
        for member, frames in zip(group.members, group.outer, strict=True):
            targets = direct.get(member, ())
            items = frozenset((frame.symbol, points[frame.caller]) for frame in frames)
            items = items.union(*(target.items for target in targets))
            parts.append((any(target.final for target in targets), items))
        if not any(group.inner):
            points[group.members[0]] = self._of(parts[0])
            return
        key = (group.members, tuple(parts))
        made = self._groups.get(key)
        if made is None:
            made = self._groups[key] = self._solution(group, parts, direct) or self._new(
                group, parts
            )
        points.update(zip(group.members, made, strict=True))

    def _of(self, part: Part) -> Continuation:
        known = self._known.get(part)
        if known is None:
            known = self._known[part] = Continuation(part[0])
            known.items = part[1]
            if self.lengths is not None:
                known.lengths = _sum(part, self.lengths)
        return known

    def _solution(
        self,
        group: Group,
        parts: Sequence[Part],
        direct: Mapping[int, Sequence[Continuation]],
    ) -> Sequence[Continuation] | None:
        """Continuations that are there already and fulfil the equations of a group."""
        for member in group.members:
            for target in direct.get(member, ()):
                if target.group is not None and target.group[0] == group.members:
                    found = target.group[1]
                    if _fulfils(found, group, parts):
                        return found
        return None

    def _new(self, group: Group, parts: Sequence[Part]) -> Sequence[Continuation]:
        made = tuple(Continuation(final) for final, _ in parts)
        whole = _with_inner(made, group, parts)
        for point, part in zip(made, whole, strict=True):
            point.items = part[1]
            point.group = (group.members, made)
            self._known[part] = point
        if self.lengths is not None:
            self._settle(made, whole, self.lengths)
        return made

    @staticmethod
    def _settle(made: Sequence[Continuation], whole: Sequence[Part], lengths: WordLengths) -> None:
        """The least fixpoint of the lengths of continuations that refer to each other."""
        changed = True
        while changed:
            changed = False
            for point, part in zip(made, whole, strict=True):
                bits = _sum(part, lengths)
                if bits != point.lengths:
                    point.lengths = bits
                    changed = True


def _with_inner(points: Sequence[Continuation], group: Group, parts: Sequence[Part]) -> list[Part]:
    """The parts with the frames of callers in the group, whose continuations are ``points``."""
    place = dict(zip(group.members, points, strict=True))
    return [
        (final, items.union((frame.symbol, place[frame.caller]) for frame in frames))
        for (final, items), frames in zip(parts, group.inner, strict=True)
    ]


def _fulfils(points: Sequence[Continuation], group: Group, parts: Sequence[Part]) -> bool:
    whole = _with_inner(points, group, parts)
    return all(p.final == q[0] and p.items == q[1] for p, q in zip(points, whole, strict=True))


def _sum(part: Part, lengths: WordLengths) -> int:
    bits = int(part[0])
    for symbol, target in part[1]:
        bits |= lengths.before(symbol, target.lengths)
    return bits
