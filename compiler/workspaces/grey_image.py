"""Images of maps as brightness values: PGM read here, exactly, and PNG by Pillow.

Sources: the Netpbm manual, pgm(5); W3C, *Portable Network Graphics*, section 11.2.2 (header).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, TypeAlias

from compiler.workspaces.map_fault import check_size, image_fault
from compiler.workspaces.png_chunks import PALETTE, SIGNATURE, PngChunks, png_chunks

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Values: TypeAlias = NDArray[np.unsignedinteger[Any]]

HEADER_LIMIT = 2**16
"""The header of a PGM image ends within so many bytes, comments included."""

_PGM = re.compile(rb"P([25])" + rb"(?:\s|#[^\n]*\n)+([0-9]{1,9})" * 3)
_COMMENT = re.compile(rb"#[^\n]*")


@dataclass(frozen=True, slots=True)
class GreyImage:
    """Brightness by row, the top one first, and column: 0 is black, ``white`` is white.

    ``opaque`` is False where a pixel is transparent at all; None where there is no transparency.
    """

    values: Values
    white: int
    opaque: NDArray[np.bool_] | None = None


def grey_image(data: bytes) -> GreyImage:
    """The image in the bytes of a file; of colours, the sum of the three channels.

    Raises:
        MapFault: it is none, damaged or too large.
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
    """The numbers of a plain PGM, comments left out."""
    import numpy as np

    text = _COMMENT.sub(b"", body)
    if not re.fullmatch(rb"[0-9\s]*", text):
        raise image_fault("a pixel of the PGM image is no number")
    if re.search(rb"[0-9]{6}", text):
        raise image_fault("a pixel of the PGM image is brighter than its greatest value")
    values = np.fromstring(text.decode("ascii"), dtype=np.uint32, sep=" ")
    if len(values) < count:
        raise image_fault("the image ends before its last pixel")
    return values[:count]


# --- PNG ---------------------------------------------------------------------------------------

SCALED = {2: 85, 4: 17}
"""Bits of a sample of a PNG, and by what Pillow multiplies samples of so many bits."""


def _png(data: bytes) -> GreyImage:
    import struct
    import zlib

    from PIL.Image import DecompressionBombError

    chunks = png_chunks(data)
    try:
        return _opened(chunks)
    except (OSError, SyntaxError, ValueError, EOFError, struct.error, zlib.error) as error:
        raise image_fault(f"the PNG image is damaged: {type(error).__name__}") from None
    except DecompressionBombError:
        # Whoever has srgc as a library may have set a lower limit.
        raise image_fault("the PNG image has more pixels than Pillow is allowed to read") from None


def _opened(chunks: PngChunks) -> GreyImage:
    import warnings

    import numpy as np
    from PIL import Image

    header = chunks.header
    with warnings.catch_warnings():
        # The size is looked at already.
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
    """An image of few bits: Pillow scales its samples to 255, but not the transparent value."""
    return GreyImage(values, 255, values != key * SCALED[bits])


def _keyed(image: Any, values: Values) -> NDArray[np.bool_] | None:
    """The pixels that do not have the one value that counts as transparent, if there is one."""
    key = image.info.get("transparency")
    opaque: NDArray[np.bool_] | None = None if key is None else values != key
    return opaque
