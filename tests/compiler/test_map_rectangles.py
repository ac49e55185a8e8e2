"""Rectangles of pixels and their place in the workspace, against counting and shapely."""

from __future__ import annotations

import time
import tracemalloc
from fractions import Fraction
from io import BytesIO

import mpmath
import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from PIL import Image

from compiler.workspaces.hull import turn
from compiler.workspaces.map_header import MapFault, MapHeader
from compiler.workspaces.map_server import map_server_pieces, placed, rational_rotation, rectangles
from compiler.workspaces.pieces import Polygon, area
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.ir import MapImage

MOST = 10**6
YAML = """\
image: a.pgm
resolution: {size}
origin: [{x}, {y}, {yaw}]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def random_pixels(rng: np.random.Generator) -> NDArray[np.bool_]:
    shape = rng.integers(1, 13, 2)
    pixels = rng.random(shape) < rng.choice([0.1, 0.5, 0.9])
    for _ in range(rng.integers(0, 4)):
        row, column = rng.integers(0, shape)
        pixels[row : row + rng.integers(1, 6), column : column + rng.integers(1, 6)] = True
    found: NDArray[np.bool_] = pixels
    return found


def shapely_of(polygons: tuple[Polygon, ...]) -> shapely.Geometry:
    made = [shapely.Polygon([(float(x), float(y)) for x, y in p]) for p in polygons]
    return shapely.unary_union(made)


def test_every_pixel_is_in_one_rectangle() -> None:
    rng = np.random.default_rng(7)
    for _ in range(400):
        pixels = random_pixels(rng)
        count = np.zeros(pixels.shape, dtype=int)
        for r, c, s, d in rectangles(pixels, MOST):
            assert 0 <= r < s <= pixels.shape[0]
            assert 0 <= c < d <= pixels.shape[1]
            count[r:s, c:d] += 1
        assert np.array_equal(count, pixels)


@pytest.mark.parametrize(
    ("rows", "number"),
    [
        (["....", "...."], 0),
        (["####", "####"], 1),
        (["#..#", "#..#", "####"], 3),
        (["####", "#..#", "####"], 4),
        (["##..", "##..", "..##"], 2),
        (["#.#.#", "#.#.#"], 3),
        ([".##.", ".##.", "####"], 2),
        (["###", ".#.", "###"], 3),
    ],
)
def test_rectangles_are_few(rows: list[str], number: int) -> None:
    pixels = np.array([[c == "#" for c in row] for row in rows])
    assert len(rectangles(pixels, MOST)) == len(rectangles(pixels.T, MOST)) == number


def test_lines_looked_at_apart_make_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        pixels = random_pixels(rng)
        whole = rectangles(pixels, MOST)
        assert whole is not None
        for at_once in (1, 20, 50):
            monkeypatch.setattr("compiler.workspaces.map_server._AT_ONCE", at_once)
            assert np.array_equal(rectangles(pixels, len(whole)), whole)
            assert len(whole) == 0 or rectangles(pixels, len(whole) - 1) is None
        monkeypatch.undo()


def test_noise_is_given_up_soon() -> None:
    """A list of all its runs would have gigabytes."""
    board = np.indices((2048, 2048), dtype=np.uint8).sum(axis=0) % 2 == 1
    file = BytesIO()
    Image.fromarray(board).save(file, "PNG")
    text = YAML.format(size=1, x=0, y=0, yaw=0)
    tracemalloc.start()
    with pytest.raises(MapFault, match="more than 100,000 rectangles") as caught:
        map_server_pieces(text, "m.yaml", MapImage("a.pgm", file.getvalue()))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert caught.value.code is Code.TOO_LARGE
    assert peak < 200 * 2**20


def test_a_large_image_takes_about_a_second() -> None:
    rng = np.random.default_rng(3)
    pixels = np.zeros((1000, 1000), dtype=bool)
    for _ in range(400):
        row, column = rng.integers(0, 1000, 2)
        pixels[row : row + rng.integers(1, 80), column : column + rng.integers(1, 80)] = True
    started = time.perf_counter()
    found = rectangles(pixels, MOST)
    assert time.perf_counter() - started < 2
    assert sum((s - r) * (d - c) for r, c, s, d in found) == pixels.sum()
    assert len(found) < 2500


def pieces_of(pixels: NDArray[np.bool_], **pose: object) -> tuple[tuple[Polygon, ...], Fraction]:
    """Of an image whose set pixels are black, the first row at the top."""
    file = BytesIO()
    Image.fromarray(np.where(pixels, 0, 255).astype(np.uint8)).save(file, "PPM")
    text = YAML.format(**{"size": "1", "x": "0", "y": "0", "yaw": "0", **pose})
    found = map_server_pieces(text, "m.yaml", MapImage("a.pgm", file.getvalue()))
    return found.polygons, found.inflation


def test_the_lower_left_pixel_is_at_the_origin() -> None:
    pixels = np.array([[False, False, True], [True, False, False]])
    polygons, inflation = pieces_of(pixels, size="0.1", x="-1", y="2e0", yaw="0.0")
    tenth = Fraction(1, 10)
    assert inflation == 0
    assert sorted(map(sorted, polygons)) == [
        [(x * tenth - 1, y * tenth + 2) for x in (0, 1) for y in (0, 1)],
        [(x * tenth - 1, y * tenth + 2) for x in (2, 3) for y in (1, 2)],
    ]


def test_the_union_is_that_of_the_pixels() -> None:
    rng = np.random.default_rng(11)
    for _ in range(60):
        pixels = random_pixels(rng)
        polygons, inflation = pieces_of(pixels, size="0.25", x="-1.5", y="0.75")
        height = len(pixels)
        boxes = [
            shapely.box(c / 4 - 1.5, (height - 1 - r) / 4 + 0.75, (c + 1) / 4 - 1.5,
                        (height - r) / 4 + 0.75)
            for r, c in np.argwhere(pixels)
        ]  # fmt: skip
        assert shapely_of(polygons).symmetric_difference(shapely.unary_union(boxes)).area == 0
        assert inflation == 0
        assert sum(map(area, polygons)) == Fraction(int(pixels.sum()), 16)


def test_what_a_map_says_of_itself() -> None:
    file = BytesIO()
    pixels = np.array([[0, 205, 254, 254], [254, 254, 254, 0]], dtype=np.uint8)
    Image.fromarray(pixels).save(file, "PPM")
    text = YAML.format(size="0.05", x=1, y=2, yaw=0)
    found = map_server_pieces(text, "m.yaml", MapImage("a.pgm", file.getvalue()))
    assert found.origin == "3 occupied and unknown cells of 0.05 m"
    assert found.extent is not None
    assert sorted(found.extent) == [(1, 2), (1, Fraction(21, 10)), (Fraction(6, 5), 2),
                                    (Fraction(6, 5), Fraction(21, 10))]  # fmt: skip


# --- turned maps ---------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", ["0.1", "-3", "3.14159265358979", "1.5707963", "6", "1e-20", "0"])
@pytest.mark.parametrize("bits", [8, 48])
def test_rational_rotations(angle: str, bits: int) -> None:
    found = rational_rotation(Fraction(angle), bits)
    assert found.cosine**2 + found.sine**2 == 1
    with mpmath.workdps(60):
        exact = mpmath.expj(mpmath.mpf(angle))
        near = [mpmath.mpf(v.numerator) / v.denominator for v in (found.cosine, found.sine)]
        off = abs(exact - mpmath.mpc(*near))
        assert off <= mpmath.mpf(found.error.numerator) / found.error.denominator
    assert found.error <= Fraction(2, 2**bits)


@pytest.mark.parametrize("yaw", ["0.3", "-2.5", "1.6"])
def test_turned_obstacles_are_covered(yaw: str) -> None:
    """With the turn rounded coarsely, so that floats can tell: about 1 / 64 of a pixel and more."""
    rng = np.random.default_rng(5)
    for _ in range(60):
        pixels = random_pixels(rng)
        header = MapHeader(
            Fraction(1, 2), (Fraction(3), Fraction(-1)), Fraction(yaw), False,
            Fraction("0.65"), Fraction("0.196"), "trinary",
        )  # fmt: skip
        polygons, inflation = placed(rectangles(pixels, MOST), pixels, header, bits=12)
        angle = float(yaw)
        turned = [np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle), 3, -1]
        boxes = [
            shapely.box(c / 2, r / 2, c / 2 + 0.5, r / 2 + 0.5) for r, c in np.argwhere(pixels)
        ]
        exact = shapely.affinity.affine_transform(shapely.unary_union(boxes), turned)
        found = shapely_of(polygons)
        assert exact.difference(found).area < 1e-12
        assert found.difference(exact.buffer(float(inflation) + 1e-12)).area < 1e-12
        assert 0 < inflation < Fraction(1, 20)
        for p in polygons:
            assert all(turn(p[i - 2], p[i - 1], p[i]) > 0 for i in range(4))


def test_every_turned_corner_is_within_a_rectangle_exactly() -> None:
    """Alone, a rectangle holds its own corners: decided with 60 digits, no float in it."""
    for yaw in ("0.1", "-1.2", "2.2", "5"):
        pixels = np.ones((3, 5), dtype=bool)
        [polygon], inflation = pieces_of(pixels, size="0.05", x="-7", y="11.5", yaw=yaw)
        assert 0 < inflation < Fraction(1, 10**12)
        with mpmath.workdps(60):
            turned = mpmath.expj(mpmath.mpf(yaw))
            for across, up in ((0, 0), (5, 0), (5, 3), (0, 3)):
                place = mpmath.mpc("-7", "11.5") + turned * mpmath.mpc(across, up) / 20
                point = (Fraction(str(place.real)), Fraction(str(place.imag)))
                sides = zip(polygon, polygon[1:] + polygon[:1], strict=True)
                assert all(turn(a, b, point) > 0 for a, b in sides)


def test_neighbours_share_their_sides_where_a_map_is_turned() -> None:
    """No slivers: a wall of two widths is two rectangles that touch."""
    pixels = np.array([[True, True, False], [True, True, True]])
    polygons, _ = pieces_of(pixels, yaw="0.2")
    assert len(polygons) == 2
    assert len(set(polygons[0]) & set(polygons[1])) >= 1
    joined = [shapely.Polygon([(float(x), float(y)) for x, y in p]) for p in polygons]
    assert joined[0].intersection(joined[1]).area < 1e-15
