import subprocess
import sys
import time
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import nnls

from compiler.checks.workspace_checks import workspace_diagnostics
from compiler.workspaces.hull import hull_rows
from compiler.workspaces.inner_offset import inner_offset
from compiler.workspaces.polytope import Polytope
from grammar_lang.diagnostics.diagnostic import Code, Severity, Sink
from grammar_lang.ir import (
    Always,
    And,
    Atom,
    Eventually,
    Implies,
    Inequalities,
    Last,
    Next,
    Not,
    Num,
    Or,
    Region,
    Satisfy,
    StartAt,
    Until,
    Window,
    Workspace,
)
from grammar_lang.source import Span
from tests.oracles.planes import bench, box, hull, row
from tests.oracles.tasks import REACH, START, avoid, program, task

ROOT = Path(__file__).parents[2]
BOUNDS = box("bounds", "bounds", (0, 10), (0, 10), span=Span(1, 2))
S = box("S", "region", (1, 2), (1, 2), span=Span(10, 11))
T = box("T", "target", (8, 9), (8, 9), span=Span(12, 13))
E, W = Severity.ERROR, Severity.WARNING


def found(*regions, tasks, bounds=BOUNDS, dimension=2):
    sink = Sink()
    workspace = Workspace("W", dimension, bounds, regions)
    workspace_diagnostics(program([workspace], tasks), sink)
    for diagnostic in sink.found:
        assert "\n" not in diagnostic.message
        assert not diagnostic.message.endswith(".")
        assert diagnostic.hint
    return [(d.code, d.severity, d.span) for d in sink.found]


def obstacle(*sides, name="O"):
    return box(name, "obstacle", *sides, span=Span(20, 21))


def test_the_running_example_is_clean():
    sink = Sink()
    workspace_diagnostics(program([bench()], [task(avoid("O"), workspace="Bench")]), sink)
    assert not sink.found


@pytest.mark.parametrize(
    ("rows", "code"),
    [
        ((row(1, 0, 1, span=Span(31, 32)), row(-1, 0, -2, span=Span(33, 34))), Code.EMPTY_POLYTOPE),
        (
            (row(1, 0, 1, span=Span(31, 32)), row(-1, 0, -1, span=Span(33, 34)), row(0, 1, 1)),
            Code.FLAT_POLYTOPE,
        ),
    ],
)
def test_no_point_or_no_interior(rows, code):
    bad = Region("A", "region", Inequalities(rows), Span(30, 31))
    assert found(S, T, bad, tasks=[task()]) == [(code, E, Span(30, 31))]
    sink = Sink()
    workspace_diagnostics(program([Workspace("W", 2, BOUNDS, (S, T, bad))], [task()]), sink)
    assert [span for span, _ in sink.found[0].notes] == [Span(31, 32), Span(33, 34)]
    closed = Region("bounds", "bounds", bad.shape, Span(5, 6))
    assert found(S, T, tasks=[task()], bounds=closed) == [(code, E, Span(5, 6))]


def test_flat_hulls():
    line = hull("A", "region", (0, 0), (1, 1), span=Span(30, 31))
    assert found(S, T, line, tasks=[task()]) == [(Code.FLAT_POLYTOPE, E, Span(30, 31))]


def test_unbounded():
    half = Inequalities((row(1, 1, 3),))
    bounds = Region("bounds", "bounds", half, Span(5, 6))
    assert found(S, T, tasks=[task()], bounds=bounds) == [(Code.UNBOUNDED_POLYTOPE, E, Span(5, 6))]
    region = Region("S", "region", half, Span(30, 31))
    assert found(region, T, tasks=[task()]) == [(Code.UNBOUNDED_POLYTOPE, W, Span(30, 31))]


def test_outside_the_bounds():
    far = box("S", "region", (11, 12), (0, 1), span=Span(30, 31))
    touching = box("T", "target", (10, 11), (0, 1), span=Span(32, 33))
    assert found(far, touching, tasks=[task()]) == [
        (Code.REGION_OUTSIDE_BOUNDS, E, START),
        (Code.REGION_OUTSIDE_BOUNDS, E, REACH),
    ]
    # of no task: only a warning, at the region
    assert found(S, T, box("A", "region", (11, 12), (0, 1), span=Span(30, 31)), tasks=[task()]) == [
        (Code.REGION_OUTSIDE_BOUNDS, W, Span(30, 31))
    ]
    partly = box("S", "region", (9, 11), (0, 1))
    assert found(partly, T, tasks=[task()]) == [(Code.REGION_PARTLY_OUTSIDE, W, START)]
    # an obstacle may stick out
    assert found(S, T, obstacle((9, 11), (0, 1)), tasks=[task(avoid("O"))]) == []


