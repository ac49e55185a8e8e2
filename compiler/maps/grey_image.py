"""Images of maps as brightness values: PGM read here, exactly, and PNG by Pillow.

Sources: the Netpbm manual, pgm(5); W3C, *Portable Network Graphics*, section 11.2.2 (header).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, TypeAlias

from compiler.maps.map_fault import MapFault
from grammar_lang.findings.codes import Code

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Values: TypeAlias = NDArray[np.unsignedinteger[Any]]

PIXEL_LIMIT = 2**26
"""So many pixels may an image have."""

_HINT = "save it as PGM, or as PNG of 8 bits in shades of grey"
_PGM = re.compile(rb"P([25])" + rb"(?:\s|#[^\n]*\n)+([0-9]{1,9})" * 3)
_PNG = b"\x89PNG\r\n\x1a\n"
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
    if data.startswith(_PNG):
        return _png(data)
    if data[:2] in {b"P2", b"P5"}:
        return _pgm(data)
    raise _fault("the image is neither PGM (P2, P5) nor PNG")


def _fault(message: str, hint: str = _HINT) -> MapFault:
    return MapFault(message, hint, None)


def _check_size(width: int, height: int) -> None:
    if not width or not height:
        raise _fault("the image has no pixels")
    if width * height > PIXEL_LIMIT:
        message = f"the image has {width * height:,} pixels, more than {PIXEL_LIMIT:,}"
        hint = "cut it to the bounds of the workspace, or use a coarser map"
        raise MapFault(message, hint, None, Code.TOO_LARGE)


# --- PGM ---------------------------------------------------------------------------------------


def _pgm(data: bytes) -> GreyImage:
    import numpy as np

    found = _PGM.match(data)
    if found is None or not data[found.end() : found.end() + 1].isspace():
        raise _fault("the header of the PGM image is damaged")
    width, height, white = (int(found[group]) for group in (2, 3, 4))
    _check_size(width, height)
    if not 0 < white < 2**16:
        raise _fault("the greatest value of the PGM image is not between 1 and 65,535")
    start = found.end() + 1
    count = width * height
    if found[1] == b"2":
        values = _plain(data[start:], count)
    else:
        kind = np.dtype(np.uint8 if white < 2**8 else ">u2")
        if len(data) - start < count * kind.itemsize:
            raise _fault("the image ends before its last pixel")
        values = np.frombuffer(data, kind, count, start)
    if int(values.max()) > white:
        raise _fault("a pixel of the PGM image is brighter than its greatest value")
    return GreyImage(values.reshape(height, width), white)


def _plain(body: bytes, count: int) -> Values:
    """The numbers of a plain PGM, comments left out."""
    import numpy as np

    text = _COMMENT.sub(b"", body)
    if not re.fullmatch(rb"[0-9\s]*", text):
        raise _fault("a pixel of the PGM image is no number")
    if re.search(rb"[0-9]{6}", text):
        raise _fault("a pixel of the PGM image is brighter than its greatest value")
    values = np.fromstring(text.decode("ascii"), dtype=np.uint32, sep=" ")
    if len(values) < count:
        raise _fault("the image ends before its last pixel")
    return values[:count]


SCALED = {2: 85, 4: 17}
"""Bits of a sample of a PNG, and by what Pillow multiplies samples of so many bits."""

# --- PNG ---------------------------------------------------------------------------------------


def _png(data: bytes) -> GreyImage:
    import zlib

    if len(data) < 33 or data[12:16] != b"IHDR":
        raise _fault("the header of the PNG image is damaged")
    _check_size(int.from_bytes(data[16:20]), int.from_bytes(data[20:24]))
    if data[24] == 16 and data[25] != 0:
        raise _fault("the PNG image has colours or transparency of 16 bits")
    import struct

    try:
        return _opened(data)
    except (OSError, SyntaxError, ValueError, EOFError, struct.error, zlib.error) as error:
        raise _fault(f"the PNG image is damaged: {type(error).__name__}") from None


def _opened(data: bytes) -> GreyImage:
    import warnings

    import numpy as np
    from PIL import Image

    with warnings.catch_warnings():
        # The size is looked at already.
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        with Image.open(BytesIO(data), formats=["PNG"]) as image:
            image.load()
            if image.mode.startswith("I"):
                wide = np.asarray(image, dtype=np.uint32)
                return GreyImage(wide, 2**16 - 1, _keyed(image, wide))
            clear = "transparency" in image.info or image.mode in {"LA", "RGBA", "PA"}
            grey = image.mode in {"1", "L", "LA"}
            if grey and clear and data[25] == 0 and data[24] in SCALED:
                return _scaled(np.asarray(image.convert("L")), image.info["transparency"], data[24])
            kind = ("LA" if clear else "L") if grey else ("RGBA" if clear else "RGB")
            pixels = np.asarray(image.convert(kind))
    opaque = pixels[..., -1] == 255 if clear else None
    if kind == "L":
        return GreyImage(pixels, 255)
    if kind == "LA":
        return GreyImage(pixels[..., 0], 255, opaque)
    return GreyImage(pixels[..., :3].sum(axis=2, dtype=np.uint16), 3 * 255, opaque)


def _scaled(values: Values, key: int, bits: int) -> GreyImage:
    """An image of few bits: Pillow scales its samples to 255, but not the transparent value."""
    sample = key % 2**bits
    return GreyImage(values, 255, values != sample * SCALED[bits])


def _keyed(image: Any, values: Values) -> NDArray[np.bool_] | None:
    """The pixels that do not have the one value that counts as transparent, if there is one."""
    key = image.info.get("transparency")
    opaque: NDArray[np.bool_] | None = None if key is None else values != key
    return opaque
