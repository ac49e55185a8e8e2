"""Read the convex pieces of a VRML 2.0 file, as boundingmesh writes them for Timor's sets.

Only the lists of points are read: a piece is the hull of one list.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from srgc.imports.source_fault import file_fault

START = b"#VRML V2.0 utf8"
MOST_PIECES = 500


def vrml_pieces(content: bytes, path: Path) -> list[NDArray[np.float64]]:
    """The points (n, 3) of each shape in the content of a file.

    Raises:
        SourceFault: the file is of another kind, or a list of points is invalid.
    """
    if not content.startswith(START):
        said = f"it is not a VRML 2.0 file: it does not begin with {START.decode()}"
        raise file_fault(path, said)
    lines = (line.split(b"#")[0] for line in content.split(b"\n"))
    words = b" ".join(lines).replace(b",", b" ").replace(b"[", b" [ ").replace(b"]", b" ] ").split()
    found = list[NDArray[np.float64]]()
    for number, word in enumerate(words):
        if word != b"point" or words[number + 1 : number + 2] != [b"["]:
            continue
        found.append(_points(words, number + 2, path))
    if not found or len(found) > MOST_PIECES:
        raise file_fault(path, f"it has {len(found)} shapes; 1 to {MOST_PIECES} are read")
    return found


def _points(words: list[bytes], start: int, path: Path) -> NDArray[np.float64]:
    try:
        stop = words.index(b"]", start)
        points = np.array([float(word) for word in words[start:stop]]).reshape(-1, 3)
    except ValueError:
        raise file_fault(path, "a list of points is broken") from None
    if len(points) < 4 or not np.all(np.isfinite(points)) or np.abs(points).max() > 1e6:
        raise file_fault(path, "a shape has at least 4 points, all of them finite")
    return points
