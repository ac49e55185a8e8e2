"""Spoilt programs: 2,000 of them, and a hundred times as many with ``make test-slow``.

No exception, no hang, an error if and only if there is no program, and findings fit to be shown.
A failure prints its program, which :func:`survive` makes again of its number.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.oracles.mutations import seeds, spoilt_bytes, spoilt_text
from tests.oracles.some_cases import campaign, examples
from tests.oracles.survival import (
    TooSlow,
    check_survives,
    expansion_survives,
    file_survives,
    format_survives,
    load_survives,
    time_bound,
)

FAST_BLOCKS, FAST = 5, examples(200, 1000)
SLOW_BLOCKS, SLOW = 100, 2000

# What the programs go through, in turn.
STAGES: tuple[Callable[[str], None], ...] = (
    check_survives,
    load_survives,
    format_survives,
    check_survives,
    load_survives,
    load_survives,
    expansion_survives,
)


def survive(number: int, folder: Path) -> None:
    """The program of that number; every eighth is spoilt in its bytes and read from a file."""
    chance = random.Random(number)
    program: bytes | str
    stage: Callable[[], None]
    if number % 8 == 7:
        data = spoilt_bytes(chance, chance.choice(seeds()))
        program, stage = data, lambda: file_survives(data, folder)
    else:
        text = spoilt_text(chance)
        program, stage = text, lambda: STAGES[number % 8](text)
    try:
        with time_bound():
            stage()
    except Exception as error:
        raise AssertionError(f"program {number}: {error!r}\n{program!r}") from error


@pytest.mark.parametrize("block", range(FAST_BLOCKS))
def test_spoilt_programs(block: int, tmp_path: Path) -> None:
    for number in range(FAST * block, FAST * (block + 1)):
        survive(number, tmp_path)


@pytest.mark.parametrize("block", campaign(range(SLOW_BLOCKS), 25))
def test_many_spoilt_programs(block: int, tmp_path: Path) -> None:
    for number in range(10**6 + SLOW * block, 10**6 + SLOW * (block + 1)):
        survive(number, tmp_path)


@pytest.mark.parametrize("number", range(len(seeds())))
def test_the_programs_to_start_from(number: int, tmp_path: Path) -> None:
    with time_bound():
        file_survives(seeds()[number].encode(), tmp_path)
        format_survives(seeds()[number])


@given(st.text(max_size=60))
def test_any_text(text: str) -> None:
    load_survives(text)
    format_survives(text)


@given(data=st.binary(max_size=60))
def test_any_bytes(data: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    file_survives(data, tmp_path_factory.getbasetemp())


def _endless() -> None:
    with time_bound(0.05):
        while True:
            pass


def test_the_time_bound_stops_a_loop() -> None:
    with pytest.raises(TooSlow):
        _endless()
