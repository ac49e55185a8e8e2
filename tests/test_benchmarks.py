"""What the benchmarks measure is what they say."""

from __future__ import annotations

import pytest

from benchmarks.large_spec import FORMULA_EVERY, large_spec
from grammar_lang.load import load_text
from srgc.session import check_loaded


@pytest.mark.parametrize("size", [1, 10_000, 40_000])
def test_large_specifications_are_sound_and_of_their_size(size: int) -> None:
    text = large_spec(size)
    assert size <= len(text) < size + 4_000
    checked = check_loaded(load_text(text, "large.srg"))
    assert checked.program is not None
    assert not checked.diagnostics
    cells = len(checked.program.tasks)
    assert len(checked.program.grammars) == len(checked.program.workspaces) == cells
    formulas = sum(len(task.satisfy) for task in checked.program.tasks.values())
    assert formulas == cells // FORMULA_EVERY
