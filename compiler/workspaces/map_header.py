"""The YAML file of a map_server map, and the faults of obstacle files."""

from __future__ import annotations

import posixpath
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal, TypeAlias, cast

from compiler.workspaces.decimals import decimal
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import nearest
from grammar_lang.ir import ObstacleMap
from grammar_lang.source import Span

if TYPE_CHECKING:
    from yaml.nodes import MappingNode, Node

# --- The YAML file of a map_server map: image, resolution, pose, thresholds, mode -----------------
#
# Source: the ROS wiki, map_server, sections 1.2 and 1.3 (YAML format, value interpretation).  The
# file is composed to nodes but never constructed, so tags have no effect and every number is read
# from its own text.


Mode: TypeAlias = Literal["trinary", "scale", "raw"]

TEXT_LIMIT = 2**16
"""The most characters of such a file; real files have a few hundred."""
DEPTH_LIMIT = 20
"""The most lists and mappings nested in each other."""
FULL_TURN = Fraction(63, 10)
"""Angles beyond this many radians were probably meant in degrees."""

_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_KNOWN = (*_REQUIRED, "mode")
_HINT = "a map of map_server is a mapping with image, resolution, origin, negate and two thresholds"
_TRUTH = {"0": False, "1": True, "false": False, "true": True, "no": False, "yes": True}
_PLAIN = {
    f"tag:yaml.org,2002:{kind}"
    for kind in ("str", "int", "float", "bool", "null", "timestamp", "merge", "value")
}
"""The tags that a scalar without an explicit tag may resolve to."""


@dataclass(frozen=True, slots=True)
class MapHeader:
    """The fields: metres per pixel, the lower left corner (m), the rotation about it (rad).

    A pixel is occupied if its occupancy is above ``occupied``, and free if it is below ``free``.
    """

    resolution: Fraction
    origin: tuple[Fraction, Fraction]
    yaw: Fraction
    negate: bool
    occupied: Fraction
    free: Fraction
    mode: Mode


def map_header(text: str, path: str, image: str) -> MapHeader:
    """Read the header of a map.

    Args:
        text: the YAML file.
        path: the path of that file.
        image: the path of the file that was read as its image.

    Raises:
        MapFault: the text is not such a file; the fault has its place.
    """
    fields = _fields(_root(text))
    _same_image(fields["image"], path, image)
    resolution = _number(fields["resolution"], "resolution")
    if resolution <= 0:
        raise _at(fields["resolution"], "the resolution is not positive", "write metres per pixel")
    x, y, yaw = _pose(fields["origin"])
    free, occupied = (_threshold(fields[key], key) for key in ("free_thresh", "occupied_thresh"))
    if free > occupied:
        message = "free_thresh is greater than occupied_thresh"
        raise _at(fields["free_thresh"], message, "what is free is less occupied than what is not")
    negate = _TRUTH.get(_text(fields["negate"], "negate").lower())
    if negate is None:
        raise _at(fields["negate"], "negate is neither 0 nor 1", "write `negate: 0`")
    return MapHeader(resolution, (x, y), yaw, negate, occupied, free, _mode(fields))


def _root(text: str) -> MappingNode:
    """The mapping of the file."""
    import yaml

    if len(text) > TEXT_LIMIT:
        message = f"this map has {len(text):,} characters, more than {TEXT_LIMIT:,}"
        raise MapFault(message, _HINT, code=Code.TOO_LARGE)
    try:
        _check_events(yaml.parse(text, Loader=yaml.SafeLoader))
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        at = min(mark.index if mark else 0, max(len(text) - 1, 0))
        said = error.problem or error.context or "it cannot be read"
        raise MapFault(f"this is not YAML: {said}", _HINT, (at, at + 1)) from None
    except (yaml.YAMLError, ValueError, OverflowError):
        raise MapFault("this is not YAML: a character that no YAML has", _HINT) from None
    if not isinstance(root, yaml.MappingNode):
        raise MapFault("this map is not a mapping", _HINT)
    return root


def _check_events(events: Iterable[object]) -> None:
    """Reject aliases and deep nesting, for which the YAML reader takes very long."""
    import yaml

    depth = 0
    for event in events:
        if isinstance(event, yaml.events.AliasEvent):
            raise _at(event, "an alias in a map", "write the value itself")
        depth += isinstance(event, yaml.events.CollectionStartEvent)
        depth -= isinstance(event, yaml.events.CollectionEndEvent)
        if depth > DEPTH_LIMIT:
            raise _at(event, "this map is nested too deeply", _HINT)


