"""Read JSON files of other tools value by value; each fault says where in the file it is."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.source import Source, Span
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.source_files import SourceFiles

MOST_ENTRIES = 20_000
"""Longer lists are rejected: nothing that is imported needs so many entries."""
LARGEST = 1e12
"""The largest absolute value of a finite number in a file, in SI units."""
_DECODER, _BLANKS = json.JSONDecoder(), re.compile(r"[ \t\n\r]*")
_KINDS = {dict: "an object", list: "a list", str: "a text", bool: "true or false"}


class _Repeated(dict[str, Any]):
    """An object with a repeated key."""

    key: str


@dataclass(slots=True)
class Unread:
    """The places in a file that were not read, in their order."""

    places: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Place:
    """A value in a JSON file, with the keys and indices that lead to it."""

    source: Source
    steps: tuple[str | int, ...]
    value: Any
    unread: Unread

    @property
    def path(self) -> str:
        """The steps as one text: ``modules[3].bodies[0].mass``."""
        return "".join(map(_step, self.steps)).removeprefix(".")

    def fault(self, said: str) -> SourceFault:
        """A fault at this place, or at the innermost place in the file that encloses it."""
        message = f"{self.path}: {said}" if self.steps else said
        span = _span(self.source.text, self.steps)
        return SourceFault(Code.FOREIGN_CONTENT, message, self.source, span)

    # --- Values -----------------------------------------------------------------------------------

    def text(self) -> str:
        """The value as a text; a whole number is accepted too, since IDs may be numbers."""
        if isinstance(self.value, bool) or not isinstance(self.value, str | int):
            raise self._wrong("a text")
        return str(self.value)

    def truth(self) -> bool:
        """The value as a truth value; Timor also accepts the texts "true" and "false"."""
        if self.value in ("true", "True", "false", "False"):
            return bool(self.value in ("true", "True"))
        if not isinstance(self.value, bool):
            raise self._wrong("true or false")
        return self.value

    def number(self, *, least: float = -math.inf) -> float:
        """The value as a finite number of at least ``least``."""
        found = self.limit()
        if math.isinf(found):
            raise self.fault("expected a finite number, found Infinity")
        if found < least:
            raise self.fault(f"expected a number of at least {least:g}, found {found:g}")
        return found

    def limit(self) -> float:
        """The value as a number that may be infinite."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self._wrong("a number")
        if self.value != self.value:
            raise self.fault("expected a number, found NaN")
        if abs(self.value) <= LARGEST:
            return float(self.value)
        if not isinstance(self.value, float) or not math.isinf(self.value):
            raise self.fault(f"expected a number of at most {LARGEST:g} in size")
        return self.value

    def numbers(self, count: int, *, least: float = -math.inf) -> tuple[float, ...]:
        """The value as a list of ``count`` finite numbers, each at least ``least``."""
        entries = self.entries()
        if len(entries) != count:
            raise self.fault(f"expected {count} numbers, found {len(entries)}")
        return tuple(entry.number(least=least) for entry in entries)

    def matrix(self, rows: int, columns: int) -> NDArray[np.float64]:
        """The value as an array (rows, columns) of finite numbers."""
        entries = self.entries()
        if len(entries) != rows:
            raise self.fault(f"expected {rows} rows, found {len(entries)}")
        return np.array([entry.numbers(columns) for entry in entries])

    def pose(self) -> NDArray[np.float64]:
        """The value as a homogeneous matrix (4, 4).

        Its rotation has to be orthogonal to 1e-6; it is made orthogonal to rounding.
        """
        matrix = self.matrix(4, 4)
        rotation = matrix[:3, :3]
        if np.abs(matrix[3] - (0, 0, 0, 1)).max() > 1e-9:
            raise self.fault("the last row of a pose is [0, 0, 0, 1]")
        if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rotation) < 0:
            raise self.fault("its upper left part is not a rotation")
        left, _, right = np.linalg.svd(rotation)
        if np.abs(left @ right - rotation).max() > 1e-15:
            matrix[:3, :3] = left @ right
        return matrix

    # --- Parts ------------------------------------------------------------------------------------

    def entries(self, most: int = MOST_ENTRIES) -> Sequence[Place]:
        """The entries of a list; a list with more than ``most`` is rejected."""
        if not isinstance(self.value, list):
            raise self._wrong("a list")
        if len(self.value) > most:
            raise self.fault(f"{len(self.value):,} entries; at most {most:,} are read")
        return [
            Place(self.source, (*self.steps, number), value, self.unread)
            for number, value in enumerate(self.value)
        ]

    def one_or_more(self, most: int = MOST_ENTRIES) -> Sequence[Place]:
        """The entries of a list, or the value itself, as Timor accepts it for a list of one."""
        return self.entries(most) if isinstance(self.value, list) else [self]

    def keys(self, known: Sequence[str]) -> None:
        """Record the keys of an object that are not ``known`` as unread."""
        for key in self._object():
            if key not in known:
                self.unread.places.append(self._of(key, None).path)

    def items(self) -> Iterator[tuple[str, Place]]:
        """The keys and values of an object."""
        for key, value in self._object().items():
            yield key, self._of(key, value)

    def __contains__(self, key: str) -> bool:
        return key in self._object() and self.value[key] is not None

    def __getitem__(self, key: str) -> Place:
        if key not in self._object():
            raise self.fault(f"`{key}` is missing")
        return self._of(key, self.value[key])

    def get(self, key: str, default: Any) -> Place:
        """The value of a key, or ``default`` if the key is missing or null."""
        return self._of(key, self.value[key] if key in self else default)

    def _object(self) -> dict[str, Any]:
        if isinstance(self.value, _Repeated):
            raise self.fault(f"`{self.value.key[:80]}` occurs twice")
        if not isinstance(self.value, dict):
            raise self._wrong("an object")
        return self.value

    def _of(self, key: str, value: Any) -> Place:
        return Place(self.source, (*self.steps, key), value, self.unread)

    def _wrong(self, expected: str) -> SourceFault:
        value = self.value
        found = _KINDS.get(type(value), "nothing" if value is None else "a number")
        if isinstance(value, str):
            found = f"the text {value[:40]!r}"
        return self.fault(f"expected {expected}, found {found}")


