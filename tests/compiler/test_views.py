from __future__ import annotations

from itertools import islice, pairwise, product

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.views.family_views import dfa_view, family_dfa_view, grammar_view
from compiler.views.pushdown_views import sra_view
from compiler.views.words_view import added, near_run, words_view
from compiler.views.workspace_view import HighlightError, Picture
from compiler.words.language import Language, language
from compiler.words.pushdown_automaton import configurations, sra
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    TRAPS,
    arm,
    grammar,
)
from tests.oracles.some_cases import examples

MODULES = ("B", "JO", "JO", "JO", "L", "JO", "L", "JO", "EN")
FIGURE = (*(symbol for module in MODULES[:-1] for symbol in (module, "eps")), "EN")
"""The robot of Figure 1c, whose accepted run is red in Figure 2."""


def text(label: str) -> str:
    return label.replace("\n", " ")


def labels(picture: Picture) -> dict[str, str]:
    return {node.key: text(node.label) for node in picture.nodes}


def edges(picture: Picture) -> list[tuple[str, str, str]]:
    """With the labels of their ends; the start of an arrow from nowhere is the empty one."""
    names = labels(picture)
    arrows = [("", names[arrow.head], arrow.label) for arrow in picture.initial]
    return arrows + [
        (names[edge.tail], names[edge.head], "\n".join(edge.lines)) for edge in picture.edges
    ]


def double(picture: Picture) -> set[str]:
    return {text(node.label) for node in picture.nodes if node.double}


def red(picture: Picture) -> tuple[set[str], list[tuple[str, str, str]]]:
    names = labels(picture)
    nodes = {names[node.key] for node in picture.nodes if node.highlighted}
    return nodes, [
        (names[e.tail], names[e.head], "\n".join(e.lines)) for e in picture.edges if e.highlighted
    ]


@pytest.fixture(scope="module")
def lang() -> Language:
    return language(arm(), ARM_TERMINALS, ARM_MODULES)


def test_words_view_is_figure_two(lang: Language) -> None:
    picture = words_view(lang, 3)
    grown = ["B"]
    for word in grown:
        if word.count("eps") < 2:
            grown += [f"{word} eps {module}" for module in ("JO", "L", "EN")]
    assert set(labels(picture).values()) == set(grown)
    found = edges(picture)
    assert len(found) == 1 + 12
    assert ("", "B", "") in found
    assert ("B eps JO", "B eps JO eps EN", "eps EN") in found
    assert double(picture) == {"B eps JO eps EN"}
    assert red(picture) == (set(), [])


RUN = [" ".join(FIGURE[:size]) for size in range(1, len(FIGURE) + 1, 2)]


def test_the_red_run_of_figure_two(lang: Language) -> None:
    assert len(RUN) == 9
    steps = [(tail, head, head.removeprefix(tail + " ")) for tail, head in pairwise(RUN)]
    for depth in (3, 7):
        picture = words_view(lang, depth, FIGURE)
        nodes, run = red(picture)
        assert nodes == set(RUN)
        assert sorted(run, key=lambda edge: len(edge[0])) == steps
        assert [arrow.highlighted for arrow in picture.initial] == [True]
        # 1 + 3 + ... + 3 ** (depth - 1) words, and those of the run that have more modules.
        assert len(picture.nodes) == (3**depth - 1) // 2 + 9 - depth
    assert RUN[-1] in double(picture)


def test_figure_two_shows_the_neighbours_of_the_run(lang: Language) -> None:
    picture = near_run(words_view(lang, 9, FIGURE))
    children = [(word, f"{word} eps {m}") for word in RUN[:-1] for m in ("JO", "L", "EN")]
    assert set(labels(picture).values()) == {"B", *(child for _, child in children)}
    assert {edge[:2] for edge in edges(picture)} == {("", "B"), *children}
    assert double(picture) == {c for _, c in children if c.startswith("B eps JO") and "EN" in c}
    assert red(picture)[0] == set(RUN)


