"""The obstacles of a GeoJSON file: its polygons, as convex pieces.

Source: RFC 7946, sections 3.1 and 4.  Coordinates are metres in the workspace here, whatever
coordinate reference system is named; a third coordinate, the height, is ignored.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from compiler.workspaces.decimals import decimal
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.pieces import Corner, Pieces, Polygon
from compiler.workspaces.polygon_pieces import polygon_pieces
from compiler.workspaces.rings import BadRing, TooTangled
from grammar_lang.diagnostics.diagnostic import Code

Path: TypeAlias = tuple[str | int, ...]

CORNER_LIMIT = 10_000
"""The most positions of a polygon."""
TOTAL_LIMIT = 100_000
"""The most positions of all polygons of a file together."""
_INSIDE = {
    "Feature": "geometry",
    "FeatureCollection": "features",
    "GeometryCollection": "geometries",
}
_FLAT = {"Point", "MultiPoint", "LineString", "MultiLineString"}
_RINGS = (
    "a ring is a list of positions, the last of them the first: [[0, 0], [1, 0], [0, 1], [0, 0]]"
)


class _Number(str):
    """A number kept as text, one object for each: a file may have millions."""

    __slots__ = ()


def geojson_pieces(text: str) -> Pieces:
    """The pieces of all polygons, which may overlap.

    Raises:
        MapFault: a geometry has no interior or is invalid; the fault has its place.
    """
    try:
        root = json.loads(text, parse_float=_Number, parse_int=_Number, object_pairs_hook=_members)
    except (ValueError, RecursionError) as error:
        said = "nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise MapFault(
            f"this JSON cannot be used: {said}", "export the map as GeoJSON, RFC 7946"
        ) from None
    return _Reader(text).pieces(root)


def _members(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"an object with two members `{name[:40]}`")
        found[name] = value
    return found


@dataclass(frozen=True, slots=True)
class _Reader:
    text: str

    def fault(
        self, path: Path, message: str, hint: str, code: Code = Code.UNREADABLE_REFERENCE
    ) -> MapFault:
        return MapFault(message, hint, place_of(self.text, path), code)

    def pieces(self, root: object) -> Pieces:
        found: list[Polygon] = []
        count = total = 0
        for path, rings in self.polygons(root):
            count += 1
            total += sum(len(ring) for ring in rings if isinstance(ring, list))
            if total > TOTAL_LIMIT:
                message = f"the polygons have more than {TOTAL_LIMIT:,} positions"
                raise self.fault((), message, "leave out what is far away", Code.TOO_LARGE)
            found += self.polygon(path, rings)
        return Pieces(tuple(found), f"{count:,} polygon{'' if count == 1 else 's'}")

    def polygons(self, root: object) -> Iterator[tuple[Path, list[Any]]]:
        """The coordinates of all polygons, each with its path."""
        todo: list[tuple[Path, object]] = [((), root)]
        while todo:
            path, value = todo.pop()
            kind = value.get("type") if isinstance(value, dict) else None
            if not isinstance(value, dict) or not isinstance(kind, str):
                hint = "a geometry is an object with `type` and `coordinates`"
                raise self.fault(path, "this is not a GeoJSON object", hint)
            if kind in _INSIDE:
                todo += self._inner(path, value, kind)
            elif kind in {"Polygon", "MultiPolygon"}:
                yield from self._coordinates(path, value, kind)
            else:
                raise self._no_polygon(path, kind)

    def _no_polygon(self, path: Path, kind: str) -> MapFault:
        if kind in _FLAT:
            message = f"a {kind} has no interior, so it is not an obstacle"
            hint = "draw a polygon around it, as wide as is to be avoided, or leave it out"
            return self.fault(path, message, hint)
        hint = "obstacles are of type Polygon or MultiPolygon"
        return self.fault(path, f"`{kind[:40]}` is not a GeoJSON type", hint)

    def _inner(self, path: Path, value: dict[str, Any], kind: str) -> list[tuple[Path, object]]:
        """The contents of a feature or a collection, last first."""
        name = _INSIDE[kind]
        held = value.get(name)
        if kind == "Feature":
            return [] if name in value and held is None else [((*path, name), held)]
        if not isinstance(held, list):
            raise self.fault(path, f"this {kind} has no list `{name}`", f"add `{name}`: []")
        return [((*path, name, number), held[number]) for number in reversed(range(len(held)))]

    def _coordinates(
        self, path: Path, value: dict[str, Any], kind: str
    ) -> Iterator[tuple[Path, list[Any]]]:
        """The polygons of a geometry."""
        held, path = value.get("coordinates"), (*path, "coordinates")
        if not isinstance(held, list):
            raise self.fault(path[:-1], f"this {kind} has no list `coordinates`", _RINGS)
        if kind == "Polygon":
            yield path, held
            return
        for number, rings in enumerate(held):
            if not isinstance(rings, list):
                raise self.fault((*path, number), "this polygon is not a list of rings", _RINGS)
            yield (*path, number), rings

    def polygon(self, path: Path, rings: list[Any]) -> tuple[Polygon, ...]:
        """The pieces of one polygon; empty if it has no rings."""
        found = [self._ring((*path, number), ring) for number, ring in enumerate(rings)]
        count = sum(map(len, found))
        if count > CORNER_LIMIT:
            message = f"this polygon has {count:,} positions, more than {CORNER_LIMIT:,}"
            raise self.fault(path, message, "simplify it, or cut it", Code.TOO_LARGE)
        if not found:
            return ()
        try:
            return polygon_pieces(found)
        except BadRing as bad:
            raise self.fault((*path, bad.ring), bad.message, _RINGS) from None
        except TooTangled:
            message = "this polygon has too many edges side by side"
            raise self.fault(path, message, "simplify it, or cut it", Code.TOO_LARGE) from None

    def _ring(self, path: Path, ring: object) -> list[Corner]:
        if not isinstance(ring, list):
            raise self.fault(path, "this ring is not a list of positions", _RINGS)
        return [self._position((*path, number), place) for number, place in enumerate(ring)]

    def _position(self, path: Path, place: object) -> Corner:
        if not isinstance(place, list) or len(place) < 2:
            raise self.fault(path, "this position is not a list of two numbers", _RINGS)
        x, y = (self._number((*path, axis), place[axis]) for axis in (0, 1))
        return x, y

    def _number(self, path: Path, number: object) -> Fraction:
        value = decimal(number) if isinstance(number, _Number) else None
        if value is None:
            hint = "coordinates are decimal numbers of metres, of at most 300 digits"
            raise self.fault(path, "this coordinate is not a usable number", hint)
        return value


# --- The place of a value in a JSON text that is known to be well formed --------------------------


# Possessive, so that no backtracking state is kept: a string may have millions of characters.
_TOKEN = re.compile(r'[ \t\r\n]*+("[^"\\]*+(?:\\.[^"\\]*+)*+"|[][{},:]|[^][{},:" \t\r\n]++)')


def place_of(text: str, path: Sequence[str | int]) -> tuple[int, int]:
    """The offsets of a value.

    Args:
        text: a JSON text.
        path: the member names and element numbers that lead to it, outermost first; of several
            members with one name, the last one.

    Returns:
        The offsets of the value's first token, or of the first token of the text if there is no
            such
        path.
    """
    place = 0
    for step in path:
        child = _child(text, place, step)
        if child is None:
            place = 0
            break
        place = child
    found = _TOKEN.match(text, place)
    return found.span(1) if found else (0, 1)


def _child(text: str, opening: int, step: str | int) -> int | None:
    """The offset of an element or member of the array or object that begins at an offset."""
    depth, number, named, found = 0, 0, isinstance(step, int), None
    before = ""
    for token in _TOKEN.finditer(text, opening):
        word = token[1]
        if depth == 1:
            if word == ":":
                named = before.startswith('"') and json.loads(before) == step
                continue
            if word not in "]},":
                if isinstance(step, int):
                    if number == step:
                        return token.start(1)
                elif named:
                    found, named = token.start(1), False
        before = word
        depth += (word in "[{") - (word in "]}")
        number += depth == 1 and word == ","
        if not depth:
            break
    return found
