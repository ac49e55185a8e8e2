"""Maps as regions of a program: names, avoid, formulas, bounds, limits, and the cache."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from compiler.tasks import obstacle_pieces
from compiler.tasks.obstacle_pieces import (
    expanded,
    expanded_workspace,
    pieces_of,
    pieces_within,
    polytopes_within,
    task_by_task,
)
from compiler.workspaces import map_server
from compiler.workspaces.abstraction import abstract
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.source import Span
from tests.oracles.planes import box
from tests.oracles.tasks import avoid, program, task

BOUNDS = box("bounds", "bounds", (0, 10), (0, 10))
S = box("S", "region", (1, 2), (1, 2))
T = box("T", "target", (8, 9), (8, 9))
PLACE = Span(40, 50)
ALWAYS = ir.Window(Fraction(0), None)


def square(x: float, y: float, side: float = 1) -> list[list[list[float]]]:
    return [[[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]]]


def polygons(name: str, *shapes: list[list[list[float]]]) -> ir.ObstacleMap:
    text = json.dumps({"type": "MultiPolygon", "coordinates": list(shapes)})
    return ir.ObstacleMap(name, f"{name}.geojson", "geojson", text, PLACE)


def image(name: str, pixels: list[list[int]]) -> ir.ObstacleMap:
    """One pixel a metre, black where not zero."""
    file = BytesIO()
    Image.fromarray(np.where(np.array(pixels), 0, 255).astype(np.uint8)).save(file, "PPM")
    text = (
        f"image: {name}.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.6\nfree_thresh: 0.2\n"
    )
    found = ir.MapImage(f"{name}.pgm", file.getvalue())
    return ir.ObstacleMap(name, f"{name}.yaml", "map_server", text, PLACE, found)


L_SHAPE = [[[4.0, 4.0], [7.0, 4.0], [7.0, 5.0], [5.0, 5.0], [5.0, 7.0], [4.0, 7.0], [4.0, 4.0]]]
YARD = polygons("yard", L_SHAPE)


def workspace(*maps: ir.ObstacleMap, regions: tuple[ir.Region, ...] = (S, T)) -> ir.Workspace:
    return ir.Workspace("W", 2, BOUNDS, regions, maps=maps)


def names_of(place: ir.Workspace) -> list[str]:
    return [region.name for region in place.regions]


def test_pieces_become_obstacles() -> None:
    place = expanded_workspace(workspace(YARD, image("post", [[0, 1], [0, 0]])))
    assert names_of(place) == ["S", "T", "yard.1", "yard.2", "post.1"]
    assert place.maps == ()
    pieces = place.regions[2:]
    assert {(piece.kind, piece.span) for piece in pieces} == {("obstacle", PLACE)}
    assert [polytope_of(piece.shape, 2).volume for piece in pieces[:2]] in ([2, 3], [3, 2])
    assert set(polytope_of(pieces[2].shape, 2).vertices) == {(1, 1), (2, 1), (2, 2), (1, 2)}
    cells = abstract(place)
    assert sum(cell.polytope.volume for cell in cells.cells if cell.kind == "obstacle") == 6


def test_a_workspace_without_maps_is_left_alone() -> None:
    place = workspace()
    assert expanded_workspace(place) is place
    made = program([place], [task()])
    found = expanded(made, made.tasks["Do"])
    assert found[0] is made
    assert found[1] is made.tasks["Do"]
    assert list(task_by_task(made)) == [made]


def test_an_abstraction_leaves_no_map_out() -> None:
    with pytest.raises(ValueError, match="maps"):
        abstract(workspace(YARD))


def test_what_is_avoided() -> None:
    made = program([workspace(YARD), replace(workspace(YARD), name="V")], [
        task(avoid("T", "yard"), ir.Avoid(("yard",), "body", Fraction(1, 10), PLACE)),
        task(avoid("yard"), workspace="V", name="Other"),
    ])  # fmt: skip
    found, done = expanded(made, made.tasks["Do"])
    assert done.avoid == (
        avoid("T", "yard.1", "yard.2"),
        ir.Avoid(("yard.1", "yard.2"), "body", Fraction(1, 10), PLACE),
    )
    assert found.tasks["Do"] is done
    assert found.workspaces["W"] == expanded_workspace(made.workspaces["W"])
    # Others are as they were.
    assert found.tasks["Other"] is made.tasks["Other"]
    assert found.workspaces["V"] is made.workspaces["V"]
    assert expanded(found, done) == (found, done)


def with_formula(*formulas: ir.Formula) -> ir.Task:
    clauses = tuple(ir.Satisfy(formula, PLACE) for formula in formulas)
    return replace(task(), satisfy=clauses)


def test_formulas() -> None:
    yard, other = ir.Atom("yard", 2, PLACE), ir.Atom("S", 1)
    one, two = ir.Atom("yard.1", 2), ir.Atom("yard.2", 2)
    either = ir.Or((one, two))
    window = ir.Window(Fraction(1), Fraction(3))
    cases: list[tuple[ir.Formula, ir.Formula]] = [
        (yard, either),
        (other, other),
        (ir.Always(ir.Not(yard), ALWAYS), ir.Always(ir.Not(either), ALWAYS)),
        (ir.Eventually(yard, window), ir.Eventually(either, window)),
        (ir.And((other, yard)), ir.And((other, either))),
        (ir.Or((other, yard)), ir.Or((other, either))),
        (ir.Implies(yard, other), ir.Implies(either, other)),
        (ir.Until(other, ir.Next(yard)), ir.Until(other, ir.Next(either))),
        (ir.Last(Fraction(2), yard), ir.Last(Fraction(2), either)),
    ]
    for written, meant in cases:
        made = program([workspace(YARD)], [with_formula(other, written)])
        _, done = expanded(made, made.tasks["Do"])
        assert [clause.formula for clause in done.satisfy] == [other, meant]
        assert [clause.span for clause in done.satisfy] == [PLACE, PLACE]


def test_a_map_of_one_piece_is_an_atom() -> None:
    made = program([workspace(polygons("box", square(4, 4)))], [with_formula(ir.Atom("box", 1))])
    [clause] = expanded(made, made.tasks["Do"])[1].satisfy
    assert clause.formula == ir.Atom("box.1", 1)


@pytest.mark.parametrize("empty", [polygons("none"), polygons("none", square(10.5, 3))])
def test_a_map_without_obstacles_within_the_bounds(empty: ir.ObstacleMap) -> None:
    """It leaves nothing to avoid, and is false in formulas."""
    made = program([workspace(empty, YARD)], [task(avoid("none"), avoid("none", "T"))])
    found, done = expanded(made, made.tasks["Do"])
    assert done.avoid == (avoid("T"),)
    assert names_of(found.workspaces["W"]) == ["S", "T", "yard.1", "yard.2"]
    made = program([workspace(empty, YARD)], [with_formula(ir.Not(ir.Atom("none", 1)))])
    found, done = expanded(made, made.tasks["Do"])
    assert done.satisfy[0].formula == ir.Not(ir.Atom("none.1", 1))
    nowhere = polytope_of(found.workspaces["W"].region("none.1").shape, 2)
    assert nowhere.has_interior
    assert not nowhere.meets(polytope_of(BOUNDS.shape, 2))


def test_pieces_outside_the_bounds_are_left_out() -> None:
    far = polygons(
        "far", square(-5, 3), square(9.5, 3), square(3, -1.5), square(10.5, 10), square(2, 2)
    )
    found = pieces_within(far, BOUNDS)
    assert sorted(min(piece) for piece in found) == [(2, 2), (Fraction(19, 2), 3)]
    assert len(pieces_of(far).polygons) == 5
    # A corner of the bounds that is cut off: the box of the piece meets that of the bounds.
    cut = ir.Region("bounds", "bounds", ir.Hull(tuple(
        (Fraction(x), Fraction(y)) for x, y in ((0, 0), (10, 0), (10, 6), (6, 10), (0, 10))
    )))  # fmt: skip
    some, fewer = polygons("c", square(8.5, 8.5, 2), square(7.5, 7.5)), square(7.5, 7.5)
    assert pieces_within(some, cut) == pieces_within(polygons("d", fewer), cut)


def test_pieces_that_touch_the_bounds_are_places_to_be_in() -> None:
    """Both are closed sets: an effector at the edge of the bounds is in such a piece, too."""
    edge, corner = polygons("edge", square(3, -1)), polygons("corner", square(10, 10))
    for found, place in ((edge, (3, 0)), (corner, (10, 10))):
        (piece,) = pieces_within(found, BOUNDS)
        assert polytope_of(ir.Hull(piece), 2).contains_point([Fraction(x) for x in place])
        # It hides nothing of the workspace, so the checks of starts and targets leave it out.
        assert polytopes_within(found, BOUNDS) == ()


def test_a_map_of_too_many_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    posts = [square(x, 2 * y, 0.5) for x in range(10) for y in range(4)]
    monkeypatch.setattr(obstacle_pieces, "PIECE_LIMIT", 39)
    with pytest.raises(MapFault) as caught:
        expanded_workspace(workspace(polygons("posts", *posts)))
    assert caught.value.code is Code.TOO_LARGE
    assert caught.value.message == "obstacle `posts` has 40 convex pieces within the bounds"
    monkeypatch.setattr(obstacle_pieces, "PIECE_LIMIT", 40)
    assert len(expanded_workspace(workspace(polygons("posts", *posts))).regions) == 42


def test_an_image_is_decoded_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    decode = map_server.grey_image
    monkeypatch.setattr(map_server, "grey_image", lambda data: calls.append(1) or decode(data))
    place = workspace(image("once", [[1, 0, 1]]))
    made = program([place], [task(avoid("once"))])
    expanded_workspace(place)
    expanded(made, made.tasks["Do"])
    # Where the map is named makes no difference.
    [found] = place.maps
    moved = replace(found, span=Span(1, 2), file=3)
    assert names_of(expanded_workspace(replace(place, maps=(moved,))))[2:] == ["once.1", "once.2"]
    assert expanded_workspace(replace(place, maps=(moved,))).regions[-1].span == Span(1, 2)
    assert len(calls) == 1


def test_tasks_with_maps_that_cannot_be_used_are_left_out() -> None:
    bad = replace(polygons("bad"), text='{"type": "Point"}')
    made = program(
        [workspace(bad), replace(workspace(YARD), name="V")],
        [task(), task(workspace="V", name="Good"), task(workspace="V", name="Better")],
    )
    assert [list(p.tasks) for p in task_by_task(made)] == [["Good"], ["Better"]]