def test_start_and_target_in_an_obstacle():
    exactly = obstacle((1, 2), (1, 2))
    assert found(S, T, exactly, tasks=[task(avoid("O"))]) == [(Code.START_IN_OBSTACLE, E, START)]
    larger = obstacle((7, 10), (7, 10))
    assert found(S, T, larger, tasks=[task(avoid("O"))]) == [(Code.TARGET_IN_OBSTACLE, E, REACH)]
    # not avoided, or by the body only
    assert found(S, T, exactly, tasks=[task()]) == [
        (Code.UNUSED_OBSTACLE, W, Span(20, 21)),
        (Code.OVERLAPPING_REGIONS, Severity.NOTE, Span(20, 21)),
    ]
    assert found(S, T, exactly, tasks=[task(avoid("O", subject="body"))]) == [
        (Code.START_IN_OBSTACLE, W, START)
    ]
    # avoiding the target itself
    assert found(S, T, tasks=[task(avoid("T"))]) == [(Code.TARGET_IN_OBSTACLE, E, REACH)]


def test_a_cover_of_several_obstacles():
    left, right = obstacle((1, "1.5"), (0, 3), name="A"), obstacle(("1.5", 2), (0, 3), name="B")
    assert found(S, T, left, right, tasks=[task(avoid("A", "B"))]) == [
        (Code.START_IN_OBSTACLE, E, START)
    ]
    assert found(S, T, left, right, tasks=[task(avoid("A"), avoid("B", subject="body"))]) == [
        (Code.START_IN_OBSTACLE, W, START)
    ]
    gap = obstacle(("1.6", 2), (0, 3), name="B")
    assert found(S, T, left, gap, tasks=[task(avoid("A", "B"))]) == [
        (Code.REGION_PARTLY_BLOCKED, W, START)
    ]


def test_touching_an_obstacle_is_no_overlap():
    assert found(S, T, obstacle((2, 3), (1, 2)), tasks=[task(avoid("O"))]) == []


def test_a_margin_is_avoided_too():
    """The corner (1, 1) of the start is 2 m from (1, 3), and sqrt(8) m from (3, 3)."""
    beside = obstacle((0, 4), (3, 4))
    for metres, expected in [("2.001", [(Code.START_IN_OBSTACLE, E, START)]), ("1.999", [])]:
        margin = Fraction(metres)
        assert found(S, T, beside, tasks=[task(avoid("O", margin=margin))]) == expected
    warned = [(Code.START_IN_OBSTACLE, W, START)]
    by_body = avoid("O", subject="body", margin=Fraction(3))
    assert found(S, T, beside, tasks=[task(by_body)]) == warned
    corner = obstacle((3, 4), (3, 4))
    for metres, expected in [(3, [(Code.START_IN_OBSTACLE, E, START)]), ("2.82", [])]:
        margin = Fraction(metres)
        assert found(S, T, corner, tasks=[task(avoid("O", margin=margin))]) == expected


def test_margins_of_several_regions_cover_together():
    left, right = obstacle((0, "0.8"), (0, 3), name="A"), obstacle(("2.2", 3), (0, 3), name="B")
    both = avoid("A", "B", margin=Fraction("0.7"))
    assert found(S, T, left, right, tasks=[task(both)]) == [(Code.START_IN_OBSTACLE, E, START)]
    less = avoid("A", "B", margin=Fraction("0.69"))
    assert found(S, T, left, right, tasks=[task(less)]) == []


@pytest.mark.parametrize("dimension", [2, 3])
def test_inner_offsets_are_within_the_distance_and_nearly_all_of_it(dimension):
    """Distances by another library, in floats."""
    corners = [(0, 0, 0), (3, 1, 0), (1, 2, 0), (1, 1, 2)][: dimension + 1]
    shape = Polytope(hull_rows([tuple(map(Fraction, corner[:dimension])) for corner in corners]))
    distance = Fraction(7, 5)
    offset = inner_offset(shape, distance)
    assert offset.contains(shape)
    assert max(_distance(shape, vertex) for vertex in offset.vertices) <= 1.4 * (1 + 1e-6)
    generator = np.random.default_rng(3)
    normals = generator.normal(size=(100, dimension))
    for direction in normals / np.linalg.norm(normals, axis=1, keepdims=True):
        reach = [
            max(row @ direction for row in np.array(s.vertices, float)) for s in (shape, offset)
        ]
        assert 0.904 * 1.4 <= reach[1] - reach[0] <= 1.4 * (1 + 1e-9)


def _distance(shape, point):
    """From a point to a polytope, by a non-negative least-squares problem of its vertices."""
    vertices = np.array(shape.vertices, float)
    weight = 1e4  # of the sum of the coefficients, which has to be one
    matrix = np.vstack([vertices.T, np.full(len(vertices), weight)])
    coefficients, _ = nnls(matrix, np.array([*map(float, point), weight]))
    return np.linalg.norm(coefficients @ vertices - np.array(point, float))


def test_the_part_inside_the_bounds_decides():
    start = box("S", "region", (9, 11), (0, 1))
    assert found(start, T, obstacle((9, 10), (0, 1)), tasks=[task(avoid("O"))]) == [
        (Code.REGION_PARTLY_OUTSIDE, W, START),
        (Code.START_IN_OBSTACLE, E, START),
    ]


