"""Read the parts of a certificate's JSON; an error says what was expected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields as dataclass_fields
from typing import Any


def expect_keys(fields: Mapping[str, Any], kind: type) -> None:
    """Check that the keys are exactly the fields of a dataclass.

    Raises:
        KeyError: a field is missing or unknown.
    """
    names = {item.name for item in dataclass_fields(kind)}
    for key in sorted(names - fields.keys()):
        raise KeyError(f"the field `{key}` is missing")
    for key in fields:
        if key not in names:
            raise KeyError(f"the field `{key}` is unknown")


def texts(items: object) -> tuple[str, ...]:
    """A list of strings.

    Raises:
        TypeError: the value is something else.
    """
    if not isinstance(items, list) or not all(isinstance(item, str) for item in items):
        raise TypeError("a list of strings is expected")
    return tuple(items)


def number(value: object) -> int:
    """An integer; JSON's true and false do not count as integers.

    Raises:
        TypeError: the value is something else.
    """
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError("a whole number is expected")
    return value


def text(value: object) -> str:
    """A string.

    Raises:
        TypeError: the value is something else.
    """
    if not isinstance(value, str):
        raise TypeError("a string is expected")
    return value


def objects(items: object, kind: type) -> list[dict[str, Any]]:
    """A list of JSON objects with exactly the fields of a dataclass.

    Raises:
        TypeError: the value is something else.
        KeyError: a field is missing or unknown.
    """
    if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
        raise TypeError("a list of objects is expected")
    for item in items:
        expect_keys(item, kind)
    return items


def rows(items: object) -> tuple[tuple[str, ...], ...]:
    """A list of lists of strings.

    Raises:
        TypeError: the value is something else.
    """
    if not isinstance(items, list):
        raise TypeError("a list of lists of strings is expected")
    return tuple(texts(row) for row in items)
