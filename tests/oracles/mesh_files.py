"""Meshes as files: a tube and a wedge in millimetres, written without the project."""

from __future__ import annotations

import math
import struct

Corner = tuple[float, float, float]

WEDGE = """\
# a wedge of 250 mm
v 0 -30 -20
v 0 30 -20
v 0 30 20
v 0 -30 20
v 250 -10 -1e1
v 250 10 -10
v 250 10 10
v 250 -10 10
f 1 2 3 4
f 5/1 6/1 7/1
"""


def tube(facets: int = 48, length: float = 300.0, radius: float = 25.0) -> list[list[Corner]]:
    """The triangles of a closed tube along x."""
    found: list[list[Corner]] = []
    for number in range(facets):
        ring: list[Corner] = []
        for each in (number, number + 1):
            angle = 2 * math.pi * each / facets
            y, z = radius * math.cos(angle), radius * math.sin(angle)
            ring += [(0.0, y, z), (length, y, z)]
        a, b, c, d = ring
        found += [[a, b, c], [b, c, d], [(0.0, 0.0, 0.0), a, c], [(length, 0.0, 0.0), b, d]]
    return found


def binary_stl(triangles: list[list[Corner]], header: bytes = b"solid tube") -> bytes:
    """A header that begins like a text does, as many programs write it."""
    parts = [header.ljust(80, b" "), struct.pack("<I", len(triangles))]
    parts += [
        struct.pack("<12fH", 0, 0, 0, *(x for corner in each for x in corner), 0)
        for each in triangles
    ]
    return b"".join(parts)


def text_stl(triangles: list[list[Corner]]) -> bytes:
    """The same as text."""
    lines = ["solid tube"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", "  outer loop"]
        lines += [f"    vertex {x!r} {y!r} {z!r}" for x, y, z in triangle]
        lines += ["  endloop", "endfacet"]
    return "\n".join([*lines, "endsolid tube", ""]).encode()
