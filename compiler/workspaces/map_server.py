"""The obstacles of a map_server map as rectangles.

Source: the ROS wiki, map_server, section 1 (map format).  The lower left corner of the image is at
the origin, and its first row is at the top.  Without rotation the rectangles are exact.  A rotated
lattice of pixels has irrational corners: a rational rotation is used instead, and the outline of
the obstacles is moved outwards by more than its error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.workspaces.grey_image import GreyImage, grey_image
from compiler.workspaces.map_header import MapFault, MapHeader, map_header
from compiler.workspaces.pieces import Corner, Pieces, Polygon
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.ir import MapImage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Pixels: TypeAlias = NDArray[np.bool_]
    Boxes: TypeAlias = NDArray[np.int64]

RECTANGLE_LIMIT = 100_000
"""Beyond this number, rectangles are not examined, not even for being within the bounds."""
_GRID = 10**18


def map_server_pieces(text: str, path: str, image: MapImage) -> Pieces:
    """The pieces of a map.

    Args:
        text: its YAML file.
        path: the path of that file.
        image: its image.

    Raises:
        MapFault: the file or the image is damaged or too large.
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
    """Rectangles of pixels in the workspace, and the most (m) that they extend beyond them.

    Args:
        boxes: the rectangles, shape (n, 4), with rows counted from the lowest one.
        pixels: the pixels that they cover, the lowest row first.
        header: resolution and pose.
        bits: the precision to which a rotation is rounded.
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
    # A point of the outline moves by less than sqrt(2) * move; the rotation error is at most move.
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
    """Where rectangles begin and where they end, at each line between the rows of pixels.

    A line moves down if obstacles begin at it and up if obstacles end at it.  All rectangles move
    with it, so none overlap unless it has to do both.
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


# --- Which pixels of a map are obstacles: all that are not certainly free -------------------------
#
# Source: the ROS wiki, map_server, section 1.3 (value interpretation).


def obstacles(image: GreyImage, header: MapHeader) -> NDArray[np.bool_]:
    """Whether each pixel is occupied or unknown, shape (rows, columns), the top row first.

    The occupancy of a pixel of brightness v is p = (w - v) / w, or v / w if ``negate``, where w is
    white.  It is free iff p is below ``free`` (which is at most ``occupied``) and, in the modes
    that give a transparent pixel no value, it is opaque.  Raw values are used as they are, or
    inverted if ``negate``, and only 0 is free.
    """
    white = image.white
    if header.mode == "raw":
        free = image.values == (white if header.negate else 0)
    elif header.negate:
        free = image.values < math.ceil(header.free * white)
    else:
        free = image.values > math.floor((1 - header.free) * white)
    if image.opaque is not None:
        free &= image.opaque
    found: NDArray[np.bool_] = ~free
    return found


# --- Rotations with rational sine and cosine, as near to a given angle as required ----------------
#
# Every rational t = tan(angle / 2) gives the rotation with cosine (1 - t^2) / (1 + t^2) and sine 2t
# / (1 + t^2); quarter turns are exact.  The error is bounded by a ball, not in floats.


BITS = 48
"""The binary digits of the tangent of half the angle."""


@dataclass(frozen=True, slots=True)
class RationalRotation:
    """An exact rotation; ``error`` bounds its distance, as a matrix norm, from the intended one."""

    cosine: Fraction
    sine: Fraction
    error: Fraction

    def apply(self, x: Fraction, y: Fraction) -> tuple[Fraction, Fraction]:
        """The image of a point."""
        return self.cosine * x - self.sine * y, self.sine * x + self.cosine * y


