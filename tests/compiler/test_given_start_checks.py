"""Radii about given coordinates, against the ranges of the joints by hand."""

from __future__ import annotations

import pytest

from compiler.checks.given_start_checks import given_start_diagnostics
from grammar_lang.diagnostics.diagnostic import Code, Sink
from tests.oracles.formulas import program
from tests.oracles.joint_chains import chain_spec

JOINTS = {
    "J": "revolute z in [-30, 90] deg rate in [-1, 2] rad/s",
    "K": "prismatic x in [0, 2] m",
    "R": "revolute z rate in [0.1, 2] rad/s",
    "F": "revolute z rate in [-9, 9] rad/s",
}
ONE, TWO = "B eps J eps L eps E", "B eps J eps K eps L eps E"
MERGED = "B eps J eps J eps L eps E"
MANY = "B (eps J eps L)+ eps E"


def found(word: str, start: str, radii: str) -> list[tuple[str, str, list[str], str]]:
    """Severity, the text that is marked, those that the notes mark, and the message."""
    text = chain_spec(JOINTS, word, start, modules=40).replace(
        f"start at ({start});", f"start at ({start}); robust start {radii};"
    )
    assert "robust" in text
    sink = Sink([])
    given_start_diagnostics(program(text), sink)
    assert all(each.hint for each in sink.found)
    codes = {each.code for each in sink.found}
    assert codes <= {Code.WIDE_RADIUS} or codes == {Code.START_OF_NO_ROBOT}
    return [
        (
            each.severity.value,
            text[each.span.start : each.span.end],
            [text[span.start : span.end] for span, _ in each.notes],
            each.message,
        )
        for each in sink.found
    ]


@pytest.mark.parametrize(
    ("word", "start", "radii", "marked"),
    [
        (ONE, "0 deg", "29.99 deg", None),
        (ONE, "0 deg", "30.01 deg", ("30.01 deg", ["0 deg"])),
        (ONE, "-30 deg", "1 deg", ("1 deg", ["-30 deg"])),
        (ONE, "90 deg", "1 deg", ("1 deg", ["90 deg"])),
        (ONE, "90 deg", "0.5 rad/s", None),
        (ONE, "0 deg", "1 rad/s", None),
        (ONE, "0 deg", "1.1 rad/s", ("1.1 rad/s", ["0 deg"])),
        (ONE, "0 deg", "5 m", None),
        (TWO, "0 deg, 1.5 m", "1 deg, 500 mm", None),  # to the end, and not beyond
        (TWO, "0 deg, 1.5 m", "1 deg, 600 mm", ("600 mm", ["1.5 m"])),
        (TWO, "0 deg, 0.5 m", "600 mm", ("600 mm", ["0.5 m"])),
        # Two joints about one axis are one coordinate, in [-60, 180] deg.
        (MERGED, "-25 deg, 0 deg", "30 deg", None),
        (MERGED, "-25 deg, -10 deg", "30 deg", ("30 deg", ["-25 deg", "-10 deg"])),
        ("B eps F eps L eps E", "500 deg", "80 deg", None),  # no range
        # Words without end, of which those with two joints are one.
        (MANY, "0 deg, 80 deg", "11 deg", ("11 deg", ["80 deg"])),
        (MANY, "0 deg, 80 deg", "9 deg", None),
        ("B (eps L)+ eps J eps E", "80 deg", "11 deg", None),  # too many to be looked at
        # No robot fits, which is reported as such.
        (ONE, "0 deg, 0 deg", "60 deg", None),
    ],
)
def test_radii(word: str, start: str, radii: str, marked: tuple[str, list[str]] | None) -> None:
    assert [(a, b, c) for a, b, c, _ in found(word, start, radii)] == (
        [] if marked is None else [("error", *marked)]
    )


def test_some_robots() -> None:
    """Where a robot remains it is a warning: one of the joints has another range."""
    either = "B eps (J | F) eps L eps E"
    [(severity, at, _, message)] = found(either, "85 deg", "6 deg")
    assert (severity, at) == ("warning", "6 deg")
    assert message == "with these errors value 1 of the start may leave the range of its joint"


def test_rates_and_merged_joints_are_named() -> None:
    [(*_, message)] = found(ONE, "0", "1.1 rad/s")
    assert "the joint of value 1 of the start may be too fast for its range" in message
    [(*_, message)] = found(MERGED, "80 deg, 80 deg", "25 deg")
    assert "values 1 and 2 of the start may leave the range of their joints" in message


@pytest.mark.parametrize(
    ("word", "start", "marked"),
    [
        (ONE, "91 deg", "91 deg"),
        (ONE, "-30.1 deg", "-30.1 deg"),
        (ONE, "90 deg", None),
        (TWO, "0, 2.1 m", "2.1 m"),
        ("B eps (J | F) eps L eps E", "91 deg", None),
        # Merged joints have their ranges one by one, too.
        (MERGED, "91 deg, 0 deg", "start at (91 deg, 0 deg);"),
        (MERGED, "90 deg, 90 deg", None),
        (MANY, "0 deg, 91 deg", "91 deg"),
        ("B eps R eps L eps E", "0 deg", "start at (0 deg);"),  # it cannot rest
    ],
)
def test_coordinates_out_of_range(word: str, start: str, marked: str | None) -> None:
    for radii in ("", "; robust start 0.001 deg"):
        text = chain_spec(JOINTS, word, start, modules=40)
        sink = Sink([])
        given_start_diagnostics(program(text.replace(f"({start})", f"({start}){radii}")), sink)
        wide = [each for each in sink.found if each.code is Code.START_OF_NO_ROBOT]
        assert bool(wide) is (marked is not None)
        if marked is not None:
            assert sink.found == wide
            span = wide[0].span
            assert text[span.start : span.end] == marked
            assert wide[0].severity.value == "warning"


@pytest.mark.parametrize(
    ("word", "start", "marked", "said"),
    [
        (TWO, "0 deg, 2.5 m", "2.5 m", "value 2 of the start is outside the range of its joint"),
        (TWO, "-31 deg, 2.5 m", "-31 deg", "value 1 of the start is outside"),
        (MERGED, "91 deg, 0 deg", "start at (91 deg, 0 deg);", "no robot of `G` has these values"),
        ("B eps (J | F) eps K eps L eps E", "99 deg, 3 m", "3 m", "in each robot of `G`"),
        # Either value fits one of the robots.
        ("B eps (J eps K | K eps J) eps L eps E", "99 deg, 1 m", "99 deg", "range of its joint"),
        ("B eps R eps L eps E", "0 deg", "start at (0 deg);", "no robot of `G` has these values"),
    ],
)
def test_values_outside_every_range_are_named(
    word: str, start: str, marked: str, said: str
) -> None:
    ((severity, text, _, message),) = found(word, start, "0.1 deg, 0.1 mm")
    assert (severity, text) == ("warning", marked)
    assert said in message
