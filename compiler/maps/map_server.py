"""The obstacles of a map_server map as rectangles.

Source: the ROS wiki, map_server, section 1 (map format).  The lower left corner of the image is at
the origin, its first row at the top.  Without a turn the rectangles are exact.  A turned lattice of
pixels has irrational corners: it is turned by a rational rotation instead, and the outline of the
obstacles is moved outwards by more than that is off.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from compiler.maps.grey_image import grey_image
from compiler.maps.map_fault import MapFault
from compiler.maps.map_header import MapHeader, map_header
from compiler.maps.occupancy import obstacles
from compiler.maps.pieces import Corner, Pieces, Polygon
from compiler.maps.rational_rotation import rational_rotation
from compiler.maps.rectangles import rectangles
from grammar_lang.diagnostics.codes import Code
from grammar_lang.ir import MapImage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from compiler.maps.rectangles import Boxes

    Pixels: TypeAlias = NDArray[np.bool_]

RECTANGLE_LIMIT = 100_000
"""More rectangles than these are not looked at, not even for being within the bounds."""
_GRID = 10**18


def map_server_pieces(text: str, path: str, image: MapImage) -> Pieces:
    """The pieces of a map.

    Args:
        text: its YAML file.
        path: where that lies.
        image: its image.

    Raises:
        MapFault: one of the two is damaged or too large.
    """
    header = map_header(text, path, image.path)
    pixels = obstacles(grey_image(image.data), header)[::-1]  # now the first row is the lowest
    boxes = rectangles(pixels, RECTANGLE_LIMIT)
    if boxes is None:
        message = f"the obstacles of this map are more than {RECTANGLE_LIMIT:,} rectangles"
        hint = "use a coarser map, and remove what is noise"
        raise MapFault(message, hint, None, Code.TOO_LARGE)
    polygons, inflation = placed(boxes, pixels, header)
    count = int(pixels.sum())
    origin = f"{count:,} occupied and unknown cell{'' if count == 1 else 's'}"
    height, width = pixels.shape
    extent, _ = placed(_one_box(height, width), pixels, header)
    side = f"{float(header.resolution):g} m"
    return Pieces(polygons, f"{origin} of {side}", inflation, extent[0])


def placed(
    boxes: Boxes, pixels: Pixels, header: MapHeader, bits: int = 48
) -> tuple[tuple[Polygon, ...], Fraction]:
    """Rectangles of pixels in the workspace, and how far (m) they reach out of these at most.

    Args:
        boxes: the rectangles, shape (n, 4), rows counted from the lowest one.
        pixels: what they cover, the lowest row first.
        header: resolution and pose.
        bits: how finely a turn is rounded.
    """
    height, width = pixels.shape
    size = header.resolution
    turn = rational_rotation(header.yaw, bits)
    move = _rounded_up(turn.error * size * (height + width))
    x, y = header.origin

    def corner(across: Fraction, up: Fraction) -> Corner:
        a, b = turn.apply(across, up)
        return x + a, y + b

    low, high = _lines(pixels, size, move)
    across_low, across_high = _lines(pixels.T, size, move)
    polygons = tuple(
        _rectangle((across_low[c], low[r]), (across_high[d], high[s]), corner)
        for r, c, s, d in boxes.tolist()
    )
    # A point of the outline moves by less than sqrt(2) * move, and the turn is off by move.
    return polygons, 3 * move


def _one_box(height: int, width: int) -> Boxes:
    import numpy as np

    return np.array([[0, 0, height, width]], dtype=np.int64)


def _rectangle(
    low: Corner, high: Corner, corner: Callable[[Fraction, Fraction], Corner]
) -> Polygon:
    (a, c), (b, d) = low, high
    return corner(a, c), corner(b, c), corner(b, d), corner(a, d)


def _rounded_up(value: Fraction) -> Fraction:
    return Fraction(-(-value.numerator * _GRID // value.denominator), _GRID)


def _lines(pixels: Pixels, size: Fraction, move: Fraction) -> tuple[list[Fraction], list[Fraction]]:
    """Where rectangles begin, and where they end, at each line between the rows of pixels.

    A line moves down where obstacles begin at it and up where obstacles end at it; all rectangles
    move with it, so that none overlap but where it has to do both.
    """
    import numpy as np

    height, width = pixels.shape
    rows = np.zeros((height + 2, width), dtype=bool)
    rows[1:-1] = pixels
    begins = np.any(rows[1:] & ~rows[:-1], axis=1)
    ends = np.any(rows[:-1] & ~rows[1:], axis=1)
    low, high = list[Fraction](), list[Fraction]()
    for number, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        place = number * size
        low.append(place - move if begin else place + move if end else place)
        high.append(place + move if end else place - move if begin else place)
    return low, high