def rational_rotation(angle: Fraction, bits: int = BITS) -> RationalRotation:
    """A rational rotation within about ``2 ** -bits`` of an angle in radians; exact for 0."""
    if not angle:
        return RationalRotation(Fraction(1), Fraction(0), Fraction(0))
    with working_precision(4 * bits + 128):
        turn = ball(angle)
        quarter = arb.pi() / 2
        quarters = round(float(turn / quarter))
        tangent = ((turn - quarters * quarter) / 2).tan()
        t = Fraction(round(float(tangent.mid() * 2**bits)), 2**bits)
        cosine, sine = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        for _ in range(quarters % 4):
            cosine, sine = -sine, cosine
        # The matrix norm of the difference of two rotations is that of the complex numbers.
        real = turn.cos() - ball(cosine)
        imaginary = turn.sin() - ball(sine)
        distance = (real * real + imaginary * imaginary).sqrt()
        error = _above(distance * 2 ** (2 * bits), 2 ** (2 * bits))
    return RationalRotation(cosine, sine, error)


def _above(distance: arb, scale: int) -> Fraction:
    """A rational upper bound on all numbers of a ball, divided by ``scale``."""
    upper = distance.upper().ceil().unique_fmpz()
    if upper is None:
        raise ArithmeticError("the enclosure of a rotation is too wide")
    return Fraction(int(upper) + 1, scale)


# --- A set of pixels as few disjoint rectangles ---------------------------------------------------
#
# Runs of equal extent in neighbouring lines are joined, once along the rows and once along the
# columns; the division with fewer rectangles is used.


_AT_ONCE = 2**21
"""The most pixels processed together: lists of runs take thirty times their memory."""


def rectangles(pixels: NDArray[np.bool_], most: int) -> Boxes | None:
    """Disjoint rectangles that cover exactly the pixels that are set.

    Args:
        pixels: shape (rows, columns).
        most: the most rectangles to make.

    Returns:
        Shape (n, 4): first row, first column, and the row and column after the last; in
            lexicographic
        order.  None if there would be more than ``most``.
    """
    import numpy as np

    by_rows, by_columns = _joined_runs(pixels, most), _joined_runs(pixels.T, most)
    if by_columns is not None:
        by_columns = by_columns[:, [1, 0, 3, 2]]
    made = [boxes for boxes in (by_rows, by_columns) if boxes is not None]
    if not made:
        return None
    found = min(made, key=len)
    return found[np.lexsort(found.T[::-1])]


def _joined_runs(pixels: NDArray[np.bool_], most: int) -> Boxes | None:
    """The runs along the rows, with runs of equal columns in consecutive rows joined.

    More rows never make fewer runs, so the search stops once there are too many.
    """
    import numpy as np

    height, width = pixels.shape
    found = np.empty((0, 4), dtype=np.int64)
    step = max(1, _AT_ONCE // width)
    for top in range(0, height, step):
        found = _joined(np.concatenate([found, _runs(pixels[top : top + step], top)]))
        if len(found) > most:
            return None
    return found


def _runs(pixels: NDArray[np.bool_], top: int) -> Boxes:
    """The runs along some rows, the first of which has the number ``top``."""
    import numpy as np

    height, width = pixels.shape
    padded = np.zeros((height, width + 2), dtype=np.int8)
    padded[:, 1:-1] = pixels
    steps = np.diff(padded, axis=1)
    rows, first = np.nonzero(steps == 1)
    last = np.nonzero(steps == -1)[1]
    return np.stack([rows + top, first, rows + top + 1, last], axis=1)


def _joined(boxes: Boxes) -> Boxes:
    """Boxes, with those of equal columns in consecutive rows joined."""
    import numpy as np

    top, first, bottom, last = boxes.T
    order = np.lexsort((top, last, first))
    top, first, bottom, last = (side[order] for side in (top, first, bottom, last))
    joins = (first[1:] == first[:-1]) & (last[1:] == last[:-1]) & (top[1:] == bottom[:-1])
    starts = np.flatnonzero(np.concatenate(([True], ~joins)))[: len(top)]
    ends = np.append(starts[1:], len(top))[: len(starts)] - 1
    return np.stack([top[starts], first[starts], bottom[ends], last[starts]], axis=1)