def test_words_view_of_other_shapes() -> None:
    nested = language(grammar(TRAPS["counted"], ALPHABET), ALPHABET, frozenset("a"))
    assert edges(words_view(nested, 2)) == [("", "a b", ""), ("a b", "a a b b", "a b")]
    right = language(grammar("N -> b N | c N | a", ALPHABET), ALPHABET, frozenset(ALPHABET))
    found = edges(words_view(right, 3))
    assert ("b a", "b c a", "c") in found
    assert ("c a", "b c a", "b") in found
    assert ("a", "b c a", "b c") not in found
    unbounded = language(grammar("N -> a | N b", ALPHABET), ALPHABET, frozenset("a"))
    assert [e[1] for e in edges(words_view(unbounded, 1))] == ["a", "a b", "a b b"]


def test_a_run_of_words_that_grow_in_the_middle() -> None:
    nested = language(grammar(TRAPS["counted"], ALPHABET), ALPHABET, frozenset("a"))
    for depth in (1, 2, 5):
        nodes, run = red(words_view(nested, depth, tuple("aaabbb")))
        assert nodes == {"a b", "a a b b", "a a a b b b"}
        assert run == [("a b", "a a b b", "a b"), ("a a b b", "a a a b b b", "a b")]
    right = language(grammar("N -> b N | c N | a", ALPHABET), ALPHABET, frozenset(ALPHABET))
    run = red(words_view(right, 2, tuple("bcbca")))[1]
    assert len(run) == 4
    assert run[0][0] == "a"
    assert [tail for tail, _, _ in run[1:]] == [head for _, head, _ in run[:-1]]
    assert sorted(symbol for _, _, symbol in run) == ["b", "b", "c", "c"]


def test_a_run_of_a_long_word() -> None:
    unary = language(grammar("N -> a | N b", ALPHABET), ALPHABET, frozenset("a"))
    nodes, run = red(words_view(unary, 1, tuple("a" + "b" * 300)))
    assert (len(nodes), len(run)) == (301, 300)
    every = language(grammar("N -> N N | b | c | a", ALPHABET), ALPHABET, frozenset(ALPHABET))
    assert len(red(words_view(every, 1, tuple("bca" * 20)))[0]) == 60


def test_too_many_ways_to_grow_are_refused() -> None:
    right = language(grammar("N -> b N | c N | a", ALPHABET), ALPHABET, frozenset(ALPHABET))
    with pytest.raises(HighlightError, match="words lie on the way"):
        words_view(right, 2, (*"bc" * 20, "a"))


def test_the_sra(lang: Language) -> None:
    picture = sra_view(sra(lang.srg, lang.accept))
    assert labels(picture)["s0"] == "q0"
    found = edges(picture)
    assert ("", "q0", "N $") in found
    assert ("q5", "f", "ε, $ → ε") in found
    assert any("ε, N → B | N eps JO | N eps L" in label for _, _, label in found)
    assert double(picture) == {"f"}
    assert len({edge[:2] for edge in found}) == len(found)


def test_the_sra_leaves_out_states_without_a_way_to_the_final_one(lang: Language) -> None:
    """A search forwards from every state, with the transitions as they are, is the oracle."""
    pda = sra(lang.srg, lang.accept)
    graph = nx.DiGraph((move.state, move.target) for move in pda.transitions)
    live = {state for state in graph if nx.has_path(graph, state, pda.final)}
    picture = sra_view(pda)
    assert {node.data["state"] for node in picture.nodes} == live
    gone = [name for state, name in enumerate(pda.states) if state not in live]
    assert gone
    assert picture.caption == (f"left out: {', '.join(gone)}; no word is accepted from there",)
    moves = [move for edge in picture.edges for move in edge.data["moves"]]
    assert sorted(map(repr, moves)) == sorted(
        repr(move) for move in pda.transitions if {move.state, move.target} <= live
    )


