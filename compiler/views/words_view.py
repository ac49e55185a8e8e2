"""The paper's Figure 2: words as states, unfolded to a depth (Definition 4 as printed)."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

from compiler.views.workspace_view import (
    Arrow,
    Edge,
    HighlightError,
    Node,
    Picture,
    not_accepted,
    refuse_unknown,
)
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import Dfa, minimal
from compiler.words.grammar import Srg
from compiler.words.language import Language, restrict
from grammar_lang import ir

# --- Transitions between words: adding modules (the configuration graph of Figure 2) --------------
#
# A word is reached from its longest proper prefix among the states. If no state is a prefix of it,
# it is reached from every state that is a maximal proper subsequence of it, so that right-linear,
# nested and branching grammars grow in the right places as well.


MOST_SUBSEQUENCES = 10_000


def predecessors(
    word: tuple[str, ...], states: Container[tuple[str, ...]], by_length: Iterable[tuple[str, ...]]
) -> list[tuple[str, ...]]:
    """The states from which a word is reached; ``by_length`` are the states, shortest first."""
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
    """The symbols added to a subsequence ``part`` to get ``word``, in as few runs as possible.

    Of several ways with equally many runs, it is the one that adds them latest.
    """
    extra = len(word) - len(part)
    # runs[m][k]: the fewest runs in word[m + k:] from part[m:], after k symbols are added; the
    # second number applies if a run is open before.
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
    """State k: the shortest prefix that contains the symbols read has length k; last: none."""
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


# --- The part of a picture around its highlighted run, as the paper's Figure 2 shows it -----------


def near_run(picture: Picture) -> Picture:
    """The highlighted nodes and all nodes one edge away from them, with only those edges."""
    core = {node.key for node in picture.nodes if node.highlighted}
    edges = tuple(edge for edge in picture.edges if core & {edge.tail, edge.head})
    shown = core.union(*((edge.tail, edge.head) for edge in edges))
    return replace(
        picture,
        nodes=tuple(node for node in picture.nodes if node.key in shown),
        edges=edges,
        initial=tuple(arrow for arrow in picture.initial if arrow.head in shown),
    )


# --- The paper's Figure 2: words as states, unfolded to a depth (Definition 4 as printed) ---------


LINE_WIDTH = 20
"""Longer words are broken into lines."""


def words_view(language: Language, depth: int, highlight: Sequence[str] | None = None) -> Picture:
    """The configuration graph, unfolded to robots of ``depth`` modules.

    States are the non-empty words of L(SRG) with at most ``depth`` modules; those that the accept
    condition accepts too are double circles. A transition adds modules (backwards, it removes them)
    and is labelled with the symbols added. States that no transition leads to are initial. If edges
    alone can repeat without bound, words of more than ``longest_drawn`` symbols are left out.

    A run from an initial state to the word ``highlight`` is highlighted; its part beyond the depth
    is drawn without other transitions.

    Raises:
        HighlightError: ``highlight`` is not a word of the language.
    """
    everything = all_words(language.srg)
    run = () if highlight is None else _run(language, everything, tuple(highlight))
    found = everything.words(max_modules=depth, max_length=longest_drawn(everything, depth))
    words = [word for word in found if word]
    number = {word: i for i, word in enumerate(words)}
    before = [predecessors(word, number, words) for word in words]
    for previous, word in zip(((), *run), run, strict=False):
        if word not in number:
            number[word] = len(words)
            words.append(word)
            before.append([previous] if previous else [])
    steps = set(pairwise(run))
    members = set(run)
    nodes = tuple(
        Node(
            f"w{i}",
            _wrapped(word, language.srg.modules),
            "ellipse",
            double=language.accept.accepts(word),
            highlighted=word in members,
            data={"word": word},
        )
        for i, word in enumerate(words)
    )
    edges = tuple(
        _transition(number, previous, word, highlighted=(previous, word) in steps)
        for word, reached in zip(words, before, strict=True)
        for previous in reached
    )
    initial = tuple(
        Arrow(f"w{i}", highlighted=word in members) for i, word in enumerate(words) if not before[i]
    )
    return Picture("words", "ellipse", nodes, edges, initial)


def longest_drawn(everything: Language, depth: int) -> int | None:
    """The most symbols of a word that is drawn; None if the modules bound them."""
    return None if everything.is_finite(max_modules=depth) else 2 * depth + 1


def _run(
    language: Language, everything: Language, word: tuple[str, ...]
) -> tuple[tuple[str, ...], ...]:
    refuse_unknown(word, language.srg.terminals)
    if not word or not language.accepts(word):
        raise not_accepted(word)
    return tuple(run_to(everything, word))


def _transition(
    number: dict[tuple[str, ...], int],
    tail: tuple[str, ...],
    head: tuple[str, ...],
    *,
    highlighted: bool,
) -> Edge:
    symbols = added(tail, head)
    lines = (" ".join(symbols),) if symbols else ()
    data = {"added": symbols}
    return Edge(f"w{number[tail]}", f"w{number[head]}", lines, highlighted=highlighted, data=data)


def _wrapped(word: tuple[str, ...], modules: frozenset[str]) -> str:
    """The word in lines; each line except the last ends with a module."""
    parts: list[list[str]] = [[]]
    for symbol in word:
        parts[-1].append(symbol)
        if symbol in modules:
            parts.append([])
    if len(parts) > 1 and not modules & {*parts[-1]}:
        parts[-2:] = [parts[-2] + parts[-1]]
    lines = [""]
    for text in (" ".join(part) for part in parts):
        if lines[-1] and len(lines[-1]) + 1 + len(text) > LINE_WIDTH:
            lines.append("")
        lines[-1] += f" {text}" if lines[-1] else text
    return "\n".join(lines)
