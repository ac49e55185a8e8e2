"""A file with all its includes: the items of every file, in the order of the includes.

Includes are followed with an explicit stack, so they may be nested to any depth.  A file is
identified by its real path.  The second include of a file adds nothing; an include of a file that
is still being read is a cycle.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, NoReturn, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import FileSet, Place, visible
from grammar_lang.files.meshes import SUFFIXES, MeshError, read_mesh, read_visual
from grammar_lang.names.declarations import map_name
from grammar_lang.parsing.parse import parse
from grammar_lang.source import Source, Span, node
from grammar_lang.syntax import Ident
from grammar_lang.syntax import tasks as t

_ENDS = 3
"""The number of files named at either end of a long chain of includes."""


@node
class Inclusion:
    """The items of all files, as if they were in one file.

    ``maps`` and ``meshes`` are keyed by the span of the path that names them.  ``opened`` maps the
    span of the path in an ``include`` to the number of the file, for the first include of each
    file.

    ``complete`` is False if a file could not be read, so that its declarations are unknown.
    """

    file: t.File
    maps: Mapping[Span, ir.ObstacleMap]
    meshes: Mapping[Span, ir.Mesh | ir.VisualFile]
    opened: Mapping[Span, int]
    complete: bool


@node
class _Open:
    """A file whose items are being processed."""

    number: int
    real: str
    items: Iterator[t.Item]


@dataclass(slots=True)
class _Traversal:
    files: FileSet
    items: list[t.Item] = field(default_factory=list[t.Item])
    broken: list[Span] = field(default_factory=list[Span])
    skipped: set[str] = field(default_factory=set[str])
    maps: dict[Span, ir.ObstacleMap] = field(default_factory=dict[Span, ir.ObstacleMap])
    meshes: dict[Span, ir.Mesh | ir.VisualFile] = field(
        default_factory=dict[Span, ir.Mesh | ir.VisualFile]
    )
    opened: dict[Span, int] = field(default_factory=dict[Span, int])
    chain: list[_Open] = field(default_factory=list[_Open])
    depths: dict[str, int] = field(default_factory=dict[str, int])
    numbers: dict[str, int] = field(default_factory=dict[str, int])
    complete: bool = True

    def follow(self, real: str) -> None:
        """Process the main file and all its includes."""
        self._open(0, real)
        while self.chain:
            item = next(self.chain[-1].items, None)
            if item is None:
                del self.depths[self.chain.pop().real]
                continue
            self.items.append(item)
            if isinstance(item, t.Include):
                self._include(item, self.chain[-1].number)
            elif isinstance(item, t.Workspace):
                self._maps(item, self.chain[-1].number)
            elif isinstance(item, s.Semantics):
                for block in item.blocks:
                    self._meshes(block.statements, self.chain[-1].number)
            elif isinstance(item, s.Module):
                self._meshes(item.items, self.chain[-1].number)

    def _open(self, number: int, real: str) -> None:
        self.numbers[real] = number
        if number in self.files.unsound:
            self.complete = False
            return
        file = parse(self.files.sources[number].text, self.files.sink, number)
        self.broken += file.broken
        self.skipped |= file.skipped
        self.depths[real] = len(self.chain)
        self.chain.append(_Open(number, real, iter(file.items)))

    def _include(self, item: t.Include, base: int) -> None:
        place = self.files.place(item.path, base, std=item.std)
        if place is None:
            self.complete = False
        elif place.real in self.depths:
            self._cycle(item, self.depths[place.real], place.path)
        elif place.real in self.numbers:
            self.files.twin(place, self.numbers[place.real])
        else:
            number = self.files.text(place, item.path, (".srg",))
            if number is None:
                self.complete = False
            else:
                self.opened[item.path.span] = number
                self._open(number, place.real)

    def _cycle(self, item: t.Include, first: int, path: str) -> None:
        """Report an include that closes a cycle; ``first`` is the depth of the file it names."""
        names = [self.files.sources[o.number].path for o in self.chain[first:]]
        if len(names) > 2 * _ENDS + 1:
            left_out = len(names) - 2 * _ENDS
            names[_ENDS:-_ENDS] = [f"… {left_out:,} more …"]
        chain = " -> ".join(map(visible, [*names, path]))
        hint = "remove this include, or move what both files need into a third one"
        message = f"a file includes itself: {chain}"
        self.files.sink.error(Code.INCLUDE_CYCLE, message, item.path.span, hint)

    def _maps(self, workspace: t.Workspace, base: int) -> None:
        for item in workspace.items:
            if isinstance(item, t.ObstaclesFrom):
                found = read_map(item.path, base, self.files)
                if found is not None:
                    self.maps[item.path.span] = found

    def _meshes(self, statements: Iterable[object], base: int) -> None:
        for emission in statements:
            if not isinstance(emission, s.Emission):
                continue
            read = read_visual if emission.kind.text == "visual" else read_mesh
            for argument in emission.arguments:
                named = argument.name is not None and argument.name.text == "file"
                if named and isinstance(argument.value, s.Text):
                    found = read(argument.value.ident, base, self.files)
                    if found is not None:
                        self.meshes[argument.value.ident.span] = found


def include_all(files: FileSet, real: str) -> Inclusion:
    """Follow the includes of the first of ``files``, the main file, whose real path is ``real``."""
    traversal = _Traversal(files)
    traversal.follow(real)
    file = t.File(tuple(traversal.items), tuple(traversal.broken), frozenset(traversal.skipped))
    return Inclusion(file, traversal.maps, traversal.meshes, traversal.opened, traversal.complete)


# --------------------------------------------------------------------------------------------------
# Obstacle files that a workspace names: their kind, and a first check of their contents.
#
# A map_server map is a YAML file that names an image, its resolution in metres per pixel and the
# pose of its lower left pixel (https://wiki.ros.org/map_server, section 4).  Polygons are GeoJSON
# (RFC 7946), and bodies are meshes.  The geometry of the files is not interpreted here.


Kind: TypeAlias = Literal["map_server", "geojson", "mesh"]

_KINDS: dict[str, Kind] = {
    ".yaml": "map_server",
    ".yml": "map_server",
    ".geojson": "geojson",
    ".json": "geojson",
    **dict[str, Kind].fromkeys(SUFFIXES, "mesh"),
}
_CONVERTED = (".dae", ".glb", ".scene", ".sdf", ".world")
"""Scenes that `srgc import scene` reads, but the language does not."""
_GEOJSON_TYPES = (
    "FeatureCollection",
    "Feature",
    "Polygon",
    "MultiPolygon",
    "GeometryCollection",
    "Point",
    "MultiPoint",
    "LineString",
    "MultiLineString",
)
_YAML_LINE = re.compile(r"""^(image|resolution|origin)[ \t]*:(?=[ \t\r\n]|$)[ \t]*""", re.MULTILINE)
_YAML_TEXT = re.compile(r"""'((?:[^'\n]|'')*)'|"([^"\n]*)"|([^\s#'"](?:[^\n#]|(?<=\S)#)*)""")


