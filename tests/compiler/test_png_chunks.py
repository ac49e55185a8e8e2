"""PNG images that would make a reader of PNG do too much: told before a pixel is unpacked."""

from __future__ import annotations

import random
import struct
import zlib
from typing import Any

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from compiler.workspaces.grey_image import CHUNK_LIMIT, PngHeader, grey_image, png_chunks
from compiler.workspaces.map_header import MapFault
from grammar_lang.diagnostics.diagnostic import Code
from tests.oracles.png_files import KINDS, SIGNATURE, Chunk, ihdr, png_of, rows

GREY = ihdr(2, 2)
PIXELS = b"IDAT", zlib.compress(b"\0\x01\x02\0\x03\x04")
END = b"IEND", b""
HUGE = ihdr(2**13, 2**14)
FILE = png_of([GREY, PIXELS, END])


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """The sizes of the images of which Pillow unpacks the pixels."""
    sizes: list[tuple[int, int]] = []
    load = PngImagePlugin.PngImageFile.load

    def noted(self: PngImagePlugin.PngImageFile) -> Any:
        sizes.append(self.size)
        return load(self)

    monkeypatch.setattr(PngImagePlugin.PngImageFile, "load", noted)
    return sizes


def refused(data: bytes) -> MapFault:
    with pytest.raises(MapFault) as caught:
        grey_image(data)
    assert caught.value.place is None
    assert len(caught.value.message.splitlines()) == 1
    return caught.value


@pytest.mark.parametrize(
    "chunks",
    [
        [GREY, HUGE, PIXELS, END],
        [GREY, GREY, PIXELS, END],
        [GREY, PIXELS, HUGE, END],
        [GREY, (b"tEXt", b"a\0b"), HUGE, PIXELS, END],
    ],
)
def test_a_second_header_is_refused(chunks: list[Chunk], opened: list[Any]) -> None:
    assert refused(png_of(chunks)).message == (
        "the PNG image is damaged: there is a second chunk IHDR"
    )
    assert opened == []


def test_what_follows_the_end_is_not_looked_at(opened: list[Any]) -> None:
    image = grey_image(png_of([GREY, PIXELS, END, HUGE, PIXELS, END]) + b"\0garbage")
    assert image.values.tolist() == [[1, 2], [3, 4]]
    assert set(opened) == {(2, 2)}


def test_the_size_that_is_checked_is_the_one_that_is_unpacked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Other(PngImagePlugin.PngImageFile):
        size = 3, 3  # type: ignore[assignment]

        def load(self) -> Any:
            raise AssertionError

    monkeypatch.setattr(Image, "open", lambda file, formats: Other(file))
    assert "two sizes" in refused(FILE).message


def test_a_lower_limit_of_pillow_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 1)
    assert "Pillow" in refused(FILE).message


def frame(number: int, *place: int) -> Chunk:
    return b"fcTL", struct.pack(">IIIIIHHBB", number, *place, 1, 1, 0, 0)


ANIMATED = {
    "many frames": [GREY, (b"acTL", struct.pack(">II", 2**31, 0)), frame(0, 2, 2, 0, 0), PIXELS],
    "two counts": [GREY, *[(b"acTL", struct.pack(">II", 2, 0))] * 2, frame(0, 2, 2, 0, 0), PIXELS],
    "no frames": [GREY, (b"acTL", bytes(8)), PIXELS],
    "a part": [GREY, (b"acTL", struct.pack(">II", 1, 0)), frame(0, 1, 1, 1, 1), PIXELS],
    "outside": [GREY, (b"acTL", struct.pack(">II", 1, 0)), frame(0, 9, 9, 9, 9), PIXELS],
    "short": [GREY, (b"acTL", b""), (b"fcTL", b""), (b"fdAT", b""), PIXELS],
    "pixels of a frame": [GREY, PIXELS, frame(0, 2, 2, 0, 0), (b"fdAT", bytes(4) + PIXELS[1])],
}


@pytest.mark.parametrize("name", ANIMATED)
def test_of_an_animation_the_image_counts(name: str) -> None:
    """That is what readers take that know no animations."""
    image = grey_image(png_of([*ANIMATED[name], END]))
    assert image.values.tolist() == [[1, 2], [3, 4]]


