"""Our parser against lark's, on sentences drawn from the grammar itself and on spoilt ones."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import pytest
from lark import Token, Transformer_NonRecursive, UnexpectedInput
from lark.grammar import Rule
from lark.tree import Meta

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.parsing import lalr
from grammar_lang.parsing.parse import parse
from grammar_lang.parsing.tree_builder import BUILDERS
from grammar_lang.source import Span
from tests.oracles.programs import POOLS, grammar, random_item
from tests.oracles.some_cases import campaign, some

FAST_BLOCKS, SLOW_BLOCKS, SIZE = 5, 100, 150
GAPS = (" ", "\n", "  ", "\t", " // c\n", "/* c */", "\r\n")


class Fold(Transformer_NonRecursive):
    """The builders on lark's own tree."""

    def __default__(self, data: Any, children: list[Any], meta: Meta) -> object:
        made = [self.token(c) if isinstance(c, Token) else c for c in children]
        return BUILDERS[str(data)](made, Span(meta.start_pos, meta.end_pos))

    def token(self, token: Token) -> lalr.Token:
        return lalr.Token(token.type, str(token), Span(token.start_pos or 0, token.end_pos or 0))


def written(choose: random.Random, texts: Sequence[str]) -> str:
    """The tokens with blanks and comments between them, sometimes with nothing."""
    gaps = [" " if choose.random() < 0.8 else choose.choice(GAPS) for _ in texts]
    tight = choose.random() < 0.3
    return "".join(
        text + ("" if tight and not (text[-1].isalnum() or text[-1] == "_") else gap)
        for text, gap in zip(texts, gaps, strict=True)
    )


def vocabulary() -> tuple[str, ...]:
    """Every terminal that is a text, and examples of the others."""
    literals = (str(t.pattern.value) for t in grammar().terminals if t.pattern.type == "str")
    return (*sorted(literals), *(text for pool in POOLS.values() for text in pool))


def spoilt(choose: random.Random, texts: list[str], words: Sequence[str]) -> list[str]:
    """The tokens with one lost, doubled, replaced or put in, or two exchanged."""
    here = choose.randrange(len(texts))
    rest = texts[here + 1 :]
    match choose.randrange(5):
        case 0:
            return texts[:here] + rest
        case 1:
            return [*texts[: here + 1], texts[here], *rest]
        case 2:
            return [*texts[:here], choose.choice(words), *rest]
        case 3:
            return [*texts[:here], choose.choice(words), texts[here], *rest]
        case _:
            return [*texts[:here], *rest[:1], texts[here], *rest[1:]]


def agree(text: str) -> bool:
    """Both refuse the text as an item, or both make the same of it; True where they do."""
    sink = Sink()
    file = parse(text, sink)
    try:
        tree = grammar().parse(text)
    except UnexpectedInput:
        assert sink.found or len(file.items) != 1, text
        return False
    assert not sink.found, (text, sink.found)
    (item,) = file.items
    assert repr(item) == repr(Fold().transform(tree)), text
    return True


def compare(block: int) -> None:
    """A few sentences are refused as well: after a number, a name that could be a unit is one."""
    choose, used = random.Random(block), set[Rule]()
    words = vocabulary()
    accepted = refused = 0
    for _ in range(SIZE):
        texts = random_item(choose, used)
        accepted += agree(written(choose, texts))
        for _ in range(3):
            refused += not agree(written(choose, spoilt(choose, texts, words)))
    assert accepted > 0.6 * SIZE
    assert refused > SIZE


@pytest.mark.parametrize("block", some(range(FAST_BLOCKS), 2))
def test_the_parser_agrees_with_lark(block: int) -> None:
    compare(block)


@pytest.mark.parametrize("block", campaign(range(1000, 1000 + SLOW_BLOCKS), 25))
def test_the_parser_agrees_with_lark_on_many(block: int) -> None:
    compare(block)