def kind_of(path: str) -> Kind | None:
    """The kind of an obstacle file, by its extension; None if it is unknown."""
    lower = path.lower()
    return next((kind for end, kind in _KINDS.items() if lower.endswith(end)), None)


def read_map(path: Ident, base: int, files: FileSet) -> ir.ObstacleMap | None:
    """Read the obstacle file at a path in the file number ``base``.

    Problems with the path or the file are reported; the result is then None.
    """
    place = files.place(path, base)
    if place is None:
        return None
    kind = kind_of(place.path)
    if kind is None:
        _report_kind(path, place.path, files.sink)
        return None
    if kind == "mesh":
        return _scene(path, place, files)
    number = files.text(place, path, tuple(_KINDS))
    if number is None or number in files.unsound:
        return None
    source = files.sources[number]
    name = map_name(path.text)
    if kind == "geojson":
        if not _is_geojson(source, number, files.sink):
            return None
        return ir.ObstacleMap(name, source.path, kind, source.text, path.span, None, number)
    written = _image_path(source, number, files.sink)
    image = None if written is None else _image(written, number, files)
    if written is None or image is None:
        return None
    at = written.span
    return ir.ObstacleMap(name, source.path, kind, source.text, path.span, image, number, at)


def _report_kind(written: Ident, path: str, sink: Sink) -> None:
    """Report an obstacle file whose extension is not a known one."""
    if path.lower().endswith(_CONVERTED):
        message = "the language reads meshes as STL and OBJ, not files of this type"
        hint = f"`srgc import scene {visible(written.text)}` writes obstacles that it reads"
    else:
        message = "this file extension is not that of a file of obstacles"
        hint = (
            "known: map_server maps (`.yaml`, `.yml`), GeoJSON (`.geojson`, `.json`) "
            "and meshes (`.stl`, `.obj`)"
        )
    sink.error(Code.UNREADABLE_REFERENCE, message, written.span, hint)


