"""Obstacle files: maps in the plane, and meshes."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from grammar_lang.ir.expressions import NOWHERE, Expr, World
from grammar_lang.source import Span, node


@node
class MapImage:
    """The image that a map_server YAML names; ``path`` as in :class:`ObstacleMap`."""

    path: str
    data: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An object of a mesh, represented by the convex hull of its corners.

    ``corners`` are distinct, in the unit of the mesh; ``faces`` are triangles of corner indices.
    ``label`` is its name in messages.
    """

    label: str
    corners: tuple[tuple[Fraction, ...], ...]
    faces: tuple[tuple[int, int, int], ...]


@node
class Scene:
    """The objects of a mesh, identified by its ``digest``; its unit is ``scale`` metres.

    ``frame`` is closed; it leads from the world to the axes of the file.
    """

    digest: str
    objects: tuple[SceneObject, ...] = field(compare=False, repr=False)
    scale: Fraction = Fraction(1)
    frame: Expr = World()
    dimension: Literal[2, 3] = 3


@node
class ObstacleMap:
    """An obstacle file: a map_server image with its YAML, polygons as GeoJSON, or a mesh.

    ``name`` denotes all its obstacles together.  ``path`` is relative to the folder of the file on
    the command line, ``text`` is its contents, and ``file`` is its number among the sources.  Only
    a map_server map has an image; ``image_span`` is where its path is written.  Only a mesh has a
    scene; it has no text.
    """

    name: str
    path: str
    kind: Literal["map_server", "geojson", "mesh"]
    text: str = field(repr=False)
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    image: MapImage | None = None
    file: int = field(default=0, compare=False, repr=False)
    image_span: Span = field(default=NOWHERE, compare=False, repr=False)
    scene: Scene | None = None
