"""``robust start`` and ``robust effort``."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]

TASK = """
task P {{
  robot G; workspace W; start in S; reach T; effort <= 10 N*m; horizon 80 steps of 0.125 s;
  {}
}}
"""


@pytest.fixture(scope="session")
def robust(build: Build) -> Callable[[str], ir.Robust | None]:
    def make(text: str) -> ir.Robust | None:
        loaded = load_text(build(task=TASK.format(text)), "t")
        assert loaded.program is not None, loaded.diagnostics
        return loaded.program.tasks["P"].robust

    return make


def test_each_kind(robust: Callable[[str], ir.Robust | None]) -> None:
    assert robust("") is None
    found = robust("robust start 1 mm 0.25 rad, 2 cm/s; robust start (0.5 * 3) rad/s;")
    assert found == ir.Robust(
        length=Fraction(1, 1000),
        angle=Fraction(1, 4),
        speed=Fraction(1, 50),
        angular_rate=Fraction(3, 2),
    )
    assert found is not None
    assert len(found.spans) == 2
    assert robust("robust effort 2.5 %;") == ir.Robust(effort=Fraction(1, 40))


@pytest.mark.parametrize("text", ["180 deg", "0.1 deg", "(180 / pi) deg", "(1 / (7 * pi)) rad"])
def test_angles_are_rounded_up(text: str, robust: Callable[[str], ir.Robust | None]) -> None:
    """Against 60 digits of pi; a larger disturbance is borne, not a smaller one."""
    digits = 314159265358979323846264338327950288419716939937510582097494
    pi = (Fraction(digits, 10**59), Fraction(digits + 1, 10**59))
    exact = {
        "180 deg": pi[1],
        "0.1 deg": pi[1] / 1800,
        "(180 / pi) deg": Fraction(1),
        "(1 / (7 * pi)) rad": 1 / (7 * pi[0]),
    }[text]
    found = robust(f"robust start {text};")
    assert found is not None
    assert exact <= found.angle <= exact * (1 + Fraction(1, 10**30))
    assert math.isclose(float(found.angle), float(exact))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("robust start 1;", [("UNIT_MISMATCH", "1")]),
        ("robust start 1 kg;", [("UNIT_MISMATCH", "1 kg")]),
        ("robust start (1 m / 1 m);", [("UNIT_MISMATCH", "1 m / 1 m")]),
        ("robust start 1 mm 2 mm;", [("REPEATED_CLAUSE", "2 mm")]),
        ("robust start 1 mm; robust start 2 deg, 2 cm;", [("REPEATED_CLAUSE", "2 cm")]),
        ("robust start 0 mm;", [("BAD_VALUE", "0 mm")]),
        ("robust start (-1) mm;", [("BAD_VALUE", "(-1) mm")]),
        ("robust start (sqrt(2)) mm;", [("NOT_RATIONAL", "(sqrt(2)) mm")]),
        ("robust effort 0 %;", [("BAD_VALUE", "0")]),
        ("robust effort 100 %;", [("BAD_VALUE", "100")]),
        ("robust effort 1 N %;", [("UNIT_MISMATCH", "1 N")]),
        ("robust effort 1 %; robust effort 2 %;", [("REPEATED_CLAUSE", "robust effort 2 %;")]),
    ],
)
def test_findings(
    text: str, found: list[tuple[str, str]], check_fragment: Check, build: Build
) -> None:
    assert check_fragment(build(task=TASK.format(text))) == found
