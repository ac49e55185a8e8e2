"""The finite automaton of a grammar whose form shows that its language is regular."""

from __future__ import annotations

from compiler.words.finite_automaton import (
    STATE_LIMIT,
    AutomatonTooLargeError,
    Dfa,
    Nfa,
    determinise,
    intersection,
    minimal,
)
from compiler.words.grammar import Srg, cyclic, linearity, trimmed
from compiler.words.transition_network import Network, transition_network

# --- The finite automaton of a left- or right-linear grammar (Hopcroft, Motwani, Ullman 2001) -----
#
# State 1 + k is nonterminal number k: what it has yet to derive where the grammar is right-linear,
# what it has derived where it is left-linear.  State 0 stands where there is no nonterminal.


def linear_automaton(srg: Srg, accept: Dfa, limit: int = STATE_LIMIT) -> Dfa | None:
    """The minimal finite automaton of a left- or right-linear grammar with its accept condition.

    None where the useful productions are not all left-linear or all right-linear.

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
# Linear grammars, and those without self-embedding: each set of mutually recursive nonterminals
# recurs at one end of its right sides only (Chomsky 1959; Nederhof 2000).


SUBSET_LIMIT = 2_000
"""Larger automata are not worth their construction: there are other ways to read words."""


def regular_automaton(srg: Srg, accept: Dfa) -> Dfa | None:
    """The minimal finite automaton of L(SRG) intersected with L(accept).

    None where the form of the grammar does not show that L(SRG) is regular, or where the subset
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
