"""GeoJSON as obstacles: all that holds polygons, exact numbers, mistakes with their places."""

from __future__ import annotations

import json
import random
import tracemalloc
from fractions import Fraction

import pytest
import shapely
import shapely.geometry

from compiler.workspaces.geojson import CORNER_LIMIT, geojson_pieces, place_of
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.pieces import area
from grammar_lang.diagnostics.diagnostic import Code

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]
POLYGON = {"type": "Polygon", "coordinates": [SQUARE]}
FAR = {"type": "Polygon", "coordinates": [[[5, 5], [7, 5], [5, 6], [5, 5]]]}


def shapely_of(text: str) -> shapely.Geometry:
    pieces = geojson_pieces(text).polygons
    return shapely.unary_union(
        [shapely.Polygon([(float(x), float(y)) for x, y in piece]) for piece in pieces]
    )


@pytest.mark.parametrize(
    "value",
    [
        POLYGON,
        {"type": "MultiPolygon", "coordinates": [[SQUARE], FAR["coordinates"]]},
        {"type": "Feature", "geometry": POLYGON, "properties": {"type": "Point"}},
        {"type": "GeometryCollection", "geometries": [FAR, POLYGON, POLYGON]},
        {
            "type": "FeatureCollection",
            "features": [
                {"type": "Feature", "geometry": POLYGON, "properties": None},
                {"type": "Feature", "geometry": None, "properties": None},
                {
                    "type": "Feature",
                    "geometry": {"type": "GeometryCollection", "geometries": [FAR]},
                },
            ],
        },
    ],
)
def test_every_polygon_is_read(value: dict[str, object]) -> None:
    parts = [POLYGON] if "Multi" not in str(value) and "5" not in str(value) else [POLYGON, FAR]
    expected = shapely.unary_union([shapely.geometry.shape(part) for part in parts])
    assert shapely_of(json.dumps(value)).symmetric_difference(expected).area == 0


def test_random_features_are_what_shapely_reads() -> None:
    rng = random.Random(2)
    for _ in range(30):
        shapes: list[shapely.Geometry] = []
        while len(shapes) < 4:
            points = [(rng.randint(0, 40) / 4, rng.randint(0, 40) / 4) for _ in range(6)]
            shape = shapely.concave_hull(shapely.MultiPoint(points), 0.3)
            if shape.is_valid and shape.area > 1:
                shapes.append(shape)
        holed = shapes[0].buffer(3, quad_segs=2).difference(shapes[0])
        whole = shapely.GeometryCollection([holed, *shapes[1:]])
        found = shapely_of(json.dumps(shapely.geometry.mapping(whole)))
        assert found.symmetric_difference(shapely.unary_union(whole)).area < 1e-9


def test_no_polygon_and_an_empty_one() -> None:
    for text in (
        '{"type": "FeatureCollection", "features": []}',
        '{"type": "Feature", "geometry": null}',
        '{"type": "MultiPolygon", "coordinates": []}',
        '{"type": "Polygon", "coordinates": []}',
    ):
        assert geojson_pieces(text).polygons == ()
    assert geojson_pieces(json.dumps(POLYGON)).origin == "1 polygon"
    two = {"type": "GeometryCollection", "geometries": [POLYGON, FAR]}
    assert geojson_pieces(json.dumps(two)).origin == "2 polygons"


def test_numbers_are_those_of_their_decimals() -> None:
    text = """{"type": "Polygon", "coordinates": [[
        [0.1, -2e-1, 7], [0.30000000000000000000000001, -0.2], [0.1, 1E+1], [0.1, -0.20]]]}"""
    [piece] = geojson_pieces(text).polygons
    tenth = Fraction(1, 10)
    assert set(piece) == {
        (tenth, -2 * tenth), (3 * tenth + Fraction(1, 10**26), -2 * tenth), (tenth, Fraction(10)),
    }  # fmt: skip
    assert area(piece) == Fraction("10.2") * (Fraction(1, 5) + Fraction(1, 10**26)) / 2