def test_many_productions_are_one_label_of_short_lines() -> None:
    """Twelve productions: what is written gives each right side back, in short lines."""
    rights = [f"{'N ' if k else ''}{'abc'[k % 3]} {' '.join('cab'[: k % 4])}" for k in range(12)]
    lang = language(grammar(f"N -> {' | '.join(rights)}", ALPHABET), ALPHABET, frozenset("abc"))
    loops = [e for e in sra_view(sra(lang.srg, lang.accept)).edges if e.tail == e.head]
    (loop,) = loops
    assert all(len(line) <= 34 for line in loop.lines)
    said = " ".join(line.strip() for line in loop.lines).removesuffix(" x, x → ε for x = a, b, c")
    found = said.removeprefix("ε, N → ").split(" | ")
    assert [right.split() for right in found] == [right.split() for right in rights]


def test_the_red_run_of_the_sra_reads_the_word(lang: Language) -> None:
    pda = sra(lang.srg, lang.accept)
    picture = sra_view(pda, FIGURE)
    steps = {}
    for edge in picture.edges:
        assert any(edge.data["steps"]) == edge.highlighted
        for move, times in zip(edge.data["moves"], edge.data["steps"], strict=True):
            assert bool(times) == edge.highlighted
            steps |= dict.fromkeys(times, (edge, move))
    assert sorted(steps) == list(range(len(steps)))
    run = [steps[step] for step in range(len(steps))]
    assert all(first.head == second.tail for (first, _), (second, _) in pairwise(run))
    read = [pda.alphabet[move.read] for _, move in run if move.read is not None]
    assert tuple(read) == FIGURE
    *_, last = configurations(pda, FIGURE, [move for _, move in run])
    assert (last.remaining, last.stack) == ((), ())
    nodes = {node.key: node for node in picture.nodes}
    visited = {run[0][0].tail, *(edge.head for edge, _ in run)}
    assert {key for key, node in nodes.items() if node.highlighted} == visited
    assert nodes[run[-1][0].head].double
    assert picture.initial[0].head == run[0][0].tail


@pytest.mark.parametrize("word", ["B eps JO eps EN", " ".join(FIGURE)])
def test_the_red_path_of_the_finite_automaton(lang: Language, word: str) -> None:
    picture = family_dfa_view(lang, word.split())
    assert "of the family" in picture.title
    # B, eps, JO, (eps, one of JO L, ...), eps, EN, after which eps and any module but B come.
    assert (len(picture.nodes), len(double(picture))) == (7, 1)
    at, used = picture.initial[0].head, set()
    for symbol in word.split():
        (i,) = [
            i
            for i, edge in enumerate(picture.edges)
            if edge.highlighted and edge.tail == at and symbol in edge.lines
        ]
        at = picture.edges[i].head
        used.add((i, symbol))
    assert next(node for node in picture.nodes if node.key == at).double
    shown = {(i, s) for i, e in enumerate(picture.edges) if e.highlighted for s in e.lines}
    assert shown == used
    assert {edge.lines for edge in picture.edges if edge.highlighted} <= {
        ("B",), ("eps",), ("JO",), ("L",), ("EN",), ("JO", "L"),
    }  # fmt: skip


def test_the_title_says_which_finite_automaton(lang: Language) -> None:
    nested = language(grammar(TRAPS["counted"], ALPHABET), ALPHABET, frozenset("a"))
    picture = family_dfa_view(nested, ("b", "a"))
    assert "accept condition only" in picture.title
    assert edges(picture) == [("", "q0", ""), ("q0", "q0", "a\nb"), ("q0", "q0", "c")]
    assert not dfa_view(lang.accept).title


