from __future__ import annotations

import pytest
from hypothesis import given, settings

from compiler.words.language import language
from compiler.words.recogniser import viable_prefix
from grammar_lang import ir
from tests.oracles.brute_force_grammar import Word, all_words, words_of
from tests.oracles.grammars import ALPHABET, TRAPS, grammar, random_grammars
from tests.oracles.some_cases import examples

AB = ("a", "b")
LENGTH = 5


def productive(g: ir.Grammar) -> set[str]:
    """The nonterminals that derive some word."""
    found: set[str] = set()
    while True:
        more = {
            p.left
            for p in g.productions
            if all(s.kind != "nonterminal" or s.name in found for s in p.right)
        }
        if more <= found:
            return found
        found |= more


def prefixes(g: ir.Grammar, longest: int) -> set[Word]:
    """The beginnings of words, whatever their length: ``<A`` derives those of the words of A."""
    good = productive(g)
    if g.start not in good:
        return {()}
    productions: list[ir.Production] = []
    for p in g.productions:
        if not all(s.kind != "nonterminal" or s.name in good for s in p.right):
            continue
        productions.append(p)
        for i, symbol in enumerate(p.right):
            last = (symbol,)
            if symbol.kind == "nonterminal":
                last = (ir.Symbol(f"<{symbol.name}", "nonterminal"),)
            productions += [
                ir.Production("cut", f"<{p.left}", p.right[:i]),
                ir.Production("cut", f"<{p.left}", p.right[:i] + last),
            ]
        productions.append(ir.Production("none", f"<{p.left}", ()))
    names = (*g.nonterminals, *(f"<{name}" for name in g.nonterminals))
    cut = ir.Grammar("cut", f"<{g.start}", names, tuple(productions), ir.AllOf(()), None)
    return words_of(cut, longest)


def check(g: ir.Grammar, terminals: tuple[str, ...]) -> None:
    normal = language(g, terminals, ()).normal
    viable = prefixes(g, LENGTH)
    for word in all_words(terminals, LENGTH):
        expected = max(n for n in range(len(word) + 1) if word[:n] in viable)
        assert viable_prefix(normal, terminals, word) == expected


@settings(deadline=None, max_examples=examples(25, 60))
@given(random_grammars())
def test_random_grammars(g: ir.Grammar) -> None:
    check(g, AB)


@pytest.mark.parametrize("name", TRAPS)
def test_known_traps(name: str) -> None:
    check(grammar(TRAPS[name], ALPHABET), ALPHABET)


def test_the_accept_condition_is_left_aside() -> None:
    g = grammar("S -> a S b | c", ALPHABET, ir.Count("a", "<=", 1))
    normal = language(g, ALPHABET, ()).normal
    assert viable_prefix(normal, ALPHABET, ("a", "a", "c", "b", "b", "b")) == 5


def test_unknown_symbols_and_long_words() -> None:
    normal = language(grammar("S -> a S b | c", ALPHABET), ALPHABET, ()).normal
    assert viable_prefix(normal, ALPHABET, ("a", "d", "b")) == 1
    assert viable_prefix(normal, ALPHABET, ("",)) == 0
    assert viable_prefix(normal, ALPHABET, ()) == 0
    word = ("a",) * 5000 + ("c",) + ("b",) * 5000
    assert viable_prefix(normal, ALPHABET, word) == len(word)
    assert viable_prefix(normal, ALPHABET, (*word, "b")) == len(word)
    assert viable_prefix(normal, ALPHABET, (*word[:-3000], "a", "b")) == len(word) - 3000
