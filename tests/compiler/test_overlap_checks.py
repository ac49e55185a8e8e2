from __future__ import annotations

from fractions import Fraction

from compiler.checks.workspace_checks import CANDIDATE_LIMIT, REPORTED, overlap_diagnostics
from compiler.workspaces.polytope import polytope_of
from grammar_lang.diagnostics.diagnostic import Code, Severity, Sink
from grammar_lang.ir import Workspace
from grammar_lang.source import Span
from tests.oracles.planes import box, hull

BOUNDS = box("bounds", "bounds", (0, 100), (0, 100))


def notes(*regions, told=()):
    sink = Sink()
    workspace = Workspace("W", 2, BOUNDS, regions, Span(1, 2))
    inside = {region.name: polytope_of(region.shape, 2) for region in regions}
    overlap_diagnostics(workspace, inside, told, sink)
    assert all(d.code is Code.OVERLAPPING_REGIONS for d in sink.found)
    assert all(d.severity is Severity.NOTE for d in sink.found)
    assert all(d.hint for d in sink.found)
    return sink.found


def messages(*regions, told=()):
    return [note.message for note in notes(*regions, told=told)]


A = box("A", "region", (0, 3), (0, 3), span=Span(10, 11))
B = box("B", "target", (2, 4), (2, 4), span=Span(20, 21))
WALL, POST = box("O", "obstacle", (1, 5), (1, 5)), box("P", "obstacle", (1, 5), (1, 6))


def test_a_pair_is_noted_at_the_later_region():
    (note,) = notes(A, B)
    assert note.message == "target `B` overlaps region `A`"
    assert note.span == Span(20, 21)
    assert note.notes == ((Span(10, 11), "`A` is declared here"),)
    (note,) = notes(B, A)
    assert (note.message, note.span) == ("region `A` overlaps target `B`", Span(10, 11))


def test_containment_is_said():
    small = box("C", "region", (1, 2), (1, 2))
    assert messages(A, small) == ["region `C` lies inside region `A`"]
    assert messages(small, A) == ["region `A` contains region `C`"]
    same = hull("D", "region", (0, 0), (3, 0), (3, 3), (0, 3))
    assert messages(A, same) == ["region `D` is the same set as region `A`"]


def test_what_is_not_noted():
    assert messages(WALL, POST) == []
    assert messages(A, box("C", "region", (3, 4), (0, 3))) == []
    assert messages(A, box("C", "region", (3, 4), (3, 4))) == []
    # the bounding boxes overlap, the triangles only touch
    lower = hull("L", "region", (0, 0), (1, 0), (0, 1))
    upper = hull("U", "region", (1, 1), (1, 0), (0, 1))
    assert messages(lower, upper) == []


def test_what_a_task_reports_already():
    assert messages(A, B, told={("B", "A")}) == messages(A, B, told={("A", "B")}) == []
    assert messages(A, WALL, POST, told={("A", "P")}) == ["obstacle `O` overlaps region `A`"]


def test_many_pairs_are_counted():
    piled = [box(f"R{i}", "region", (0, 1 + i), (0, 1 + i)) for i in range(10)]
    found = notes(*piled)
    assert len(found) == REPORTED + 1
    rest = 10 * 9 // 2 - REPORTED
    assert found[-1].message == f"{rest} more pairs of regions of workspace `W` overlap"
    assert found[-1].span == Span(1, 2)
    assert [d.message for d in found[:2]] == [
        "region `R1` contains region `R0`",
        "region `R2` contains region `R0`",
    ]
    chain = [box(f"R{i}", "region", (i, i + Fraction(3, 2)), (0, 1)) for i in range(REPORTED + 2)]
    assert messages(*chain)[-1] == "1 more pair of regions of workspace `W` overlaps"


def test_a_heap_of_regions_is_cut_short():
    size = 102
    assert size * (size - 1) // 2 > CANDIDATE_LIMIT
    heap = [box(f"R{i}", "region", (0, 1 + i), (0, 1 + i)) for i in range(size)]
    message = messages(*heap)[-1]
    assert message.startswith(f"at least {CANDIDATE_LIMIT - REPORTED} more pairs")
