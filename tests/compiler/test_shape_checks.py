from __future__ import annotations

import pytest

from compiler.checks.region_checks import sound_polytope
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from grammar_lang.ir import Inequalities, Region
from grammar_lang.source import Span
from tests.oracles.planes import box, hull, row

PLACE = Span(5, 6)


def finding(region: Region, dimension: int = 2) -> Diagnostic:
    sink = Sink()
    shape = sound_polytope(region, dimension, sink)
    (found,) = sink.found
    assert (shape is None) is (found.severity is Severity.ERROR)
    assert found.span == PLACE
    assert found.hint
    return found


def region(*rows, kind="region"):
    return Region("R", kind, Inequalities(rows), PLACE)


def test_a_sound_region_has_no_finding():
    sink = Sink()
    shape = sound_polytope(box("R", "region", (0, 1), (0, 2)), 2, sink)
    assert shape is not None
    assert (shape.volume, sink.found) == (2, [])


def test_a_contradiction_names_its_inequalities():
    found = finding(
        region(
            row(1, 0, 4, span=Span(10, 11)),
            row(2, 0, 2, span=Span(12, 13)),
            row(0, 1, 1, span=Span(14, 15)),
            row(-1, 0, -2, span=Span(16, 17)),
        )
    )
    assert found.code is Code.EMPTY_POLYTOPE
    assert found.message == "region `R` has no point: 2 of its 4 inequalities contradict each other"
    assert found.notes == (
        (Span(12, 13), "asks for `x <= 1`, in metres"),
        (Span(16, 17), "asks for `x >= 2`, in metres"),
    )


def test_a_contradiction_of_three():
    rows = (
        row(1, 1, 0, span=Span(10, 11)),
        row(-1, 0, -1, span=Span(12, 13)),
        row(0, -3, 0, span=Span(12, 13)),
    )
    found = finding(region(*rows, kind="bounds"))
    assert found.message == "the bounds have no point: its inequalities contradict each other"
    assert found.notes == (
        (Span(10, 11), "asks for `x + y <= 0`, in metres"),
        (Span(12, 13), "asks for `x >= 1` and `y >= 0`, in metres"),
    )


def test_an_inequality_that_never_holds():
    found = finding(region(row(0, 0, -1, span=Span(10, 11)), row(1, 0, 1)))
    assert found.message == "region `R` has no point: 1 of its 2 inequalities never holds"
    assert found.notes == ((Span(10, 11), "asks for `0 <= -1`, in metres"),)


def test_no_room_between_inequalities():
    found = finding(
        region(
            row(1, 0, "1.5", span=Span(10, 11)),
            row(-1, 0, "-1.5", span=Span(12, 13)),
            row(0, 1, 1, span=Span(14, 15)),
        )
    )
    assert found.code is Code.FLAT_POLYTOPE
    assert found.message.endswith("no interior: 2 of its 3 inequalities leave no room between them")
    assert [span for span, _ in found.notes] == [Span(10, 11), Span(12, 13)]
    assert found.notes[0][1] == "asks for `x <= 3/2`, in metres"


def test_inequalities_from_elsewhere_have_no_place_to_note():
    assert finding(region(row(1, 0, 1), row(-1, 0, -2))).notes == ()


@pytest.mark.parametrize(
    ("points", "dimension", "reason"),
    [
        ([(1, 1)], 2, "it is one point"),
        ([(1, 1), (1, 1), (1, 1)], 2, "its points are all the same"),
        ([(0, 0), (1, 2)], 2, "its points lie on one line"),
        ([(0, 0), (1, 2), (3, 6)], 2, "its points lie on one line"),
        ([(0, 0), (1, 2), (0, 0)], 2, "its points lie on one line, 1 of them is repeated"),
        ([(0, 0, 0), (1, 2, 3), (2, 4, 6)], 3, "its points lie on one line"),
        ([(0, 0, 0), (1, 0, 1), (0, 1, 1), (1, 1, 2)], 3, "its points lie in one plane"),
        (
            [(0, 0, 0), (1, 0, 1), (0, 1, 1), (0, 1, 1), (0, 0, 0)],
            3,
            "its points lie in one plane, 2 of them are repeated",
        ),
    ],
)
def test_flat_hulls(points, dimension, reason):
    found = finding(hull("R", "obstacle", *points, span=PLACE), dimension)
    assert found.code is Code.FLAT_POLYTOPE
    assert found.message == f"obstacle `R` has no interior: {reason}"


@pytest.mark.parametrize(
    ("rows", "sides"),
    [
        ((row(-1, 0, 0), row(0, 1, 1), row(0, -1, 0)), "+x"),
        ((row(1, 0, 0), row(0, 1, 1), row(0, -1, 0)), "-x"),
        ((row(0, 1, 1), row(0, -1, 0)), "-x, +x"),
        ((row(0, 1, 1),), "-x, +x, -y"),
        ((row(-1, 0, 0), row(0, -1, 0), row(-1, -1, -1)), "+x, +y"),
    ],
)
def test_unbounded_sets_say_where(rows, sides):
    found = finding(region(*rows))
    assert (found.code, found.severity) == (Code.UNBOUNDED_POLYTOPE, Severity.WARNING)
    assert found.hint == f"add inequalities that close the set towards {sides}"
    found = finding(region(*rows, kind="bounds"))
    assert (found.severity, found.message) == (Severity.ERROR, "the bounds are unbounded")


def test_unbounded_aslant():
    # a strip along (1, 10): closing y alone closes it, so one side is enough
    rows = (row(10, -1, 1), row(-10, 1, 1))
    hint = finding(region(*rows)).hint
    assert hint is not None
    assert "+y" in hint
    assert "-y" in hint
    closed = region(*rows, row(0, 1, 1), row(0, -1, 1))
    assert sound_polytope(closed, 2, Sink()) is not None
