from __future__ import annotations

import pytest

from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import srg
from compiler.words.intersection import IntersectionTooLargeError, binary_normal_form, intersect
from grammar_lang import ir
from tests.oracles.grammars import grammar


@pytest.mark.parametrize("length", [5, 20])
def test_the_limit_is_on_rules_and_steps(length: int) -> None:
    rules = srg(grammar("N -> a N | a", ("a",)), ("a",), ())
    normal = binary_normal_form(rules.cfg)
    accept = accept_dfa(ir.Count(None, "<=", length), ("a",))
    free = intersect(normal, accept)
    size = sum(map(len, free.rules))
    assert size > length
    assert intersect(normal, accept, 100 * size) == free
    with pytest.raises(IntersectionTooLargeError):
        intersect(normal, accept, size - 1)
