from __future__ import annotations

import random
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang.diagnostics import Severity
from grammar_lang.load import load_text
from grammar_lang.render import to_json, to_text

TOKEN = re.compile(r"\s+|[A-Za-z_]\w*|[0-9.]+|->|<=|>=|.")
NOISE = "@é0;{}()[]\t\\'\"/*x-^\0"


def mutated(text: str, seed: int) -> str:
    """The text with one to four tokens deleted, repeated, exchanged or spoilt."""
    chance = random.Random(seed)
    tokens = TOKEN.findall(text)
    for _ in range(chance.randint(1, 4)):
        here, there = chance.randrange(len(tokens)), chance.randrange(len(tokens))
        match chance.randrange(5):
            case 0:
                del tokens[here]
            case 1:
                tokens[here] = tokens[there]
            case 2:
                tokens.insert(here, tokens[there])
            case 3:
                tokens[here], tokens[there] = tokens[there], tokens[here]
            case _:
                tokens[here] = tokens[here][:-1] + chance.choice(NOISE)
    return "".join(tokens)


def survives(text: str) -> None:
    loaded = load_text(text, "t.srg")
    failed = any(d.severity is Severity.ERROR for d in loaded.diagnostics)
    assert (loaded.program is None) == failed
    for found in loaded.diagnostics:
        assert found.hint
        assert "\n" not in found.message
        assert 0 <= found.span.start <= found.span.end <= len(text) + 1
    assert to_text(loaded.diagnostics, loaded.sources).count("hint: ") >= len(loaded.diagnostics)
    to_json(loaded.diagnostics, loaded.sources)


@pytest.mark.parametrize("block", range(8))
def test_mutations_give_diagnostics(block: int, arm: str) -> None:
    for seed in range(50 * block, 50 * (block + 1)):
        survives(mutated(arm, seed))


@given(st.text(alphabet=st.characters(exclude_categories=["Cs"]), max_size=60))
def test_any_text(text: str) -> None:
    survives(text)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(8))
def test_many_mutations(block: int, arm: str) -> None:
    for seed in range(1000 + 500 * block, 1000 + 500 * (block + 1)):
        survives(mutated(arm, seed))
