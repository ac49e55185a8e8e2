"""A set of pixels as few disjoint rectangles.

Runs of equal extent in neighbouring lines are joined, once along the rows and once along the
columns, and the fewer rectangles are taken.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Boxes: TypeAlias = NDArray[np.int64]


_AT_ONCE = 2**21
"""So many pixels are looked at together: lists of runs take thirty times their memory."""


def rectangles(pixels: NDArray[np.bool_], most: int) -> Boxes | None:
    """Disjoint rectangles that cover exactly the pixels that are set.

    Args:
        pixels: shape (rows, columns).
        most: more rectangles are not made.

    Returns:
        Shape (n, 4): first row, first column, and the row and column after the last; in
        lexicographic order.  None where there would be more.
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
    """The runs along the rows, those of equal columns in consecutive rows as one.

    More rows never make fewer of them, so that nothing is gone on with where they are too many.
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
    """Boxes of which those with the same columns are one where they follow on each other."""
    import numpy as np

    top, first, bottom, last = boxes.T
    order = np.lexsort((top, last, first))
    top, first, bottom, last = (side[order] for side in (top, first, bottom, last))
    joins = (first[1:] == first[:-1]) & (last[1:] == last[:-1]) & (top[1:] == bottom[:-1])
    starts = np.flatnonzero(np.concatenate(([True], ~joins)))[: len(top)]
    ends = np.append(starts[1:], len(top))[: len(starts)] - 1
    return np.stack([top[starts], first[starts], bottom[ends], last[starts]], axis=1)
