"""Images of maps and their thresholds, against Pillow's images and map_server's own arithmetic."""

from __future__ import annotations

import struct
import tracemalloc
import zlib
from collections.abc import Callable
from fractions import Fraction
from io import BytesIO

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from compiler.workspaces.grey_image import grey_image
from compiler.workspaces.map_header import PIXEL_LIMIT, MapFault, MapHeader, Mode
from compiler.workspaces.map_server import obstacles
from grammar_lang.diagnostics.diagnostic import Code

OCCUPIED, FREE = Fraction("0.65"), Fraction("0.196")


def header(
    mode: Mode = "trinary",
    *,
    negate: bool = False,
    free: Fraction = FREE,
    occupied: Fraction = OCCUPIED,
) -> MapHeader:
    nowhere = Fraction(0), Fraction(0)
    return MapHeader(Fraction(1), nowhere, Fraction(0), negate, occupied, free, mode)


def saved(image: Image.Image, **options: object) -> bytes:
    file = BytesIO()
    image.save(file, options.pop("format", "PNG"), **options)  # type: ignore[arg-type]
    return file.getvalue()


def ramp() -> NDArray[np.uint8]:
    """All 256 brightnesses, 16 by 16."""
    return np.arange(256, dtype=np.uint8).reshape(16, 16)


def said_by_map_server(value: int, alpha: int, *, negate: bool) -> bool:
    """Whether a pixel is not free, as the wiki computes it, in rationals."""
    x = Fraction(255 - value if negate else value)
    occupancy = (255 - x) / 255
    return occupancy >= FREE or occupancy > OCCUPIED or alpha < 255


@pytest.mark.parametrize("mode", ["trinary", "scale"])
@pytest.mark.parametrize("negate", [False, True])
@pytest.mark.parametrize("kind", ["pgm", "L", "LA", "RGB", "RGBA", "P"])
def test_thresholds(mode: Mode, negate: bool, kind: str) -> None:
    grey = Image.fromarray(ramp())
    alpha = np.where(ramp() % 5 == 1, 128, 255).astype(np.uint8)
    image = grey if kind in {"pgm", "L"} else grey.convert(kind)
    if kind in {"LA", "RGBA"}:
        image.putalpha(Image.fromarray(alpha))
    data = saved(image, format="PPM") if kind == "pgm" else saved(image)
    found = obstacles(grey_image(data), header(mode, negate=negate))
    clear = alpha if kind in {"LA", "RGBA"} else np.full_like(alpha, 255)
    for value in range(256):
        place = divmod(value, 16)
        expected = said_by_map_server(value, int(clear[place]), negate=negate)
        assert found[place] == expected, value


@pytest.mark.parametrize(("free", "least"), [("0", 256), ("1", 1), ("0.2", 205), ("0.196", 206)])
def test_a_pixel_at_the_threshold_is_no_free_one(free: str, least: int) -> None:
    """0.2 * 255 = 51 exactly: 204 is not below it."""
    image = grey_image(saved(Image.fromarray(ramp())))
    found = obstacles(image, header(free=Fraction(free), occupied=Fraction(1)))
    assert np.count_nonzero(~found) == 256 - least
    assert found.ravel()[:least].all()


@pytest.mark.parametrize(("negate", "free"), [(False, 0), (True, 255)])
def test_raw_values(negate: bool, free: int) -> None:
    found = obstacles(grey_image(saved(Image.fromarray(ramp()))), header("raw", negate=negate))
    assert list(np.flatnonzero(~found)) == [free]


def test_colours_are_averaged() -> None:
    """230 + 205 + 180 is not above 3 * 205.02, the greatest sum that is not free; one more is."""
    pixels = np.array([[[230, 205, 180], [230, 206, 180], [0, 255, 255]]], dtype=np.uint8)
    found = obstacles(grey_image(saved(Image.fromarray(pixels))), header())
    assert found.tolist() == [[True, False, True]]


def test_images_of_16_bits() -> None:
    values = np.array([[0, 52689, 52690, 52691, 65535]], dtype=np.uint16)
    # 65535 * (1 - 0.196) = 52690.14
    for data in (
        b"P5\n# a comment\n5 1 65535\n" + values.astype(">u2").tobytes(),
        b"P2 5 1 65535\n" + b" ".join(b"%d" % v for v in values[0]),
        saved(Image.fromarray(values)),
    ):
        image = grey_image(data)
        assert image.values.tolist() == values.tolist()
        assert obstacles(image, header()).tolist() == [[True, True, True, False, False]]


def test_plain_pgm_of_few_greys() -> None:
    image = grey_image(b"P2 # made by hand\n3 2\n# so many\n7\n0 1 2 # first row\n7 6\n5")
    assert (image.values.tolist(), image.white) == ([[0, 1, 2], [7, 6, 5]], 7)
    # (7 - 6) / 7 = 0.143, (7 - 5) / 7 = 0.286
    assert obstacles(image, header()).tolist() == [[True] * 3, [False, False, True]]


def test_a_bilevel_png_and_one_with_a_transparent_grey() -> None:
    black_and_white = Image.fromarray(ramp() > 127)
    assert obstacles(grey_image(saved(black_and_white)), header()).tolist() == (
        (ramp() <= 127).tolist()
    )
    keyed = obstacles(grey_image(saved(Image.fromarray(ramp()), transparency=250)), header())
    assert np.flatnonzero(~keyed).tolist() == [*range(206, 250), *range(251, 256)]
    wide = np.array([[60000, 60001]], dtype=np.uint16)
    data = png(2, 1, 16, 0, b"\0" + wide.astype(">u2").tobytes(), trns=struct.pack(">H", 60000))
    assert obstacles(grey_image(data), header()).tolist() == [[True, False]]


