"""The paper's Figure 2: words as states, unfolded to a depth (Definition 4 as printed)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from compiler.languages.language import Language
from compiler.views.highlighted_run import not_accepted, refuse_unknown
from compiler.views.picture import Arrow, Edge, Node, Picture
from compiler.views.word_transitions import added, all_words, predecessors, run_to

LINE_WIDTH = 20
"""A longer word is broken into lines."""


def words_view(language: Language, depth: int, highlight: Sequence[str] | None = None) -> Picture:
    """The configuration graph, unfolded to robots of ``depth`` modules.

    States are the non-empty words of L(SRG) with at most ``depth`` modules; double circles are
    those that the accept condition accepts too.  A transition adds modules (backwards, removes
    them) and is labelled with the symbols added.  States that no transition leads to are initial.
    Where edges alone can repeat without bound, words of more than ``longest_drawn`` symbols are
    left out.

    Highlighted is a run from an initial state to the word ``highlight``; what of it lies beyond
    the depth is drawn without other transitions.

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
    """The most symbols of a word that is drawn; None: the modules bound them."""
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
    """The word in lines; where it is broken, a module ends the line."""
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
