"""The leftmost derivation that an LR parse stands for."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.automata.lr_automaton import LrAutomaton, right_parse


def leftmost_derivation(automaton: LrAutomaton, word: Sequence[int]) -> tuple[int, ...] | None:
    """The rules of the word's leftmost derivation, by number; None where there is none.

    A right parse lists the derivation tree in postorder, the leftmost derivation in preorder.
    """
    parse = right_parse(automaton, word)
    if parse is None:
        return None
    inner = [sum(s >= automaton.end for s in rule.right) for rule in automaton.rules]
    children: list[tuple[int, ...]] = []
    roots: list[int] = []
    for node, r in enumerate(parse):
        cut = len(roots) - inner[r]
        children.append(tuple(roots[cut:]))
        roots[cut:] = [node]
    derivation: list[int] = []
    while roots:
        node = roots.pop()
        derivation.append(parse[node])
        roots += reversed(children[node])
    return tuple(derivation)