BOMB = zlib.compress(bytes(2**24))
ASIDE = {
    "text": (b"tEXt", b"a" * 2**22),
    "packed text": (b"zTXt", b"a\0\0" + BOMB),
    "packed text of a language": (b"iTXt", b"a\0\1\0\0\0" + BOMB),
    "a profile": (b"iCCP", b"a\0\0" + BOMB),
    "a profile without content": (b"iCCP", b"a"),
    "a profile packed otherwise": (b"iCCP", b"a\0\7"),
    "a thumbnail": (b"eXIf", b"MM\0*" + b"\xff" * 100),
    "a gamma without value": (b"gAMA", b""),
    "a resolution without value": (b"pHYs", b"\0"),
    "primaries without value": (b"cHRM", b"\0"),
    "an intent without value": (b"sRGB", b""),
    "a private chunk": (b"prVt", b"\xff" * 100),
}


@pytest.mark.parametrize("name", ASIDE)
@pytest.mark.parametrize("place", [1, 2])
def test_what_is_beside_the_image_is_not_read(name: str, place: int) -> None:
    chunks = [GREY, PIXELS, END]
    chunks.insert(place, ASIDE[name])
    assert grey_image(png_of(chunks)).values.tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize("interlace", [0, 1])
@pytest.mark.parametrize(("depth", "colours"), KINDS)
def test_all_kinds_are_read(depth: int, colours: int, interlace: int) -> None:
    for seed in range(12):
        chance = random.Random(seed)
        width, height = chance.randint(1, 12), chance.randint(1, 12)
        data = rows(chance, width, height, depth, colours, interlace)
        palette = [(b"PLTE", chance.randbytes(3 * 2**depth))] * (colours == 3)
        header = ihdr(width, height, depth, colours, interlace)
        file = png_of([header, *palette, (b"IDAT", zlib.compress(data)), END])
        assert grey_image(file).values.shape == (height, width)
        found = PngHeader(width, height, depth, colours, bool(interlace))
        assert (png_chunks(file).header, found.size) == (found, len(data))
        for wrong, said in ((data[:-1], "before its last pixel"), (data + b"\0", "more pixels")):
            chunks = [header, *palette, (b"IDAT", zlib.compress(wrong)), END]
            assert said in refused(png_of(chunks)).message


def test_a_stream_of_pixels_that_goes_on_is_not_unpacked_to_its_end(
    monkeypatch: pytest.MonkeyPatch, opened: list[Any]
) -> None:
    packed = zlib.compress(bytes(2**26))
    unpacked = 0
    unpacker = zlib.decompressobj

    class Counted:
        def __init__(self) -> None:
            self.real = unpacker()

        def __getattr__(self, name: str) -> Any:
            return getattr(self.real, name)

        def decompress(self, data: bytes, most: int) -> bytes:
            nonlocal unpacked
            found = self.real.decompress(data, most)
            unpacked += len(found)
            return found

    monkeypatch.setattr(zlib, "decompressobj", Counted)
    assert "more pixels" in refused(png_of([GREY, (b"IDAT", packed), END])).message
    assert unpacked <= 2**20
    assert opened == []


KEY = b"tRNS", b"\0\0"
PALETTE = b"PLTE", bytes(6)
BIT = b"IDAT", zlib.compress(b"\0\x40")
INDEXED = ihdr(2, 1, 1, 3)