def _fields(root: MappingNode) -> Mapping[str, Node]:
    """The values by key; all required keys are present."""
    found: dict[str, Node] = {}
    for key, value in root.value:
        name = _text(key, "a key")
        if name in found:
            raise _at(key, f"a second `{name[:40]}`", "leave one of them out")
        found[name] = value
    for name in _REQUIRED:
        if name not in found:
            close = nearest(name, [key for key in found if key not in _KNOWN])
            hint = _HINT if close is None else f"is it `{close[:40]}`?"
            raise MapFault(f"this map has no `{name}`", hint)
    return found


def _at(node: object, message: str, hint: str) -> MapFault:
    """A fault at a node or an event."""
    start, end = (getattr(node, f"{side}_mark").index for side in ("start", "end"))
    return MapFault(message, hint, (start, max(end, start + 1)))


def _text(node: Node, what: str) -> str:
    """The text of a plain or quoted scalar without an explicit tag."""
    import yaml

    if not isinstance(node, yaml.ScalarNode):
        raise _at(node, f"{what} is not a single value", "write one value")
    if node.tag not in _PLAIN:
        raise _at(node, f"{what} has a tag", "write the value alone")
    return cast(str, node.value)


def _number(node: Node, what: str) -> Fraction:
    value = decimal(_text(node, what))
    if value is None:
        raise _at(node, f"{what} is not a decimal number", "write a number such as 0.05 or 5e-2")
    return value


def _threshold(node: Node, what: str) -> Fraction:
    value = _number(node, what)
    if not 0 <= value <= 1:
        raise _at(node, f"{what} is not between 0 and 1", "it is a probability")
    return value


def _pose(node: Node) -> tuple[Fraction, Fraction, Fraction]:
    import yaml

    if not isinstance(node, yaml.SequenceNode) or len(node.value) != 3:
        raise _at(node, "origin is not a list of three numbers", "write `origin: [x, y, yaw]`")
    x, y, yaw = (_number(entry, "a number of origin") for entry in node.value)
    if abs(yaw) > FULL_TURN:
        raise _at(node.value[2], "the yaw of origin is more than a turn", "it is in radians")
    return x, y, yaw


def _mode(fields: Mapping[str, Node]) -> Mode:
    if "mode" not in fields:
        return "trinary"
    mode = _text(fields["mode"], "mode").lower()
    if mode not in {"trinary", "scale", "raw"}:
        raise _at(fields["mode"], "an unknown mode", "known: trinary, scale, raw")
    return cast(Mode, mode)


def _same_image(node: Node, path: str, image: str) -> None:
    """Check that the image that was read is the one that the file names."""
    named = posixpath.normpath(posixpath.join(posixpath.dirname(path), _text(node, "image")))
    if named != image:
        message = "this is not the image that was read"
        raise _at(node, message, "write its path in one line, without escapes")


# --- A fault of an obstacle file, with its place --------------------------------------------------


class MapFault(Exception):
    """A map that cannot be used.

    ``place`` is the range of the fault in its text, or None for a fault of its image or of a mesh.
    ``message`` is one line, and ``hint`` says what to do about it.
    """

    def __init__(
        self,
        message: str,
        hint: str,
        place: tuple[int, int] | None = (0, 1),
        code: Code = Code.UNREADABLE_REFERENCE,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint
        self.place = place
        self.code = code

    def span(self, found: ObstacleMap) -> Span:
        """The span of the fault, in the text of the map in which it was found."""
        if self.place is None:
            return found.image_span
        return Span(*self.place, found.file)

    def report(self, found: ObstacleMap, sink: Sink) -> None:
        """Report it as an error."""
        at = self.span(found)
        notes = [] if at == found.span else [(found.span, "the map is named here")]
        sink.error(self.code, self.message, at, self.hint, notes)


# --- Faults of the image of a map, and its greatest size ------------------------------------------


PIXEL_LIMIT = 2**26
"""The most pixels of an image."""

_IMAGE_HINT = "save it as PGM, or as PNG of 8 bits in shades of grey"


def image_fault(message: str) -> MapFault:
    """A fault of an image, which has no place in a text."""
    return MapFault(message, _IMAGE_HINT, None)


def check_size(width: int, height: int) -> None:
    """Check the size of an image.

    Args:
        width: pixels in a row.
        height: rows.

    Raises:
        MapFault: it has no pixels, or more than ``PIXEL_LIMIT``.
    """
    if not width or not height:
        raise image_fault("the image has no pixels")
    if width * height > PIXEL_LIMIT:
        message = f"the image has {width * height:,} pixels, more than {PIXEL_LIMIT:,}"
        hint = "cut it to the bounds of the workspace, or use a coarser map"
        raise MapFault(message, hint, None, Code.TOO_LARGE)
