"""Reading words of a context-free grammar from left to right, deterministically.

A *residual* stands for what may follow a prefix: an agenda of symbols, each with the return point
where reading goes on after it (the graph-structured stack of Tomita 1985, top-down as in GLL,
Scott and Johnstone 2010).  A symbol at the end of its rule takes over the return point of the
rule, and equal agendas are one object.  A left- or right-linear grammar therefore has finitely
many residuals: the states of a finite automaton.  With each return point goes the exact set of
the lengths of what may follow, as a bit set, so that a search never enters a dead end.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import count
from typing import TypeAlias

from compiler.languages.intersection import BinaryGrammar

CACHE_LIMIT = 50_000


@dataclass(slots=True, eq=False)
class _Return:
    """Where reading goes on: at each of ``direct``, or with a symbol before another one.

    ``final``: the word may end here.  Bit m of ``lengths``: some word of length m may follow.
    """

    identity: int
    final: bool = False
    direct: tuple[_Return, ...] = ()
    frames: tuple[tuple[int, _Return], ...] = ()
    lengths: int = 0


Agenda: TypeAlias = dict[tuple[int, int], tuple[int, _Return]]


@dataclass(slots=True, eq=False)
class _Shift:
    """What a terminal leads to: symbols to go on with, and return points."""

    agenda: list[tuple[int, _Return]] = field(default_factory=list)
    returns: list[_Return] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Residual:
    """What may follow a prefix.

    ``accepting``: nothing may follow.  Bit m of ``lengths``: some word of length m may follow.
    """

    identity: int
    agenda: tuple[tuple[int, _Return], ...]
    accepting: bool
    lengths: int
    shifts: dict[int, _Shift] | None = None


class Residuals:
    """The residuals of a grammar; lengths are exact up to ``horizon`` symbols.

    Objects are remembered up to ``CACHE_LIMIT``, then forgotten: results never depend on that.
    """

    def __init__(self, grammar: BinaryGrammar, horizon: int) -> None:
        self.grammar = grammar
        self.horizon = horizon
        self._mask = (1 << (horizon + 1)) - 1
        self._identities = count()
        self._known: dict[tuple[bool, frozenset[tuple[int, int]]], Residual] = {}
        self._moves: dict[tuple[int, int], Residual] = {}
        self._unions: dict[frozenset[int], _Return] = {}
        self._sums: dict[tuple[int, int], int] = {}
        self._inside = self._inside_lengths()
        end = _Return(next(self._identities), final=True, lengths=1)
        agenda: Agenda = {(s, end.identity): (s, end) for s in grammar.starts}
        self.root = self._residual(agenda, accepting=grammar.empty_word)

    def symbols(self, residual: Residual) -> list[int]:
        """The terminals that may come next, in order."""
        return sorted(self._shifts(residual))

    def after(self, residual: Residual, symbol: int) -> Residual | None:
        """The residual after one more symbol; None where it may not come next."""
        key = (residual.identity, symbol)
        known = self._moves.get(key)
        if known is not None:
            return known
        shift = self._shifts(residual).get(symbol)
        if shift is None:
            return None
        agenda: Agenda = {(s, r.identity): (s, r) for s, r in shift.agenda}
        accepting = _expand(shift.returns, agenda)
        result = self._residual(agenda, accepting=accepting)
        self._moves[key] = result
        return result

    # --- construction --------------------------------------------------------------------------

    def _residual(self, agenda: Agenda, *, accepting: bool) -> Residual:
        key = (accepting, frozenset(agenda))
        known = self._known.get(key)
        if known is not None:
            return known
        if len(self._known) >= CACHE_LIMIT:
            self._known.clear()
            self._moves.clear()
            self._unions.clear()
        lengths = int(accepting)
        for symbol, target in agenda.values():
            lengths |= self._sum(symbol, target.lengths)
        result = Residual(next(self._identities), tuple(agenda.values()), accepting, lengths)
        self._known[key] = result
        return result

    def _shifts(self, residual: Residual) -> dict[int, _Shift]:
        """The moves out of a residual, by the calls that its agenda makes."""
        if residual.shifts is not None:
            return residual.shifts
        first = self.grammar.terminals
        shifts: dict[int, _Shift] = {}
        direct: dict[int, dict[int, _Return]] = {}
        for symbol, target in residual.agenda:
            if symbol < first:
                shifts.setdefault(symbol, _Shift()).returns.append(target)
            else:
                direct.setdefault(symbol, {})[target.identity] = target
        frames = self._calls(direct)
        points = self._return_points(direct, frames)
        for called, point in points.items():
            for right in self.grammar.rules[called - first]:
                if right[0] < first:
                    shift = shifts.setdefault(right[0], _Shift())
                    if len(right) == 1:
                        shift.returns.append(point)
                    else:
                        shift.agenda.append((right[1], point))
        residual.shifts = shifts
        return shifts

    def _calls(self, direct: Iterable[int]) -> dict[int, dict[tuple[int, int], None]]:
        """All nonterminals called, each with its frames (next symbol, calling nonterminal)."""
        first = self.grammar.terminals
        frames: dict[int, dict[tuple[int, int], None]] = {symbol: {} for symbol in direct}
        todo = list(frames)
        while todo:
            caller = todo.pop()
            for right in self.grammar.rules[caller - first]:
                if right[0] < first:
                    continue
                if right[0] not in frames:
                    frames[right[0]] = {}
                    todo.append(right[0])
                frames[right[0]][right[1], caller] = None
        return frames

    def _return_points(
        self,
        direct: dict[int, dict[int, _Return]],
        frames: dict[int, dict[tuple[int, int], None]],
    ) -> dict[int, _Return]:
        """The return point of each called nonterminal; shared where there are no frames."""
        points: dict[int, _Return] = {}
        fresh: list[_Return] = []
        for symbol, callers in frames.items():
            targets = direct.get(symbol, {})
            if not callers and len(targets) == 1:
                points[symbol] = next(iter(targets.values()))
            elif not callers:
                points[symbol] = self._union(targets)
            else:
                point = _Return(next(self._identities), direct=tuple(targets.values()))
                points[symbol] = point
                fresh.append(point)
        for symbol, callers in frames.items():
            if callers:
                points[symbol].frames = tuple((s, points[caller]) for s, caller in callers)
        self._settle(fresh)
        return points

    def _union(self, targets: dict[int, _Return]) -> _Return:
        key = frozenset(targets)
        if key not in self._unions:
            point = _Return(next(self._identities), direct=tuple(targets.values()))
            self._settle([point])
            self._unions[key] = point
        return self._unions[key]

    # --- lengths -------------------------------------------------------------------------------

    def _settle(self, fresh: list[_Return]) -> None:
        """Least fixpoint of the lengths of new return points, which may call each other."""
        changed = self.horizon > 0
        while changed:
            changed = False
            for point in fresh:
                bits = point.lengths
                for target in point.direct:
                    bits |= target.lengths
                for symbol, target in point.frames:
                    bits |= self._sum(symbol, target.lengths)
                if bits != point.lengths:
                    point.lengths = bits
                    changed = True

    def _sum(self, symbol: int, lengths: int) -> int:
        """The lengths of a symbol followed by one of ``lengths``."""
        if symbol < self.grammar.terminals:
            return (lengths << 1) & self._mask
        key = (symbol, lengths)
        known = self._sums.get(key)
        if known is None:
            if len(self._sums) >= CACHE_LIMIT:
                self._sums.clear()
            inside = self._inside[symbol - self.grammar.terminals]
            known = self._sums[key] = _sumset(inside, lengths) & self._mask
        return known

    def _inside_lengths(self) -> list[int]:
        """Per nonterminal, the lengths up to the horizon of the words that it derives."""
        first, rules = self.grammar.terminals, self.grammar.rules
        inside = [0] * len(rules)
        if self.horizon == 0:
            return inside
        users: list[dict[int, None]] = [{} for _ in rules]
        for k, rights in enumerate(rules):
            for right in rights:
                for symbol in right:
                    if symbol >= first:
                        users[symbol - first][k] = None
        todo = dict.fromkeys(range(len(rules)))
        while todo:
            k = next(iter(todo))
            del todo[k]
            bits = 0
            for right in rules[k]:
                parts = [2 if s < first else inside[s - first] for s in right]
                bits |= parts[0] if len(parts) == 1 else _sumset(parts[0], parts[1])
            if bits & self._mask != inside[k]:
                inside[k] = bits & self._mask
                todo.update(users[k])
        return inside


def _expand(returns: list[_Return], agenda: Agenda) -> bool:
    """Add what follows the return points to the agenda; whether the word may end."""
    accepting = False
    seen: set[int] = set()
    todo = list(returns)
    while todo:
        point = todo.pop()
        if point.identity in seen:
            continue
        seen.add(point.identity)
        accepting = accepting or point.final
        todo += point.direct
        for symbol, target in point.frames:
            agenda[symbol, target.identity] = (symbol, target)
    return accepting


def _sumset(left: int, right: int) -> int:
    """All sums of an element of one bit set and one of the other."""
    if left.bit_count() > right.bit_count():
        left, right = right, left
    result = 0
    while left:
        low = left & -left
        result |= right << (low.bit_length() - 1)
        left ^= low
    return result
