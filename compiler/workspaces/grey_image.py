"""Images of maps as brightness values: PGM is read here, exactly; PNG by Pillow, chunks first."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, TypeAlias

from compiler.workspaces.map_header import MapFault, check_size, image_fault

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Values: TypeAlias = NDArray[np.unsignedinteger[Any]]


# --------------------------------------------------------------------------------------------------
# The chunks of a PNG: checked before any pixel is unpacked, and reduced to those of the image.
#
# Source: W3C, *Portable Network Graphics (PNG) Specification (Third Edition)*, sections 5
# (structure of a file), 8.1 (interlacing), 11.2 (critical chunks) and 11.3.1 (transparency).
#
# A general PNG reader does more than a map needs: it follows animations, unpacks texts and colour
# profiles, and uses the last of two headers.  So it is given a file with only the chunks of the
# image, whose number of pixels has been checked against the header.


SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHUNK_LIMIT = 2**16
"""The most chunks of an image; encoders begin a new one every few thousand bytes at most."""

PALETTE = 3
"""The colour type whose samples are indices into a palette."""
_SAMPLES = {0: 1, 2: 3, PALETTE: 1, 4: 2, 6: 4}
"""The number of samples per pixel, by colour type."""
_DEPTHS = {0: (1, 2, 4, 8, 16), 2: (8, 16), PALETTE: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
"""The possible bits per sample, by colour type."""
_KEYS = {0: 2, 2: 6}
"""The bytes of the single transparent colour, by colour type."""
_PASSES = (
    (0, 8, 0, 8), (4, 8, 0, 8), (0, 4, 4, 8), (2, 4, 0, 4), (0, 2, 2, 4), (1, 2, 0, 2), (0, 1, 1, 2)
)  # fmt: skip
"""The passes of an interlaced image: first column, step, first row, step."""
_CHECKSUM = 4
_PIECE = 2**16
_MOST = 2**20
"""The most bytes that are unpacked at once."""


@dataclass(frozen=True, slots=True)
class PngHeader:
    """The header: pixels, bits per sample, colour type."""

    width: int
    height: int
    depth: int
    colours: int
    interlaced: bool

    @property
    def size(self) -> int:
        """The bytes of all rows, each with one byte for its filter."""
        bits = self.depth * _SAMPLES[self.colours]
        size = 0
        for left, across, top, down in _PASSES if self.interlaced else ((0, 1, 0, 1),):
            columns = len(range(left, self.width, across))
            rows = len(range(top, self.height, down))
            size += rows * (1 + (columns * bits + 7) // 8) if columns else 0
        return size


@dataclass(frozen=True, slots=True)
class PngChunks:
    """The chunks of the image; ``palette`` and ``transparency`` are empty if there are none."""

    header: PngHeader
    start: bytes
    palette: bytes
    transparency: bytes
    pixels: tuple[memoryview, ...]

    @property
    def entries(self) -> int:
        """The number of colours in the palette."""
        return len(self.palette) // 3

    @property
    def file(self) -> bytes:
        """A PNG with only these chunks."""
        parts = [SIGNATURE, _chunk(b"IHDR", self.start)]
        parts += [_chunk(b"PLTE", self.palette)] if self.header.colours == PALETTE else []
        parts += [_chunk(b"tRNS", self.transparency)] if self.transparency else []
        return b"".join([*parts, _chunk(b"IDAT", b"".join(self.pixels)), _chunk(b"IEND", b"")])


def png_chunks(data: bytes) -> PngChunks:
    """The chunks of a PNG that make up its image.

    Args:
        data: the bytes of a file that begins with ``SIGNATURE``.

    Raises:
        MapFault: the image is damaged or too large, or does not have as many pixels as its header
            says.
    """
    header = _header(data)
    found: dict[bytes, list[memoryview]] = {b"PLTE": [], b"tRNS": [], b"IDAT": []}
    last = b""
    for kind, body in _chunks(memoryview(data)):
        _check_order(kind, last, found)
        last = kind
        if kind in found:
            found[kind].append(body)
    palette = b"".join(found[b"PLTE"])
    _check_palette(header, palette)
    transparency = _transparency(header, palette, b"".join(found[b"tRNS"]))
    _check_pixels(header, found[b"IDAT"])
    return PngChunks(header, data[16:29], palette, transparency, tuple(found[b"IDAT"]))


def _damaged(how: str) -> MapFault:
    return image_fault(f"the PNG image is damaged: {how}")


def _chunk(kind: bytes, body: bytes) -> bytes:
    checksum = zlib.crc32(body, zlib.crc32(kind))
    return b"".join([len(body).to_bytes(4), kind, body, checksum.to_bytes(4)])


def _header(data: bytes) -> PngHeader:
    """The header, which is the first chunk; its checksum is verified with those of the others."""
    if len(data) < 33 or data[8:16] != (13).to_bytes(4) + b"IHDR":
        raise image_fault("the header of the PNG image is damaged")
    width, height = int.from_bytes(data[16:20]), int.from_bytes(data[20:24])
    check_size(width, height)
    depth, colours, compression, filtering, interlacing = data[24:29]
    if depth not in _DEPTHS.get(colours, ()) or compression or filtering or interlacing > 1:
        raise image_fault("the header of the PNG image is damaged")
    if depth == 16 and colours:
        raise image_fault("the PNG image has colours or transparency of 16 bits")
    return PngHeader(width, height, depth, colours, bool(interlacing))


def _chunks(data: memoryview) -> Iterator[tuple[bytes, memoryview]]:
    """The kind and content of each chunk up to the last one.

    Raises:
        MapFault: a chunk is damaged, there are too many chunks, or the last one is missing.
    """
    place = len(SIGNATURE)
    for _ in range(CHUNK_LIMIT):
        start = place + 8
        length, kind = int.from_bytes(data[place : start - 4]), bytes(data[start - 4 : start])
        place = start + length + _CHECKSUM
        if place > len(data):
            raise _damaged("it ends too soon")
        if not kind.isalpha():
            raise _damaged("a chunk has no name")
        body = data[start : start + length]
        if zlib.crc32(body, zlib.crc32(kind)) != int.from_bytes(data[place - _CHECKSUM : place]):
            raise _damaged(f"the checksum of chunk {kind.decode()} is wrong")
        yield kind, body
        if kind == b"IEND":
            return
    raise _damaged(f"it has more than {CHUNK_LIMIT:,} chunks")


def _check_order(kind: bytes, last: bytes, found: dict[bytes, list[memoryview]]) -> None:
    """Check that a chunk may follow the previous one and those that were found."""
    name = f"chunk {kind.decode()}"
    once = {b"PLTE", b"tRNS"}
    if (kind == b"IHDR" and last) or (kind in once and found[kind]):
        raise _damaged(f"there is a second {name}")
    if kind in once and (found[b"IDAT"] or found[b"tRNS"]):
        raise _damaged(f"{name} comes too late")
    if kind == b"IDAT" and found[kind] and last != kind:
        raise _damaged("other chunks stand between its pixels")
    # A capital letter marks a critical chunk: the image cannot be understood without it.
    if kind[:1].isupper() and kind not in {b"IHDR", b"PLTE", b"IDAT", b"IEND"}:
        raise _damaged(f"{name} is unknown")


def _check_palette(header: PngHeader, palette: bytes) -> None:
    """Check that a palette image has a palette, with at most as many colours as sample values."""
    entries, rest = divmod(len(palette), 3)
    numbers = 2**header.depth if header.colours == PALETTE else 256
    if rest or entries > numbers or (header.colours == PALETTE and not entries):
        raise _damaged("its palette has the wrong size")


def _transparency(header: PngHeader, palette: bytes, given: bytes) -> bytes:
    """The transparency; for a transparent colour, without unused bits."""
    if not given:
        return given
    if header.colours == PALETTE:
        fits = len(given) <= len(palette) // 3
    else:
        fits = len(given) == _KEYS.get(header.colours)
    if not fits:
        raise _damaged("its transparency has the wrong size")
    if header.colours == PALETTE:
        return given
    mask = (2**header.depth - 1).to_bytes(2) * (len(given) // 2)
    return bytes(byte & bits for byte, bits in zip(given, mask, strict=True))


def _check_pixels(header: PngHeader, pixels: list[memoryview]) -> None:
    """Check that the pixels unpack to as many bytes as the header says; none are kept."""
    left = header.size
    try:
        for count in _unpacked(pixels):
            left -= count
            if left < 0:
                raise _damaged("it has more pixels than its header says")
    except zlib.error:
        raise _damaged("its pixels cannot be unpacked") from None
    except EOFError:
        left = 1
    if left:
        raise _damaged("it ends before its last pixel")


def _unpacked(pixels: list[memoryview]) -> Iterator[int]:
    """The numbers of bytes that the pixels unpack to, piece by piece.

    Raises:
        zlib.error: they cannot be unpacked.
        EOFError: their end is missing.
    """
    unpacker = zlib.decompressobj()
    for chunk in pixels:
        for start in range(0, len(chunk), _PIECE):
            waiting: bytes | memoryview = chunk[start : start + _PIECE]
            while waiting and not unpacker.eof:
                yield len(unpacker.decompress(waiting, _MOST))
                waiting = unpacker.unconsumed_tail
            if unpacker.eof:
                return
    yield len(unpacker.flush())
    if not unpacker.eof:
        raise EOFError


# --- Images of maps as brightness values: PGM read here, exactly, and PNG by Pillow ---------------
#
# Sources: the Netpbm manual, pgm(5); W3C, *Portable Network Graphics*, section 11.2.2 (header).


HEADER_LIMIT = 2**16
"""The most bytes of the header of a PGM image, comments included."""

_PGM = re.compile(rb"P([25])" + rb"(?:\s|#[^\n]*\n)+([0-9]{1,9})" * 3)
_COMMENT = re.compile(rb"#[^\n]*")


@dataclass(frozen=True, slots=True)
class GreyImage:
    """Brightness by row, the top one first, and column: 0 is black, ``white`` is white.

    ``opaque`` is False for every pixel with any transparency; None if the image has no
    transparency.
    """

    values: Values
    white: int
    opaque: NDArray[np.bool_] | None = None


def grey_image(data: bytes) -> GreyImage:
    """The image in the bytes of a file; for colours, the sum of the three channels.

    Raises:
        MapFault: it is not an image, or is damaged or too large.
    """
    if data.startswith(SIGNATURE):
        return _png(data)
    if data[:2] in {b"P2", b"P5"}:
        return _pgm(data)
    raise image_fault("the image is neither PGM (P2, P5) nor PNG")


# --- PGM ---------------------------------------------------------------------------------------


def _pgm(data: bytes) -> GreyImage:
    import numpy as np

    found = _PGM.match(data, 0, HEADER_LIMIT)
    if found is None or not data[found.end() : found.end() + 1].isspace():
        raise image_fault("the header of the PGM image is damaged")
    width, height, white = (int(found[group]) for group in (2, 3, 4))
    check_size(width, height)
    if not 0 < white < 2**16:
        raise image_fault("the greatest value of the PGM image is not between 1 and 65,535")
    start = found.end() + 1
    count = width * height
    if found[1] == b"2":
        values = _plain(data[start:], count)
    else:
        kind = np.dtype(np.uint8 if white < 2**8 else ">u2")
        if len(data) - start < count * kind.itemsize:
            raise image_fault("the image ends before its last pixel")
        values = np.frombuffer(data, kind, count, start)
    if int(values.max()) > white:
        raise image_fault("a pixel of the PGM image is brighter than its greatest value")
    return GreyImage(values.reshape(height, width), white)


def _plain(body: bytes, count: int) -> Values:
    """The numbers of a plain PGM, without comments."""
    import numpy as np

    text = _COMMENT.sub(b"", body)
    if not re.fullmatch(rb"[0-9\s]*", text):
        raise image_fault("a pixel of the PGM image is not a number")
    if re.search(rb"[0-9]{6}", text):
        raise image_fault("a pixel of the PGM image is brighter than its greatest value")
    values = np.fromstring(text.decode("ascii"), dtype=np.uint32, sep=" ")
    if len(values) < count:
        raise image_fault("the image ends before its last pixel")
    return values[:count]


# --- PNG ---------------------------------------------------------------------------------------

SCALED = {2: 85, 4: 17}
"""Bits per sample of a PNG, and the factor by which Pillow multiplies such samples."""
_INSTALL = 'install it with `pip install "srgc[png]"`, or save the image as PGM'


def _png(data: bytes) -> GreyImage:
    import struct
    import zlib

    chunks = png_chunks(data)
    try:
        from PIL.Image import DecompressionBombError
    except ModuleNotFoundError:
        raise MapFault("a map in PNG needs the library Pillow", _INSTALL, None) from None
    try:
        return _opened(chunks)
    except (OSError, SyntaxError, ValueError, EOFError, struct.error, zlib.error) as error:
        raise image_fault(f"the PNG image is damaged: {type(error).__name__}") from None
    except DecompressionBombError:
        # A program that uses srgc as a library may have set a lower limit.
        raise image_fault("the PNG image has more pixels than Pillow is allowed to read") from None


def _opened(chunks: PngChunks) -> GreyImage:
    import warnings

    import numpy as np
    from PIL import Image

    header = chunks.header
    with warnings.catch_warnings():
        # The size was checked before.
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        with Image.open(BytesIO(chunks.file), formats=["PNG"]) as image:
            if image.size != (header.width, header.height):
                raise image_fault("the PNG image is damaged: it has two sizes")
            image.load()
            if image.mode.startswith("I"):
                wide = np.asarray(image, dtype=np.uint32)
                return GreyImage(wide, 2**16 - 1, _keyed(image, wide))
            if header.colours == PALETTE and int(np.asarray(image).max()) >= chunks.entries:
                raise image_fault("a pixel of the PNG image has no colour in its palette")
            clear = "transparency" in image.info or image.mode in {"LA", "RGBA", "PA"}
            grey = image.mode in {"1", "L", "LA"}
            if grey and clear and not header.colours and header.depth in SCALED:
                key = image.info["transparency"]
                return _scaled(np.asarray(image.convert("L")), key, header.depth)
            kind = ("LA" if clear else "L") if grey else ("RGBA" if clear else "RGB")
            pixels = np.asarray(image if image.mode == kind else image.convert(kind))
    opaque = pixels[..., -1] == 255 if clear else None
    if kind == "L":
        return GreyImage(pixels, 255)
    if kind == "LA":
        return GreyImage(pixels[..., 0], 255, opaque)
    return GreyImage(pixels[..., :3].sum(axis=2, dtype=np.uint16), 3 * 255, opaque)


def _scaled(values: Values, key: int, bits: int) -> GreyImage:
    """An image with few bits: Pillow scales its samples to 255, but not the transparent value."""
    return GreyImage(values, 255, values != key * SCALED[bits])


def _keyed(image: Any, values: Values) -> NDArray[np.bool_] | None:
    """The pixels without the value that counts as transparent; None if there is none."""
    key = image.info.get("transparency")
    opaque: NDArray[np.bool_] | None = None if key is None else values != key
    return opaque
