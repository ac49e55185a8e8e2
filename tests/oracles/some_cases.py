"""Many cases of one kind: the first of them in the usual suite, all in `make test-slow`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def some(cases: Iterable[Any], count: int) -> list[Any]:
    """The cases, all but the first so many marked as slow."""
    listed = list(cases)
    return [*listed[:count], *(pytest.param(one, marks=pytest.mark.slow) for one in listed[count:])]
