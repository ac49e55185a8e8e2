"""What the suites take parts of: `make test`, `make test-slow`, and `make campaigns`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import settings

USUAL, OTHERS = "same", "others"
"""The profiles of Hypothesis: that of the usual suite, and that of `make test-slow`."""


def some(cases: Iterable[Any], count: int) -> list[Any]:
    """The cases, all but the first so many marked as slow; a tuple is of several arguments."""
    listed = [one if isinstance(one, tuple) else (one,) for one in cases]
    return [
        *(pytest.param(*one) for one in listed[:count]),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in listed[count:]),
    ]


def campaign(cases: Iterable[Any], count: int) -> list[Any]:
    """Many cases of one kind: the first so many for `make test-slow`, the rest for campaigns."""
    slow, further = pytest.mark.slow, pytest.mark.campaign
    return [
        pytest.param(case, marks=[slow] if number < count else [slow, further])
        for number, case in enumerate(cases)
    ]


def examples(usual: int, slow: int) -> int:
    """How many examples Hypothesis draws in the usual suite, and in `make test-slow`."""
    return usual if settings.get_current_profile_name() == USUAL else slow