@pytest.mark.parametrize(
    ("chunks", "said"),
    [
        ([GREY, END], "before its last pixel"),
        ([GREY, PIXELS], "ends too soon"),
        ([GREY, PIXELS, (b"tEXt", b"x"), PIXELS, END], "between its pixels"),
        ([(b"CgBI", bytes(4)), GREY, PIXELS, END], "header"),
        ([(b"IHDR", GREY[1] + b"\0"), PIXELS, END], "header"),
        ([(b"IHDR", GREY[1][:12]), PIXELS, END], "header"),
        ([GREY, (b"ABCD", b""), PIXELS, END], "chunk ABCD is unknown"),
        ([GREY, (b"\0\0\0\0", b""), PIXELS, END], "no name"),
        ([GREY, (b"IDAT", PIXELS[1][:-5]), END], "before its last pixel"),
        ([GREY, (b"IDAT", PIXELS[1][:-4] + bytes(4)), END], "cannot be unpacked"),
        ([GREY, (b"IDAT", b"\xff" * 20), END], "cannot be unpacked"),
        ([GREY, (b"IDAT", b""), END], "before its last pixel"),
        ([GREY, (b"IDAT", zlib.compress(b"\7\1\2\7\3\4")), END], "damaged"),
        ([INDEXED, BIT, END], "palette has the wrong size"),
        ([INDEXED, (b"PLTE", b""), BIT, END], "palette has the wrong size"),
        ([INDEXED, (b"PLTE", bytes(5)), BIT, END], "palette has the wrong size"),
        ([INDEXED, (b"PLTE", bytes(9)), BIT, END], "palette has the wrong size"),
        ([INDEXED, (b"PLTE", bytes(3)), BIT, END], "no colour in its palette"),
        ([INDEXED, PALETTE, PALETTE, BIT, END], "second chunk PLTE"),
        ([INDEXED, BIT, PALETTE, END], "PLTE comes too late"),
        ([INDEXED, (b"tRNS", b"\0"), PALETTE, BIT, END], "PLTE comes too late"),
        ([INDEXED, PALETTE, (b"tRNS", bytes(3)), BIT, END], "transparency has the wrong size"),
        ([GREY, (b"tRNS", b"\0"), PIXELS, END], "transparency has the wrong size"),
        ([GREY, KEY, KEY, PIXELS, END], "second chunk tRNS"),
        ([GREY, PIXELS, KEY, END], "tRNS comes too late"),
        ([ihdr(1, 1, 8, 4), KEY, (b"IDAT", zlib.compress(bytes(3))), END], "transparency has"),
        ([ihdr(2, 2, 3), PIXELS, END], "header"),
        ([ihdr(2, 2, 8, 1), PIXELS, END], "header"),
        ([ihdr(2, 2, 4, 2), PIXELS, END], "header"),
        ([ihdr(2, 2, 16, 2), PIXELS, END], "16 bits"),
        ([ihdr(2, 2, interlace=2), PIXELS, END], "header"),
        ([(b"IHDR", GREY[1][:10] + b"\1" + GREY[1][11:]), PIXELS, END], "header"),
        ([(b"IHDR", GREY[1][:11] + b"\1" + GREY[1][12:]), PIXELS, END], "header"),
        ([ihdr(0, 2), PIXELS, END], "no pixels"),
        ([ihdr(2, 0), PIXELS, END], "no pixels"),
    ],
)
def test_chunks_that_make_no_image(chunks: list[Chunk], said: str) -> None:
    assert said in refused(png_of(chunks)).message


@pytest.mark.parametrize("place", range(0, len(FILE), 3))
def test_every_checksum_counts(place: int) -> None:
    spoilt = bytearray(FILE)
    spoilt[place] ^= 0x21
    refused(bytes(spoilt))


def test_a_chunk_is_no_longer_than_the_file() -> None:
    long = SIGNATURE + png_of([GREY])[8:] + b"\xff\xff\xff\xffIDAT" + bytes(100)
    assert "ends too soon" in refused(long).message


def test_so_many_chunks_are_no_image() -> None:
    one = png_of([(b"IDAT", b"")])[8:]
    assert "more than 65,536 chunks" in refused(png_of([GREY]) + one * CHUNK_LIMIT).message


@pytest.mark.parametrize(
    ("colours", "key", "clear"),
    [
        (0, b"\1\xff", [False, True]),  # the upper eight bits do not count
        (2, b"\1\x09\2\x09\3\x09", [True, False]),
    ],
)
def test_bits_of_a_transparent_colour_that_do_not_count(
    colours: int, key: bytes, clear: list[bool]
) -> None:
    row = b"\x09\xff" if not colours else b"\x09\x09\x09\x09\x09\x08"
    pixels = b"IDAT", zlib.compress(b"\0" + row)
    found = grey_image(png_of([ihdr(2, 1, 8, colours), (b"tRNS", key), pixels, END]))
    assert found.opaque is not None
    assert found.opaque.tolist() == [[not one for one in clear]]
    bit = b"IDAT", zlib.compress(b"\0\x40")
    found = grey_image(png_of([ihdr(2, 1, 1), (b"tRNS", b"\0\2"), bit, END]))
    assert found.opaque is not None
    assert np.flatnonzero(~found.opaque).tolist() == [0]


def test_too_many_pixels_are_too_large() -> None:
    assert refused(png_of([HUGE, PIXELS, END])).code is Code.TOO_LARGE
