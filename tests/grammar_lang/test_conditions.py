from __future__ import annotations

import pytest
from hypothesis import given, settings

from grammar_lang import ir
from grammar_lang.conditions import condition_of, condition_text
from tests.oracles.grammars import accepts
from tests.oracles.some_cases import examples

SYMBOLS = ("a", "b", "c")


@settings(deadline=None, max_examples=examples(60, 300))
@given(accepts(SYMBOLS))
def test_read_again_a_condition_is_the_same(condition: ir.Accept) -> None:
    text = condition_text(condition)
    try:
        found = condition_of(text, SYMBOLS)
    except ValueError:  # what the language does not say: empty words, parts of one
        assert not _sayable(condition)
        return
    assert condition_text(found) == text


def _sayable(condition: ir.Accept) -> bool:
    match condition:
        case ir.AllOf(parts) | ir.AnyOf(parts):
            return len(parts) > 1 and all(map(_sayable, parts))
        case ir.NotAccept(part):
            return _sayable(part)
        case ir.Contains(word) | ir.StartsWith(word) | ir.EndsWith(word):
            return bool(word)
        case ir.Matches(regex):
            return _expressible(regex)
        case _:
            return True


def _expressible(regex: ir.Regex) -> bool:
    match regex:
        case ir.RSequence(parts) | ir.RChoice(parts):
            return len(parts) > 1 and all(map(_expressible, parts))
        case ir.RRepeat(part, _):
            return _expressible(part)
        case _:
            return True


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("count(L) <= 11", ir.Count("L", "<=", 11)),
        ("length >= 1", ir.Count(None, ">=", 1)),
        (
            "count(L) <= 2 and count(J) == 1",
            ir.AllOf((ir.Count("L", "<=", 2), ir.Count("J", "==", 1))),
        ),
        (
            "(contains L or contains J) and not ends with J",
            ir.AllOf((
                ir.AnyOf((ir.Contains(("L",)), ir.Contains(("J",)))),
                ir.NotAccept(ir.EndsWith(("J",))),
            )),
        ),
        (
            "matches L (J L)? (J | L)*",
            ir.Matches(ir.RSequence((
                ir.RSymbol("L"),
                ir.RRepeat(ir.RSequence((ir.RSymbol("J"), ir.RSymbol("L"))), "?"),
                ir.RRepeat(ir.RChoice((ir.RSymbol("J"), ir.RSymbol("L"))), "*"),
            ))),
        ),
    ],
)  # fmt: skip
def test_texts(text: str, condition: ir.Accept) -> None:
    assert condition_text(condition) == text
    assert condition_of(text, ("L", "J")) == condition


@pytest.mark.parametrize(
    "text",
    [
        "", "count(X) <= 1", "count(L)<=1", "count(L) <= 1;", "L", "count(L) <= 1 and",
        "count(L) <= 1; } grammar Q { start A; x: A -> empty; accept count(L) <= 1",
        "count(L) <= 1 // and more", "count(L) <= 01",
    ],
)  # fmt: skip
def test_what_is_no_condition(text: str) -> None:
    with pytest.raises(ValueError, match="is not a condition on words of the family"):
        condition_of(text, ("L", "J"))