def png(
    width: int, height: int, depth: int, colours: int, rows: bytes, trns: bytes | None = None
) -> bytes:
    """A PNG by its definition."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    start = struct.pack(">IIBBBBB", width, height, depth, colours, 0, 0, 0)
    parts = [chunk(b"IHDR", start)]
    parts += [] if trns is None else [chunk(b"tRNS", trns)]
    parts += [chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


@pytest.mark.parametrize(
    ("bits", "row", "key", "clear"),
    [
        (1, [0b10100000], 1, [True, False, True, False]),
        (2, [0b11011100], 3, [True, False, True, False]),
        (2, [0b11011100], 1, [False, True, False, False]),
        (2, [0b11011100], 0b111, [True, False, True, False]),  # bits beyond the two do not count
        (4, [0xF1, 0x3F], 15, [True, False, False, True]),
        (4, [0xF1, 0x3F], 3, [False, False, True, False]),
        (8, [255, 0, 255, 7], 255, [True, False, True, False]),
    ],
)
def test_the_transparent_value_of_grey_images(
    bits: int, row: list[int], key: int, clear: list[bool]
) -> None:
    found = grey_image(png(4, 1, bits, 0, b"\0" + bytes(row), trns=struct.pack(">H", key)))
    assert found.opaque is not None
    assert found.opaque.tolist() == [[not one for one in clear]]


def test_transparency_of_16_bits_is_refused() -> None:
    with pytest.raises(MapFault, match="16 bits"):
        grey_image(png(1, 1, 16, 4, b"\0\xff\xff\xff\xff"))


GOOD = saved(Image.fromarray(ramp()))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "neither PGM"),
        (b"P6 1 1 255\n\0\0\0", "neither PGM"),
        (b"P5", "header"),
        (b"P5 2 2 255", "header"),
        (b"P5 2 -2 255\n", "header"),
        (b"P5 2 2 255x", "header"),
        (b"P5 2 2 0\n\0\0\0\0", "greatest value"),
        (b"P5 2 2 65536\n\0\0\0\0", "greatest value"),
        (b"P5 0 2 255\n", "no pixels"),
        (b"P5 2 2 255\n\0\0\0", "before its last pixel"),
        (b"P5 2 2 256\n\0\0\0\0", "before its last pixel"),
        (b"P5 2 2 10\n\0\0\0\x0b", "brighter"),
        (b"P2 2 2 255\n0 1 2", "before its last pixel"),
        (b"P2 2 2 255\n0 1 2 256", "brighter"),
        (b"P2 2 2 255\n0 1 2 99999999999999999999", "brighter"),
        (b"P2 2 2 255\n0 1 2 -3", "not a number"),
        (b"P5 " + b"1" * 5000 + b" 2 255\n", "header"),
        (b"P5 2 2 " + b"0" * 5000 + b"255\n\0\0\0\0", "header"),
        (b"P5 2 2 +255\n\0\0\0\0", "header"),
        (b"P2 2 2 255\n0 1 2 " + b"9" * 5000, "brighter"),
        (b"P5" + b" " * 2**20 + b"2 2 255\n\0\0\0\0", "header"),
        (b"P5 " + b"#\n" * 2**20 + b"2 2 255\n\0\0\0\0", "header"),
        (b"P2 2 2 255\n0 1 2 x", "not a number"),
        (b"P5 99999 99999 255\n", "pixels, more than"),
        (GOOD[:20], "header of the PNG"),
        (GOOD[:50], "damaged"),
        (GOOD[:45] + b"\xff" + GOOD[46:], "damaged"),
        (GOOD[:33], "damaged"),
        (GOOD.replace(b"IHDR", b"IHDX"), "header of the PNG"),
        (GOOD[:16] + b"\x7f\xff\xff\xff" * 2 + GOOD[24:], "pixels, more than"),
        (b"\xff\xd8\xff\xe0", "neither PGM"),
    ],
)
def test_images_that_are_none(data: bytes, message: str) -> None:
    with pytest.raises(MapFault, match=message) as caught:
        grey_image(data)
    assert caught.value.place is None
    assert caught.value.hint


def test_an_image_that_unpacks_to_too_much() -> None:
    """The size is known before a pixel is unpacked."""
    side = int(PIXEL_LIMIT**0.5) + 1
    with pytest.raises(MapFault, match="more than 67,108,864") as caught:
        grey_image(png(side, side, 8, 0, b"\0" * 100))
    assert caught.value.code is Code.TOO_LARGE


def test_leading_zeros_and_comments_in_a_header() -> None:
    image = grey_image(b"P5\n# one\n#two\r\n 000002#three\n\t02\n\n007\n\0\1\2\7")
    assert (image.values.tolist(), image.white) == ([[0, 1], [2, 7]], 7)


def test_a_long_header_is_not_kept_to_come_back_to() -> None:
    data = b"P5" + b" " * 2**22
    tracemalloc.start()
    with pytest.raises(MapFault, match="header"):
        grey_image(data)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2**25


def test_a_file_is_read_by_what_it_is_not_by_its_name() -> None:
    make: Callable[[], bytes] = lambda: saved(Image.fromarray(ramp()), format="PPM")  # noqa: E731
    assert grey_image(make()).values.tolist() == ramp().tolist()
