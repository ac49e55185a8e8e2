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


def rectangles(pixels: NDArray[np.bool_]) -> Boxes:
    """Disjoint rectangles that cover exactly the pixels that are set.

    Args:
        pixels: shape (rows, columns).

    Returns:
        Shape (n, 4): first row, first column, and the row and column after the last; in
        lexicographic order.
    """
    import numpy as np

    by_rows = _joined_runs(pixels)
    by_columns = _joined_runs(pixels.T)[:, [1, 0, 3, 2]]
    found = by_rows if len(by_rows) <= len(by_columns) else by_columns
    return found[np.lexsort(found.T[::-1])]


def _joined_runs(pixels: NDArray[np.bool_]) -> Boxes:
    """The runs along the rows, those of equal columns in consecutive rows as one."""
    import numpy as np

    height, width = pixels.shape
    padded = np.zeros((height, width + 2), dtype=np.int8)
    padded[:, 1:-1] = pixels
    steps = np.diff(padded, axis=1)
    rows, first = np.nonzero(steps == 1)
    last = np.nonzero(steps == -1)[1]
    order = np.lexsort((rows, last, first))
    rows, first, last = rows[order], first[order], last[order]
    joins = (
        (first[1:] == first[:-1]) & (last[1:] == last[:-1]) & (rows[1:] == rows[:-1] + 1)
    )  # fmt: skip
    starts = np.flatnonzero(np.concatenate(([True], ~joins)))[: len(rows)]
    ends = np.append(starts[1:], len(rows))[: len(starts)] - 1
    return np.stack([rows[starts], first[starts], rows[ends] + 1, last[starts]], axis=1)
