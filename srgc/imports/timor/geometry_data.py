"""Read geometry in the format of Timor and CoBRA: the shapes of bodies and obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from srgc.imports.json_place import Place

GeometryKind: TypeAlias = Literal["box", "cylinder", "sphere", "mesh"]
DEEPEST = 8
IDENTITY = np.eye(4).tolist()


@dataclass(frozen=True, slots=True)
class Geometry:
    """A shape with a pose.

    ``size`` is in m: the edges of a box, (radius, length) of a cylinder, (radius,) of a sphere; for
    a mesh it is the scale along x, y and z.  Boxes, cylinders (along z) and spheres are centred.
    """

    kind: GeometryKind
    size: tuple[float, ...]
    pose: NDArray[np.float64]
    file: str
    place: Place


def read_geometries(place: Place, depth: int = 0) -> list[Geometry]:
    """The shapes of a list, or of a single shape outside a list; ``empty`` gives none.

    ``depth`` is the number of composed shapes around it.

    Raises:
        UsageFault: one of them is not a geometry of CoBRA's schema.
    """
    found = list[Geometry]()
    for entry in place.one_or_more():
        kind = entry["type"].text().lower()
        entry.keys(("type", *(("geometries",) if kind == "composed" else ("parameters", "pose"))))
        if kind == "composed":
            if depth == DEEPEST:
                raise entry.fault(f"shapes are composed {DEEPEST} times at most")
            found += read_geometries(entry["geometries"], depth + 1)
        elif kind in get_args(GeometryKind):
            found.append(_read(kind, entry))  # type: ignore[arg-type]
        elif kind != "empty":
            raise entry["type"].fault(
                f"unknown geometry `{kind[:40]}`; known are {', '.join(get_args(GeometryKind))}"
            )
    return found


def _read(kind: GeometryKind, place: Place) -> Geometry:
    pose = place.get("pose", IDENTITY).pose()
    parameters = place["parameters"]
    file, size = "", tuple[float, ...]()
    match kind:
        case "box":
            parameters.keys(("x", "y", "z"))
            size = tuple(_length(parameters, (name,)) for name in "xyz")
        case "cylinder":
            parameters.keys(("r", "z", "radius", "length"))
            size = (_length(parameters, ("r", "radius")), _length(parameters, ("z", "length")))
        case "sphere":
            parameters.keys(("r",))
            size = (_length(parameters, ("r",)),)
        case "mesh":
            parameters.keys(("file", "scale"))
            file, size = parameters["file"].text(), _scale(parameters.get("scale", 1.0))
    return Geometry(kind, size, pose, file, place)


def _length(parameters: Place, names: Sequence[str]) -> float:
    """A positive length under one of the names."""
    name = next((each for each in names if each in parameters), names[0])
    value = parameters[name].number()
    if value <= 0:
        raise parameters[name].fault(f"expected a length above 0, found {value:g}")
    return value


def _scale(place: Place) -> tuple[float, ...]:
    """The scale of a mesh along x, y and z, given as one number or three."""
    if isinstance(place.value, list) and len(place.value) == 3:
        found = place.numbers(3)
    else:
        found = (place.one_or_more()[0].number(),) * 3
    if min(found) <= 0:
        raise place.fault("expected a scale above 0")
    return found