def json_file(files: SourceFiles) -> Place:
    """The value of the JSON file that is imported.

    ``Infinity`` and numbers such as 1e500 are accepted, for limits.  NaN is accepted here, and
    rejected when it is read as a number.

    Raises:
        SourceFault: the file cannot be read, is too large, or is not JSON.
    """
    path, content = files.main, files.main_bytes()
    try:
        source = Source(str(path), content.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise file_fault(path, "it is not UTF-8 text") from None
    try:
        value = json.loads(source.text, object_pairs_hook=_object, parse_constant=_constant)
    except json.JSONDecodeError as error:
        message, span = f"this is not JSON: {error.msg}", Span(error.pos, error.pos + 1)
        raise SourceFault(Code.FOREIGN_FILE, message, source, span) from None
    except RecursionError:
        raise file_fault(path, "its values are nested too deeply") from None
    except ValueError:  # Python raises it only for such a number
        raise file_fault(path, "it has a whole number of thousands of digits") from None
    return Place(source, (), value, Unread())


# --- Positions in the text ------------------------------------------------------------------------


def _step(key: str | int) -> str:
    if isinstance(key, int):
        return f"[{key}]"
    return f".{key}" if key.isidentifier() and len(key) <= 80 else f'["{key[:80]}"]'


def _span(text: str, steps: Sequence[str | int]) -> Span:
    """The position of the value at the end of steps, or of the innermost value that is present."""
    start = _after_blanks(text, 0)
    for step in steps:
        inner = next((at for found, at in _children(text, start) if found == step), None)
        if inner is None:
            break
        start = inner
    if text[start : start + 1] in "[{":
        return Span(start, start + 1)
    return Span(start, _DECODER.raw_decode(text, start)[1])


def _children(text: str, start: int) -> Iterator[tuple[str | int, int]]:
    """The keys or indices of the values in an object or list, with their positions."""
    opened = text[start : start + 1]
    at, number = _after_blanks(text, start + 1), 0
    while opened in "[{" and text[at] not in "]}":
        key: str | int = number
        if opened == "{":
            key, at = _DECODER.raw_decode(text, at)
            at = _after_blanks(text, _after_blanks(text, at) + 1)
        yield key, at
        at = _after_blanks(text, _DECODER.raw_decode(text, at)[1])
        at, number = _after_blanks(text, at + (text[at] == ",")), number + 1


def _after_blanks(text: str, at: int) -> int:
    return _BLANKS.match(text, at).end()  # type: ignore[union-attr]  # it matches nothing, too


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) == len(pairs):
        return found
    repeated, seen = _Repeated(found), set[str]()
    for key, _ in pairs:
        if key in seen:
            repeated.key = key
            break
        seen.add(key)
    return repeated


def _constant(name: str) -> float:
    """Keep NaN as a number, so that a fault can say where it is."""
    return float(name)