RINGS = '{"type": "Polygon", "coordinates": [%s]}'


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ('{"type": "Point", "coordinates": [1, 2]}', "a Point has no interior", 0),
        ('{"type": "LineString", "coordinates": [[1, 2], [2, 3]]}', "LineString has no int", 0),
        (
            '{"type": "Feature", "geometry": {"type": "MultiPoint", "coordinates": []}}',
            "a MultiPoint has no interior",
            32,
        ),
        ('{"type": "Feature", "geometry": {"type": "Circle"}}', "is not a GeoJSON type", 32),
        ('{"type": "Feature", "geometry": [1]}', "not a GeoJSON object", 32),
        ('{"type": "Feature"}', "not a GeoJSON object", 0),
        ('{"type": "FeatureCollection"}', "has no list `features`", 0),
        ('{"type": "FeatureCollection", "features": [3]}', "not a GeoJSON object", 43),
        ('{"type": "GeometryCollection", "geometries": {}}', "no list `geometries`", 0),
        ('{"type": "Polygon"}', "has no list `coordinates`", 0),
        ('{"type": "MultiPolygon", "coordinates": [7]}', "not a list of rings", 41),
        (RINGS % "7", "not a list of positions", 36),
        (RINGS % "[[0, 0], [1]]", "not a list of two numbers", 45),
        (RINGS % '[[0, 0], [1, "0"]]', "not a usable number", 49),
        (RINGS % "[[0, 0], [1, null]]", "not a usable number", 49),
        (RINGS % "[[0, 0], [1e999, 0]]", "not a usable number", 46),
        (RINGS % "[[0, 0], [NaN, 0]]", "not a usable number", 46),
        (RINGS % "[[0, 0], [1, 0], [1, 1], [0, 1]]", "not closed", 36),
        (RINGS % "[[0, 0], [1, 0], [0, 0]]", "at least four", 36),
        (RINGS % "[[0, 0], [1, 0], [2, 0], [0, 0]]", "has no area", 36),
        (RINGS % "[[0, 0], [2, 2], [2, 0], [0, 2], [0, 0]]", r"meets itself at \(1, 1\)", 36),
        (RINGS % f"{SQUARE}, [[5, 5], [6, 5], [6, 6], [5, 5]]", "a hole is not within", 36),
        (
            RINGS % f"{SQUARE}, [[0.5, 0.5], [6, 0.5], [6, 0.7], [0.5, 0.5]]",
            "crosses another one",
            36 + len(str(SQUARE)) + 2,
        ),
        ('{"type": "Polygon", "type": "Polygon", "coordinates": []}', "two members `type`", 0),
    ],
)
def test_mistakes(text: str, message: str, place: int) -> None:
    with pytest.raises(MapFault, match=message) as caught:
        geojson_pieces(text)
    assert caught.value.place is not None
    assert caught.value.place[0] == place
    assert caught.value.code is Code.UNREADABLE_REFERENCE
    assert caught.value.hint
    assert "\n" not in caught.value.message


def test_many_positions() -> None:
    ring = [[i, 0] for i in range(CORNER_LIMIT)] + [[0, 1], [0, 0]]
    with pytest.raises(MapFault, match="10,002 positions, more than 10,000") as caught:
        geojson_pieces(RINGS % ring)
    assert caught.value.code is Code.TOO_LARGE


def test_many_polygons(monkeypatch: pytest.MonkeyPatch) -> None:
    text = json.dumps({"type": "MultiPolygon", "coordinates": [[SQUARE]] * 3})
    monkeypatch.setattr("compiler.workspaces.geojson.TOTAL_LIMIT", 15)
    assert len(geojson_pieces(text).polygons) == 3
    monkeypatch.setattr("compiler.workspaces.geojson.TOTAL_LIMIT", 14)
    with pytest.raises(MapFault, match="more than 14 positions") as caught:
        geojson_pieces(text)
    assert caught.value.code is Code.TOO_LARGE


