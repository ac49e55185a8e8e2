"""The finite automaton of a left- or right-linear grammar (Hopcroft, Motwani, Ullman 2001).

State 1 + k is nonterminal number k: what it has yet to derive where the grammar is right-linear,
what it has derived where it is left-linear.  State 0 stands where there is no nonterminal.
"""

from __future__ import annotations

from compiler.automata.finite_automaton import (
    STATE_LIMIT,
    Dfa,
    Nfa,
    determinise,
    intersection,
    minimal,
)
from compiler.grammars.grammar import Srg, linearity, trimmed


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