def test_the_grammar(lang: Language) -> None:
    found = edges(grammar_view(lang))
    assert ("N", "p1", "") in found
    assert [e for e in found if e[0] == "p1"] == [
        ("p1", "N", "1"),
        ("p1", "eps", "2"),
        ("p1", "JO", "3"),
    ]


def test_the_red_productions_derive_the_word(lang: Language) -> None:
    nodes, run = red(grammar_view(lang, ["B", "eps", "JO", "eps", "EN"]))
    assert nodes == {"N", "p0", "p1", "p3", "B", "JO", "EN", "eps"}
    assert {tail for tail, _, _ in run} == {"N", "p0", "p1", "p3"}
    assert len(run) == 3 + 1 + 3 + 3


VIEWS = {
    "sra": lambda lang, word: sra_view(sra(lang.srg, lang.accept), word),
    "dfa": family_dfa_view,
    "words": lambda lang, word: words_view(lang, 3, word),
    "grammar": grammar_view,
}


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("B eps X", "`X` is not a symbol"),
        ("B eps L eps EN", "`B eps L eps EN` is not accepted"),
        ("EN", "`EN` is not accepted"),
        ("", "the empty word is not accepted"),
    ],
)
def test_words_without_a_run(lang: Language, view: str, word: str, message: str) -> None:
    with pytest.raises(HighlightError, match=message):
        VIEWS[view](lang, tuple(word.split()))


@pytest.mark.parametrize("name", TRAPS)
def test_words_of_all_shapes(name: str) -> None:
    trap = language(grammar(TRAPS[name], ALPHABET), ALPHABET, frozenset("ab"))
    picture = words_view(trap, 3)
    states = {" ".join(node.data["word"]) for node in picture.nodes}
    finite = trap.is_finite(max_modules=3)
    words = [w for w in trap.words(max_modules=3, max_length=None if finite else 7) if w]
    assert states == {" ".join(w) for w in islice(words, 10_000)}
    assert {e[1] for e in edges(picture)} == states
    for word in words[-3:]:
        nodes, run = red(words_view(trap, 1, word))
        assert " ".join(word) in nodes
        assert len(run) == len(nodes) - 1
        # Every transition leads from a state of the run to a longer one.
        assert len({tail for tail, _, _ in run}) == len({head for _, head, _ in run}) == len(run)
        assert all(len(tail) < len(head) for tail, head, _ in run)


@pytest.mark.parametrize(
    ("part", "word", "symbols"),
    [
        ("a", "a b c", "b c"),
        ("a c", "a b c", "b"),
        ("F E ]", "F [ ] E ]", "[ ]"),
        ("[ ]", "[ [ ] ]", "[ ]"),
        ("a b", "a a b b", "a b"),
        ("x y", "x a x b y", "a x b"),
        ("", "a b", "a b"),
    ],
)
def test_what_is_added_comes_in_few_runs(part: str, word: str, symbols: str) -> None:
    assert added(tuple(part.split()), tuple(word.split())) == tuple(symbols.split())


@settings(max_examples=examples(100, 200), deadline=None)
@given(st.lists(st.sampled_from("abc"), max_size=9), st.data())
def test_runs_added_are_the_fewest(letters: list[str], data: st.DataObject) -> None:
    kept = data.draw(st.lists(st.booleans(), min_size=len(letters), max_size=len(letters)))
    part = tuple(s for s, keep in zip(letters, kept, strict=True) if keep)

    def runs(keeps: tuple[bool, ...]) -> int:
        return sum(not k and (i == 0 or keeps[i - 1]) for i, k in enumerate(keeps))

    ways = {
        keeps: tuple(s for s, k in zip(letters, keeps, strict=True) if not k)
        for keeps in product((False, True), repeat=len(letters))
        if tuple(s for s, k in zip(letters, keeps, strict=True) if k) == part
    }
    fewest = min(map(runs, ways))
    found = added(part, tuple(letters))
    assert found in {rest for keeps, rest in ways.items() if runs(keeps) == fewest}
