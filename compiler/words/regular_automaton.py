"""Grammars without self-embedding: as a network of paths, and as a finite automaton."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

from compiler.words.finite_automaton import (
    STATE_LIMIT,
    AutomatonTooLargeError,
    Dfa,
    Nfa,
    determinise,
    intersection,
    minimal,
)
from compiler.words.grammar import (
    Cfg,
    Srg,
    components,
    cyclic,
    linearity,
    on_cycle,
    rules_by_left,
    trimmed,
)

# --- A grammar without self-embedding as a finite network whose paths are its derivations ---------
#
# Source: Nederhof, *Practical experiments with regular approximation of context-free languages*
# (2000), section 3.  If every set of mutually recursive nonterminals recurs only at the left end,
# or only at the right end, of its right sides, the grammar unfolds into a finite network.  Every
# derivation is one path from its first state to its last, and every path is one derivation.


Recursion: TypeAlias = Literal["none", "left", "right"]
Work: TypeAlias = tuple[int, tuple[int, ...], int]

WORK_LIMIT = 4_000


@dataclass(frozen=True, slots=True)
class Network:
    """States with moves under a terminal, or under the empty word if that is None.

    ``moves[p]`` are (terminal, state).  Several equal moves are different paths.  State 0 is the
    first and has no move into it; state 1 is the last and has no move out of it.
    """

    moves: tuple[tuple[tuple[int | None, int], ...], ...]


def transition_network(cfg: Cfg) -> Network | None:
    """The network of a trimmed grammar without cycles.

    None if a nonterminal embeds itself or recurs at both ends, or if the network would have more
    than ``WORK_LIMIT`` states or moves.
    """
    recursion = _recursions(cfg)
    if recursion is None:
        return None
    builder = _Builder(cfg, *recursion)
    return builder.build()


def _recursions(cfg: Cfg) -> tuple[tuple[int, ...], tuple[Recursion, ...]] | None:
    """The component of each nonterminal and the recursion of each; None if one is mixed."""
    first = cfg.terminals
    children: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    for left, right in cfg.rules:
        children[left - first] += [s - first for s in right if s >= first]
    component = components(cfg.nonterminals, children.__getitem__)
    size = max(component, default=-1) + 1
    ends: list[set[Recursion]] = [{"left", "right"} for _ in range(size)]
    edges = ((k, child) for k, row in enumerate(children) for child in row)
    recursive = {component[k] for k in on_cycle(cfg.nonterminals, edges)}
    for left, right in cfg.rules:
        own = component[left - first]
        inner = [i for i, s in enumerate(right) if s >= first and component[s - first] == own]
        if len(inner) > 1:
            return None
        if inner and inner[0] != 0:
            ends[own].discard("left")
        if inner and inner[0] != len(right) - 1:
            ends[own].discard("right")
    if not all(ends):
        return None
    kinds: tuple[Recursion, ...] = tuple(
        "none" if c not in recursive else "right" if "right" in ends[c] else "left"
        for c in range(size)
    )
    return component, kinds


class _Builder:
    """Unfolds occurrences one by one; a recursive component is unfolded once per occurrence."""

    def __init__(self, cfg: Cfg, component: tuple[int, ...], kinds: tuple[Recursion, ...]) -> None:
        self.cfg = cfg
        self.component = component
        self.kinds = kinds
        self.by_left = rules_by_left(cfg)
        self.members: list[list[int]] = [[] for _ in kinds]
        for k, c in enumerate(component):
            self.members[c].append(k)
        self.moves: list[list[tuple[int | None, int]]] = [[], []]

    def build(self) -> Network | None:
        todo: list[Work] = [(0, (self.cfg.start,), 1)]
        work = 0
        while todo:
            work += 1
            if work + len(todo) > WORK_LIMIT:
                return None
            source, symbols, target = todo.pop()
            if len(symbols) > 1:
                middle = self._state()
                todo += [(middle, symbols[1:], target), (source, symbols[:1], middle)]
            elif not symbols or symbols[0] < self.cfg.terminals:
                self.moves[source].append((symbols[0] if symbols else None, target))
            else:
                todo += self._unfold(source, symbols[0] - self.cfg.terminals, target)
        return Network(tuple(map(tuple, self.moves)))

    def _state(self) -> int:
        self.moves.append([])
        return len(self.moves) - 1

    def _unfold(self, source: int, nonterminal: int, target: int) -> Iterator[Work]:
        """The right sides that may stand between two states for a nonterminal."""
        own = self.component[nonterminal]
        if self.kinds[own] == "none":
            for r in self.by_left[nonterminal]:
                yield source, self.cfg.rules[r].right, target
            return
        state = {k: self._state() for k in self.members[own]}
        right = self.kinds[own] == "right"
        if right:
            self.moves[source].append((None, state[nonterminal]))
        else:
            self.moves[state[nonterminal]].append((None, target))
        for k in self.members[own]:
            for r in self.by_left[k]:
                symbols = self.cfg.rules[r].right
                end = symbols[-1 if right else 0] - self.cfg.terminals if symbols else -1
                inner = state.get(end)
                if right:
                    rest = symbols if inner is None else symbols[:-1]
                    yield state[k], rest, target if inner is None else inner
                else:
                    rest = symbols if inner is None else symbols[1:]
                    yield source if inner is None else inner, rest, state[k]


# --- The finite automaton of a left- or right-linear grammar (Hopcroft, Motwani, Ullman 2001) -----
#
# State 1 + k is nonterminal number k: what it still has to derive in a right-linear grammar, what
# it has derived in a left-linear one.  State 0 means that there is no nonterminal.


def linear_automaton(srg: Srg, accept: Dfa, limit: int = STATE_LIMIT) -> Dfa | None:
    """The minimal finite automaton of a left- or right-linear grammar with its accept condition.

    None if the useful productions are not all left-linear or all right-linear.

    Raises:
        AutomatonTooLargeError: the subset construction needs more than ``limit`` states.
    """
    cfg = trimmed(srg.cfg)
    side = linearity(cfg)
    if side is None:
        return None
    moves: list[tuple[int, int | None, int]] = []
    size = 1 + cfg.nonterminals
    for left, right in cfg.rules:
        letters = tuple(s for s in right if s < cfg.terminals)
        inner = [s for s in right if s >= cfg.terminals]
        other = 1 + inner[0] - cfg.terminals if inner else 0
        own = 1 + left - cfg.terminals
        source, target = (other, own) if side == "left" else (own, other)
        for letter in letters[:-1]:
            moves.append((source, letter, size))
            source, size = size, size + 1
        moves.append((source, letters[-1] if letters else None, target))
    start = 1 + cfg.start - cfg.terminals
    initial, final = (0, start) if side == "left" else (start, 0)
    nfa = Nfa(srg.terminals, size, tuple(moves), (initial,), frozenset((final,)))
    return intersection(minimal(determinise(nfa, limit)), accept)


# --- The finite automaton of a grammar whose form shows that its language is regular --------------
#
# These are linear grammars, and those without self-embedding: each set of mutually recursive
# nonterminals recurs only at one end of its right sides (Chomsky 1959; Nederhof 2000).


SUBSET_LIMIT = 2_000
"""Larger automata are not worth constructing: there are other ways to read words."""


def regular_automaton(srg: Srg, accept: Dfa) -> Dfa | None:
    """The minimal finite automaton of L(SRG) intersected with L(accept).

    None if the form of the grammar does not show that L(SRG) is regular, or if the subset
    construction needs more than ``SUBSET_LIMIT`` states.
    """
    try:
        known = linear_automaton(srg, accept, SUBSET_LIMIT)
        if known is not None:
            return known
        cfg = trimmed(srg.cfg)
        network = None if cyclic(cfg) else transition_network(cfg)
        if network is None:
            return None
        nfa = _nfa(network, srg.terminals)
        return intersection(minimal(determinise(nfa, SUBSET_LIMIT)), accept)
    except AutomatonTooLargeError:
        return None


def _nfa(network: Network, alphabet: tuple[str, ...]) -> Nfa:
    moves = tuple(
        (source, symbol, target)
        for source, row in enumerate(network.moves)
        for symbol, target in row
    )
    return Nfa(alphabet, len(network.moves), moves, (0,), frozenset((1,)))