def zigzag(count: int, digits: str = "") -> str:
    """A ring of spikes, each beside all others though none touches another."""
    spikes = (f"[0, 0.{digits}{2 * i:05}], [1, 1.{digits}{2 * i + 1:05}]" for i in range(count))
    return f"[{', '.join(spikes)}, [-1, 1], [0, 0.{digits}00000]]"


@pytest.mark.slow
def test_edges_side_by_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """To compare each with all others, exactly and more than once, would take minutes."""
    for ring in (zigzag(4990), zigzag(900, "1" * 290), zigzag(400, "1" * 100)):
        with pytest.raises(MapFault, match="too many edges side by side") as caught:
            geojson_pieces(RINGS % ring)
        assert caught.value.code is Code.TOO_LARGE
    few = RINGS % zigzag(100)
    assert len(geojson_pieces(few).polygons) > 50
    teeth = [place for i in range(100) for place in ([0, 2 * i], [900 + i, 2 * i + 1])]
    comb = RINGS % [[-1, 0], *teeth, [-1, 200], [-1, 0]]
    assert len(geojson_pieces(comb).polygons) > 50
    monkeypatch.setattr("compiler.workspaces.polygon_pieces.SIDE_BY_SIDE", 10**4)
    with pytest.raises(MapFault, match="too many edges side by side"):
        geojson_pieces(comb)


def test_edges_that_floats_cannot_tell_apart() -> None:
    """The ends of the spike are 10^-40 m beside the other edge, or on it."""
    for beside, piece in (("", "[0.5, 0.4]"), (f"0.5{'0' * 38}1", "")):
        end = f"[0.5, {beside or '0.5'}]"
        ring = f"[[0, 0], [1, 1], [1, 2], {end}, [0, 2], [0, 0]]"
        if piece:
            with pytest.raises(MapFault, match="meets itself"):
                geojson_pieces(RINGS % ring)
        else:
            assert geojson_pieces(RINGS % ring).polygons


def test_numbers_that_no_float_holds() -> None:
    for number in ("9" * 250 + "e300", "1e301", "9" * 5000, "1e" + "9" * 5000, "1e999999999"):
        with pytest.raises(MapFault, match="not a usable number"):
            geojson_pieces(RINGS % f"[[0, 0], [{number}, 0], [0, 1], [0, 0]]")
    assert geojson_pieces(RINGS % "[[0, 0], [1e300, 0], [0, 1], [0, 0]]").polygons


def test_a_place_is_found_without_a_list_of_all_that_is_before() -> None:
    long = f'{{"a": "{"x" * 10**5}", "b": [{"0," * 10**5}1], "type": "Pollygon"}}'
    assert place_of(long, ()) == (0, 1)
    tracemalloc.start()
    assert place_of(long, ("b", 10**5)) == (long.index("1]"), long.index("1]") + 1)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 10**6


def test_places_in_json() -> None:
    text = (
        r'{"a\"}": [1, {"b": [[], 2], "c": "]"}, "b"], "b": {"b": {"b": true}}, "a": null, "a": 7}'
    )
    for path, expected in [
        ((), "{"),
        (('a"}',), "["),
        (('a"}', 0), "1"),
        (('a"}', 1), "{"),
        (('a"}', 1, "b", 1), "2"),
        (('a"}', 1, "c"), '"]"'),
        (('a"}', 2), '"b"'),
        (("b", "b", "b"), "true"),
        (("a",), "7"),
        (('a"}', 3), "{"),
        (("none",), "{"),
    ]:
        start, end = place_of(text, path)
        assert text[start:end] == expected
    assert text[place_of(text, ('a"}', 1, "b"))[0] :].startswith("[[], 2]")


def test_very_large_beside_very_small_coordinates() -> None:
    """Their common denominator makes integers that no double holds."""
    ring = "[[0,0],[1e200,0],[1e200,1e-200],[1,2],[0,0]]"
    (piece, *more) = geojson_pieces(f'{{"type": "Polygon", "coordinates": [{ring}]}}').polygons
    corners = {corner for part in (piece, *more) for corner in part}
    assert (Fraction(10) ** 200, Fraction(1, 10**200)) in corners
