from __future__ import annotations

import gc

import pytest

from grammar_lang.parsing.parse import without_collection


@without_collection
def half(number: int, *, fail: bool = False) -> tuple[int, bool]:
    """Halve."""
    if fail:
        raise ValueError(number)
    inner = half(number - 1)[1] if number > 1 else gc.isenabled()
    return number // 2, inner


def test_the_collector_rests_during_a_call_and_not_after_it() -> None:
    assert gc.isenabled()
    assert half(7) == (3, False)
    assert gc.isenabled()
    with pytest.raises(ValueError, match="7"):
        half(7, fail=True)
    assert gc.isenabled()


def test_who_has_switched_it_off_finds_it_so() -> None:
    gc.disable()
    try:
        assert half(4) == (2, False)
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_the_function_keeps_its_name() -> None:
    assert (half.__name__, half.__doc__) == ("half", "Halve.")
