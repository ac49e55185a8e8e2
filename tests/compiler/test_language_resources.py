"""Questions that once took the product grammar, or memory, that they did not need.

What must not be built is made to fail, so that no clock is needed.
"""

from __future__ import annotations

from itertools import islice

import pytest

from compiler.words import language as language_module
from compiler.words.budget import LENGTH_LIMIT, WordsTooLongError
from compiler.words.language import Language, language
from compiler.words.residuals import Residuals
from grammar_lang import ir
from tests.oracles.grammars import EVERY, grammar

AB = ("a", "b")
NESTED = "S -> a S b | S S | a b"


def over(text: str, accept: ir.Accept = EVERY) -> Language:
    return language(grammar(text, AB, accept), AB, frozenset(AB))


@pytest.fixture
def no_product(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise AssertionError("the product grammar was built")

    monkeypatch.setattr(language_module, "intersect", fail)


@pytest.mark.usefixtures("no_product")
def test_bounds_of_length_need_no_product_grammar() -> None:
    bound = ir.Count(None, "<=", 2000)
    assert list(islice(over("S -> a S | b", bound).words(), 2)) == [("b",), ("a", "b")]
    assert over("S -> a S | b", bound).longest() == 2000
    assert over(NESTED, ir.Count(None, "<=", 301)).longest() == 300
    assert next(over(NESTED, ir.Count(None, "<=", 300)).words()) == ("a", "b")
    assert over("S -> a S b S | empty", ir.Count("a", "==", 200)).count_words(20) == (0,) * 21
    assert over(NESTED, ir.Count(None, "<", 2)).is_empty()


@pytest.mark.usefixtures("no_product")
def test_first_words_of_a_chain_of_empty_productions() -> None:
    k = 300
    links = [f"N{i}n -> N{i + 1}n N{(7 * i + 3) % k}n | empty" for i in range(k)]
    lang = over("\n".join([*links, f"N{k}n -> a | a N0n b"]))
    assert list(islice(lang.words(), 3)) == [(), ("a",), ("a", "a")]


def doubling_rules(levels: int) -> str:
    """One word, of 2 ** levels symbols."""
    rules = [f"S{i}n -> S{i + 1}n S{i + 1}n" for i in range(levels)]
    return "\n".join([*rules, f"S{levels}n -> a"])


def doubling(levels: int) -> Language:
    return over(doubling_rules(levels))


def test_an_exponentially_long_word_is_refused_by_its_length() -> None:
    assert doubling(10).shortest_word() == ("a",) * 1024
    assert doubling(10).count_words() == (*[0] * 1024, 1)
    huge = doubling(40)
    assert huge.longest() == 2**40 > LENGTH_LIMIT
    for question in (huge.shortest_word, huge.count_words, lambda: next(huge.words())):
        with pytest.raises(WordsTooLongError, match=str(LENGTH_LIMIT)):
            question()
    assert huge.accepts(("a",) * 1000) is False
    # Whether there is an end is known without looking for it.
    assert over(doubling_rules(40), ir.Count("a", ">=", 1)).is_finite()
    assert list(huge.words(max_length=10)) == []


def test_optional_nesting_has_few_items_per_prefix() -> None:
    """Any of the a may be closed later: what includes what is known, and said once."""
    lang = over("S -> S S | a | b | a S b")
    residuals = Residuals(lang.binary, AB)
    residual = residuals.root
    sizes = []
    for _ in range(200):
        residual = residual["a"]
        sizes.append(len(residual.agenda))
    assert max(sizes) == max(sizes[:10])
    assert lang.accepts(("a",) * 3000)
    assert lang.accepts(("a",) * 1500 + ("b",) * 1500)