def test_unused_obstacles_count_the_tasks_of_their_workspace_only():
    o = obstacle((4, 5), (4, 5))
    other = task(avoid("O"), workspace="V", name="Other")
    assert found(S, T, o, tasks=[other]) == [(Code.UNUSED_OBSTACLE, W, Span(20, 21))]
    assert found(S, T, o, tasks=[task(), task(avoid("O"), name="Second")]) == []


def test_a_start_pose_has_no_region():
    pose = task(start=StartAt((Num(Fraction(0)),)))
    assert found(T, tasks=[pose]) == []


def test_space():
    bounds = box("bounds", "bounds", (0, 10), (0, 10), (0, 10))
    s = box("S", "region", (1, 2), (1, 2), (1, 2))
    t = box("T", "target", (8, 9), (8, 9), (8, 9))
    o = obstacle((0, 3), (0, 3), (0, 3))
    assert found(s, t, o, tasks=[task(avoid("O"))], bounds=bounds, dimension=3) == [
        (Code.START_IN_OBSTACLE, E, START)
    ]


def findings(workspace, tasks, *, complete=True):
    sink = Sink()
    workspace_diagnostics(program([workspace], tasks), sink, complete=complete)
    return sink.found


def test_a_formula_makes_use_of_an_obstacle():
    forever = Window(Fraction(0), None)
    names = [f"O{i}" for i in range(9)]
    a, b, c, d, e, f, g, h, i = (Atom(name, 1) for name in names)
    formula = Always(
        Implies(Not(a), Or((And((b, Until(c, d))), Eventually(e, forever), Next(f)))), forever
    )
    last = Last(Fraction(1), Or((g, h)))
    obstacles = tuple(
        obstacle((4, 5), (Fraction(k, 2), Fraction(k + 1, 2)), name=name)
        for k, name in enumerate(names)
    )
    formulas = replace(task(), reach=None, satisfy=(Satisfy(formula), Satisfy(last)))
    (unused,) = findings(Workspace("W", 2, BOUNDS, (S, T, *obstacles)), [formulas])
    assert unused.message == "no task avoids obstacle `O8`"
    assert i.region == "O8"


def test_a_task_without_reach_has_a_start():
    far = box("S", "region", (11, 12), (0, 1))
    formulas = replace(task(), reach=None)
    assert found(far, T, tasks=[formulas]) == [(Code.REGION_OUTSIDE_BOUNDS, E, START)]


def test_of_an_incomplete_program_unused_obstacles_and_notes_are_not_told():
    workspace = Workspace("W", 2, BOUNDS, (S, T, obstacle((0, 3), (0, 3))))
    assert findings(workspace, [], complete=False) == []
    told = [d.code for d in findings(workspace, [task(avoid("O"))], complete=False)]
    assert told == [Code.START_IN_OBSTACLE]


def test_overlaps_count_within_the_bounds_only():
    one = box("A", "region", (8, 14), (0, 5))
    other = box("B", "region", (7, 9), (4, 6))
    outside = box("C", "region", (10, 13), (0, 5))
    messages = [d.message for d in findings(Workspace("W", 2, BOUNDS, (one, other, outside)), [])]
    assert messages == [
        "region `C` lies outside the bounds and has no effect",
        "region `B` overlaps region `A`",
    ]


def test_many_avoided_regions_are_listed_shortly():
    strips = [
        obstacle((Fraction(10 + k, 10), Fraction(11 + k, 10)), (1, 2), name=f"O{k}")
        for k in range(10)
    ]
    names = tuple(strip.name for strip in strips)
    workspace = Workspace("W", 2, BOUNDS, (S, T, *strips))
    (covered,) = findings(workspace, [task(avoid(*names))])
    assert covered.code is Code.START_IN_OBSTACLE
    assert "inside `O0`, `O1`, `O2`, `O3`, `O4` and 5 more, which" in covered.message
    (partly,) = findings(workspace, [task(avoid(*names[1:]))], complete=False)
    assert partly.code is Code.REGION_PARTLY_BLOCKED


def test_the_union_counts_and_not_the_sum_of_the_areas():
    # twice the same half is as large as the whole, and leaves the other half
    twice = [obstacle((1, "1.5"), (0, 3), name=name) for name in "AB"]
    assert found(S, T, *twice, tasks=[task(avoid("A", "B"))]) == [
        (Code.REGION_PARTLY_BLOCKED, W, START)
    ]


def test_hundreds_of_regions_are_no_trouble():
    side = 20
    cells = [
        box(f"R{i}_{j}", "region", (i, i + 1), (j, j + 1)) for i in range(side) for j in range(side)
    ]
    bounds = box("bounds", "bounds", (0, side), (0, side))
    started = time.process_time()
    assert findings(Workspace("W", 2, bounds, tuple(cells)), []) == []
    assert time.process_time() - started < 1


def test_numpy_is_not_loaded():
    program = "import sys, compiler.checks.workspace_checks, compiler.workspaces.polytope\n"
    program += "import compiler.checks.grammar_checks\n"
    program += "sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False).returncode == 0
