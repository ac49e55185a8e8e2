"""What is wrong with the image of a map, and how large one may be."""

from __future__ import annotations

from compiler.maps.map_fault import MapFault
from grammar_lang.diagnostics.codes import Code

PIXEL_LIMIT = 2**26
"""So many pixels may an image have."""

_HINT = "save it as PGM, or as PNG of 8 bits in shades of grey"


def image_fault(message: str) -> MapFault:
    """A fault of an image, which has no place in a text."""
    return MapFault(message, _HINT, None)


def check_size(width: int, height: int) -> None:
    """See to it that an image can be held.

    Args:
        width: pixels in a row.
        height: rows.

    Raises:
        MapFault: it has no pixels, or more than ``PIXEL_LIMIT``.
    """
    if not width or not height:
        raise image_fault("the image has no pixels")
    if width * height > PIXEL_LIMIT:
        message = f"the image has {width * height:,} pixels, more than {PIXEL_LIMIT:,}"
        hint = "cut it to the bounds of the workspace, or use a coarser map"
        raise MapFault(message, hint, None, Code.TOO_LARGE)