# --- Meshes ------------------------------------------------------------------------------------


def _scene(path: Ident, place: Place, files: FileSet) -> ir.ObstacleMap | None:
    """Read the mesh at a path; report it and return None if it is not a mesh."""
    from grammar_lang.files.scenes import scene_of

    data = files.binary(place, path, SUFFIXES)
    if data is None:
        return None
    try:
        scene = scene_of(place.path, data)
    except MeshError as error:
        message, hint = f"this is not a mesh: {error}", "export it again as STL or OBJ, faces alone"
        files.sink.error(Code.UNREADABLE_REFERENCE, message, path.span, hint)
        return None
    name = map_name(path.text)
    return ir.ObstacleMap(
        name, place.path, "mesh", "", path.span, image_span=path.span, scene=scene
    )


# --- GeoJSON -----------------------------------------------------------------------------------


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON value")


def _is_geojson(source: Source, number: int, sink: Sink) -> bool:
    """Whether a text is a JSON object with a GeoJSON type; any fault is reported."""
    import json

    start = Span(0, 1, number)
    hint = "export the map as GeoJSON, RFC 7946"
    try:
        value = json.loads(source.text, parse_constant=_no_constant, parse_int=float)
    except json.JSONDecodeError as error:
        said = f"this is not JSON: {error.msg[:1].lower()}{error.msg[1:]}"
        place = Span(error.pos, error.pos + 1, number)
        sink.error(Code.UNREADABLE_REFERENCE, said, place, hint)
        return False
    except (ValueError, RecursionError) as error:
        said = "nested too deeply" if isinstance(error, RecursionError) else str(error)
        sink.error(Code.UNREADABLE_REFERENCE, f"this is not JSON: {said}", start, hint)
        return False
    kind = value.get("type") if isinstance(value, dict) else None
    if kind in _GEOJSON_TYPES:
        return True
    if isinstance(kind, str):
        close = nearest(kind[:40], _GEOJSON_TYPES)
        hint = hint if close is None else f"did you mean `{close}`?"
    message = "this JSON is not GeoJSON: its `type` is unknown or missing"
    sink.error(Code.UNREADABLE_REFERENCE, message, start, hint)
    return False


# --- map_server --------------------------------------------------------------------------------


def _image_path(source: Source, number: int, sink: Sink) -> Ident | None:
    """The path of the image of a map_server map; None if a line is missing."""
    ends = {line[1]: line.end() for line in reversed([*_YAML_LINE.finditer(source.text)])}
    missing = [key for key in ("image", "resolution", "origin") if key not in ends]
    if missing:
        message = f"this map has no line `{missing[0]}:`"
        hint = "a map of map_server has `image:`, `resolution:` and `origin:`"
        sink.error(Code.UNREADABLE_REFERENCE, message, Span(0, 1, number), hint)
        return None
    return _yaml_text(source.text, ends["image"], number)


def _image(path: Ident, number: int, files: FileSet) -> ir.MapImage | None:
    """Read the image at a path; None if that fails."""
    place = files.place(path, number)
    data = None if place is None else files.binary(place, path, (".pgm", ".png"))
    return None if place is None or data is None else ir.MapImage(place.path, data)


def _yaml_text(text: str, start: int, number: int) -> Ident:
    """The plain or quoted scalar that begins at an offset; an empty name if there is no scalar."""
    found = _YAML_TEXT.match(text, start)
    if found is None:
        return Ident("", Span(start, start + 1, number))
    plain = (found[3] or "").rstrip()
    value = found[1].replace("''", "'") if found[1] is not None else (found[2] or plain)
    end = start + len(plain) if found[3] is not None else found.end()
    return Ident(value, Span(start, end, number))
