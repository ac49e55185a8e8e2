"""Transitions between words: adding modules (the configuration graph of Figure 2).

A word is reached from its longest proper prefix among the states; where none of them is a prefix,
from every state that is a maximal proper subsequence of it, so that right-linear, nested and
branching grammars grow in the right places as well.
"""

from __future__ import annotations

from collections.abc import Container, Iterable

from compiler.automata.acceptance import accept_dfa
from compiler.automata.finite_automaton import Dfa, minimal
from compiler.grammars.grammar import Srg
from compiler.languages.language import Language, restrict
from compiler.views.highlighted_run import HighlightError
from grammar_lang import ir

MOST_SUBSEQUENCES = 10_000


def predecessors(
    word: tuple[str, ...], states: Container[tuple[str, ...]], by_length: Iterable[tuple[str, ...]]
) -> list[tuple[str, ...]]:
    """The states that a word is reached from; ``by_length`` are the states, shorter ones first."""
    for size in range(len(word) - 1, 0, -1):
        if word[:size] in states:
            return [word[:size]]
    inside: list[tuple[str, ...]] = []
    for state in by_length:
        if len(state) >= len(word):
            break
        if _is_subsequence(state, word):
            inside.append(state)
    maximal: list[tuple[str, ...]] = []
    for candidate in reversed(inside):
        if not any(_is_subsequence(candidate, known) for known in maximal):
            maximal.append(candidate)
    return maximal[::-1]


def _is_subsequence(part: tuple[str, ...], word: tuple[str, ...]) -> bool:
    rest = iter(word)
    return all(symbol in rest for symbol in part)


def added(part: tuple[str, ...], word: tuple[str, ...]) -> tuple[str, ...]:
    """What is added to a subsequence ``part`` to get ``word``, in as few runs as can be.

    Of several ways with equally many runs, the one that adds them latest.
    """
    extra = len(word) - len(part)
    # runs[m][k]: the fewest runs in word[m + k:] from part[m:], after k symbols added; the second
    # number where a run is open before.
    impossible = len(word) + 1
    runs = [[(impossible, impossible)] * (extra + 2) for _ in range(len(part) + 2)]
    runs[len(part)][extra] = (0, 0)
    for m in range(len(part), -1, -1):
        for k in range(extra, -1, -1):
            if m == len(part) and k == extra:
                continue
            keep = m < len(part) and part[m] == word[m + k]
            kept = runs[m + 1][k][0] if keep else impossible
            inside = runs[m][k + 1][1] if k < extra else impossible
            runs[m][k] = (min(kept, inside + 1), min(kept, inside))
    found: list[str] = []
    m, open_run = 0, False
    while m + len(found) < len(word):
        k = len(found)
        keep = m < len(part) and part[m] == word[m + k]
        if keep and runs[m + 1][k][0] == runs[m][k][open_run]:
            m, open_run = m + 1, False
        else:
            found.append(word[m + k])
            open_run = True
    return tuple(found)


def all_words(srg: Srg) -> Language:
    """L(SRG), whatever the accept condition."""
    return restrict(srg, accept_dfa(ir.AllOf(()), srg.terminals))


def run_to(everything: Language, word: tuple[str, ...]) -> list[tuple[str, ...]]:
    """A chain of transitions from an initial state to a word of L(SRG), both included.

    Raises:
        HighlightError: too many states are subsequences of the word.
    """
    prefixes = (word[:size] for size in range(len(word), 0, -1))
    backwards = [prefix for prefix in prefixes if everything.accepts(prefix)]
    first = backwards[-1]
    parts = restrict(everything.srg, _subsequences(first, everything.srg.terminals))
    if sum(parts.count_words()) > MOST_SUBSEQUENCES:
        raise HighlightError(
            f"more than {MOST_SUBSEQUENCES} words lie on the way to `{' '.join(word)}`"
        )
    states = [state for state in parts.words() if state]
    known = set(states)
    while before := predecessors(backwards[-1], known, states):
        backwards.append(before[0])
    return backwards[::-1]


def _subsequences(word: tuple[str, ...], alphabet: tuple[str, ...]) -> Dfa:
    """State k: the symbols read match best up to position k of the word; the last: not at all."""
    dead = len(word) + 1
    following = [dead] * len(alphabet)
    number = {name: i for i, name in enumerate(alphabet)}
    rows = [following.copy(), following.copy()]
    for position in range(len(word), 0, -1):
        following[number[word[position - 1]]] = position
        rows.append(following.copy())
    rows = [*reversed(rows[1:]), rows[0]]
    table = tuple(target for row in rows for target in row)
    return minimal(Dfa(alphabet, table, tuple(state < dead for state in range(dead + 1))))
