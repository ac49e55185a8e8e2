"""The configurations on the way to another robot, against a search of all that could be on it."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from compiler.robots.alignment import alignment
from compiler.robots.reconfiguration import configurations, reconfiguration
from compiler.words.grammar import srg
from grammar_lang import ir
from tests.oracles.brute_force_grammar import words_of
from tests.oracles.grammars import arm, grammar, random_grammars
from tests.oracles.some_cases import examples
from tests.oracles.word_changes import arrangements, cheapest, distance, largest_step

TERMINALS = ("B", "J", "L", "E", "eps", "[", "]")
MODULES = frozenset({"B", "J", "L", "E"})


def way(text: str, old: str, new: str) -> list[str]:
    rules = srg(grammar(text, TERMINALS), TERMINALS, MODULES)
    found = reconfiguration(rules, tuple(old.split()), tuple(new.split()))
    return [" ".join(word) for word in found.configurations]


CHAIN = "N -> B | N eps J | N eps L | N eps E"
RIGHT = "N -> B eps T\nT -> J eps T | L eps T | E"
NESTED = "N -> B | [ N eps L ]"
BRANCHING = "N -> B | N [ C ]\nC -> J | C eps L | C eps E"
PAIRS = "N -> B | N eps J eps L | N eps E"


@pytest.mark.parametrize(
    ("text", "old", "new", "between"),
    [
        (CHAIN, "B eps J eps E", "B eps J eps E", None),
        # A link in front of the tool; a tool is no reason to take the arm apart.
        (CHAIN, "B eps J eps E", "B eps J eps L eps E", []),
        (CHAIN, "B eps J eps E", "B eps J eps L eps L eps E", ["B eps J eps L eps E"]),
        # First what goes, from the end; then what comes, from the base.
        (CHAIN, "B eps L eps E", "B eps J eps J", ["B eps L", "B", "B eps J"]),
        # A tool at the end always, for the grammar ends words so: it grows in front of it.
        (RIGHT, "B eps J eps E", "B eps J eps L eps L eps E", ["B eps J eps L eps E"]),
        (RIGHT, "B eps J eps E", "B eps L eps J eps E", []),
        # Edges about what is kept come with the module.
        (NESTED, "B", "[ [ B eps L ] eps L ]", ["[ B eps L ]"]),
        # A branch is taken off module by module, and the next one built up.
        (
            BRANCHING,
            "B [ J eps L ] [ J eps E ]",
            "B [ J eps L eps L ]",
            ["B [ J eps L ] [ J ]", "B [ J eps L ]"],
        ),
        # Two modules at once where a production adds two.
        (PAIRS, "B eps J eps L", "B eps J eps L eps J eps L eps J eps L",
         ["B eps J eps L eps J eps L"]),
        (PAIRS, "B eps E", "B eps J eps L", ["B"]),
        # One for the other, by way of both: the grammar has no robot without.
        ("N -> B eps J | B eps J eps L | B eps L", "B eps J", "B eps L", ["B eps J eps L"]),
        ("N -> B eps J | B eps L eps J | B eps L", "B eps J", "B eps L", ["B eps L eps J"]),
        # At once, where the grammar has nothing on the way.
        ("N -> B eps J eps J | B eps L eps L", "B eps J eps J", "B eps L eps L", []),
        # Only the edges differ: no module changes.
        ("N -> B eps J | B [ J ]", "B eps J", "B [ J ]", []),
    ],
)  # fmt: skip
def test_by_hand(text: str, old: str, new: str, between: list[str] | None) -> None:
    assert way(text, old, new) == ([old] if between is None else [old, *between, new])


def test_the_edges_of_a_configuration_are_those_of_the_one_before() -> None:
    """Of two words with the modules B L, the one that keeps the bracket."""
    text = "N -> B | N eps L | N [ L ]"
    assert way(text, "B [ L ]", "B [ L ] eps L eps L") == [
        "B [ L ]",
        "B [ L ] eps L",
        "B [ L ] eps L eps L",
    ]
    assert way(text, "B [ L ] [ L ]", "B") == ["B [ L ] [ L ]", "B [ L ]", "B"]


@settings(deadline=None, max_examples=examples(8, 15))
@given(random_grammars(), st.data())
def test_random_grammars(g: ir.Grammar, data: st.DataObject) -> None:
    symbols, modules = ("a", "b"), data.draw(st.sampled_from([frozenset("ab"), frozenset("a")]))
    words = sorted(word for word in words_of(g, 4) if word and set(word) & modules)
    assume(len(words) > 1)
    old, new = data.draw(st.sampled_from(words)), data.draw(st.sampled_from(words))
    aligned = alignment(old, new, modules)
    assume(aligned.distance <= 5)
    found = configurations(srg(g, symbols, modules), old, new, aligned)
    assert (found[0], found[-1]) == (old, new)
    assert len(set(found)) == len(found)
    # Longer words can be on the way than those that were listed.
    short = words_of(g, 10) if sum(map(len, (old, new))) <= 10 else set(words)
    assert all(word in short or len(word) > 10 for word in found)
    steps = [distance(one, two, modules) for one, two in pairwise(found)]
    assert sum(steps) == aligned.distance == cheapest(old, new, modules)[0]
    bare = {tuple(s for s in word if s in modules) for word in short}
    states = list(arrangements(list(aligned.kept), aligned.removed, aligned.added))
    first = next(s for s in states if _is(s, "old", old, modules))
    last = next(s for s in states if _is_new(s, aligned.kept, new, modules))

    def allowed(state: tuple[tuple[str, int], ...]) -> bool:
        names = tuple((old if source == "old" else new)[i] for source, i in state)
        return bool(names) and names in bare

    if modules == frozenset("ab"):
        assert max(steps, default=0) == largest_step(states, first, last, allowed)


def _is(state, source, word, modules) -> bool:
    places = [i for i, symbol in enumerate(word) if symbol in modules]
    return list(state) == [(source, i) for i in places]


def _is_new(state, kept, word, modules) -> bool:
    places = {("old", i): j for i, j in kept}
    found = [places.get(slot, slot[1] if slot[0] == "new" else -1) for slot in state]
    return found == [j for j, symbol in enumerate(word) if symbol in modules]


def test_a_limit_of_trials_is_one_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compiler.robots.reconfiguration.MOST_TRIALS", 0)
    assert way(CHAIN, "B", "B eps J eps L eps L") == ["B", "B eps J eps L eps L"]


def test_twelve_modules() -> None:
    """The running example from end to end of its range: every step is one module."""
    terminals = ("B", "JO", "L", "EN", "eps")
    rules = srg(arm(), terminals, frozenset(terminals[:4]))
    old = tuple(" eps ".join(["B", *["JO", "L"] * 5, "EN"]).split())
    new = tuple(" eps ".join(["B", *["EN", "JO", "JO"] * 3, "L", "L"]).split())
    aligned = alignment(old, new, rules.modules)
    found = configurations(rules, old, new, aligned)
    assert len(found) == aligned.distance + 1
    assert all(distance(one, two, rules.modules) == 1 for one, two in pairwise(found))
