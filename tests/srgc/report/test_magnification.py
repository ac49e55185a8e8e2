"""How many times as wide a box of the tube is drawn, in words."""

from __future__ import annotations

import pytest

from srgc.report.animation import power_text


@pytest.mark.parametrize(("number", "said"), [(1e8, "10\u2078"), (1e15, "10\u00b9\u2075")])
def test_powers_of_ten_are_written_as_such(number: float, said: str) -> None:
    """They were written as in programs, `1e08`."""
    assert power_text(number) == said
