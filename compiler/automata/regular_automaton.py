"""The finite automaton of a grammar whose form shows that its language is regular.

Linear grammars, and those without self-embedding: each set of mutually recursive nonterminals
recurs at one end of its right sides only (Chomsky 1959; Nederhof 2000).
"""

from __future__ import annotations

from compiler.automata.finite_automaton import (
    AutomatonTooLargeError,
    Dfa,
    Nfa,
    determinise,
    intersection,
    minimal,
)
from compiler.automata.linear_automaton import linear_automaton
from compiler.grammars.grammar import Srg, cyclic, trimmed
from compiler.grammars.transition_network import Network, transition_network

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
