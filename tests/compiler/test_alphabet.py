from __future__ import annotations

from hypothesis import given

from compiler.words.grammar import alphabet_of
from compiler.words.language import language
from grammar_lang import ir
from tests.oracles.grammars import ALPHABET, grammar, random_grammars

ORDER = {"x": 0, "c": 1, "b": 2, "y": 3, "a": 4}


def test_only_what_is_used_in_order_of_declaration() -> None:
    assert alphabet_of(grammar("S -> a S | b", ALPHABET), ORDER) == ("b", "a")
    accept = ir.NotAccept(
        ir.AnyOf(
            (
                ir.Contains(("x",)),
                ir.AllOf((ir.Count("y", "<", 2), ir.Count(None, "<", 9))),
                ir.Matches(
                    ir.RSequence((ir.RRepeat(ir.RChoice((ir.RSymbol("c"), ir.REmpty())), "*"),))
                ),
            )
        )
    )
    assert alphabet_of(grammar("S -> a", ALPHABET, accept), ORDER) == ("x", "c", "y", "a")
    assert alphabet_of(grammar("S -> a", ALPHABET, ir.StartsWith(("c", "b"))), ORDER) == (
        "c", "b", "a",
    )  # fmt: skip


@given(random_grammars())
def test_the_language_is_the_same(g: ir.Grammar) -> None:
    every = ("x", "a", "y", "b")
    small = alphabet_of(g, {name: i for i, name in enumerate(every)})
    one, other = language(g, every, every), language(g, small, every)
    assert list(one.words(max_length=3)) == list(other.words(max_length=3))
    assert one.is_finite() == other.is_finite()
