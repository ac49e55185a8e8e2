"""Files of obstacles: maps in the plane, and meshes."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from grammar_lang.ir.expressions import NOWHERE, Expr, World
from grammar_lang.source import Span, node


@node
class MapImage:
    """The image that a map_server YAML names; ``path`` as that of the map."""

    path: str
    data: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An object of a mesh, which stands for the convex hull of its corners.

    ``corners`` are distinct, in the unit of the mesh; ``faces`` are triangles of their numbers.
    ``label`` is what messages call it.
    """

    label: str
    corners: tuple[tuple[Fraction, ...], ...]
    faces: tuple[tuple[int, int, int], ...]


@node
class Scene:
    """The objects of the mesh with a ``digest``, its unit of ``scale`` metres, in a frame.

    The frame is closed; it leads from the world to the axes of the file.
    """

    digest: str
    objects: tuple[SceneObject, ...] = field(compare=False, repr=False)
    scale: Fraction = Fraction(1)
    frame: Expr = World()
    dimension: Literal[2, 3] = 3


@node
class ObstacleMap:
    """A file of obstacles: a map_server image with its YAML, polygons as GeoJSON, or a mesh.

    ``name`` stands for all its obstacles together.  ``path`` is relative to the folder of the file
    on the command line, ``text`` what it holds, ``file`` its number among the sources.  Only a
    map_server map has an image; ``image_span`` is where its path stands.  Only a mesh, which has
    no text, has a scene.
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
