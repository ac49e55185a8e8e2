"""Write XML documents line by line; equal content gives equal bytes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import TypeAlias

# --- Printable lines, for comments ----------------------------------------------------------------


def plain_line(text: str) -> str:
    """The text with unprintable characters spelt out."""
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)


# --- XML documents --------------------------------------------------------------------------------


Value: TypeAlias = str | float | Sequence[float]


def attribute_text(value: Value) -> str:
    """The text of an attribute; doubles read back as the same numbers."""
    if isinstance(value, str):
        return value
    if isinstance(value, int | float):
        return repr(float(value))
    return " ".join(repr(float(item)) for item in value)


@dataclass(slots=True)
class XmlLines:
    """An XML document under construction."""

    lines: list[str] = field(default_factory=lambda: ['<?xml version="1.0" encoding="utf-8"?>'])
    open_tags: list[str] = field(default_factory=list[str])

    def _indented(self, text: str) -> None:
        self.lines.append("  " * len(self.open_tags) + text)

    def element(self, tag: str, **attributes: Value) -> None:
        """Add an element without content."""
        self._indented(f"<{tag}{_attributes(attributes)}/>")

    def text(self, tag: str, content: str, **attributes: Value) -> None:
        """Add an element that holds text."""
        self._indented(f"<{tag}{_attributes(attributes)}>{escape(content)}</{tag}>")

    def open(self, tag: str, **attributes: Value) -> None:
        """Add the start of an element."""
        self._indented(f"<{tag}{_attributes(attributes)}>")
        self.open_tags.append(tag)

    def close(self) -> None:
        """Add the end of the element that was opened last."""
        tag = self.open_tags.pop()
        self._indented(f"</{tag}>")

    def comment(self, text: str) -> None:
        """Add a comment of one line; what XML does not allow in it is spelt out."""
        shown = plain_line(text)
        while "--" in shown:
            shown = shown.replace("--", "- -")
        self._indented(f"<!-- {shown} -->")

    def document(self) -> str:
        """The text of the document."""
        return "\n".join(self.lines) + "\n"


def _attributes(attributes: Mapping[str, Value]) -> str:
    """The text of attributes; a name may end in an underscore to avoid a Python keyword."""
    return "".join(
        f' {name.rstrip("_")}="{escape(attribute_text(value))}"'
        for name, value in attributes.items()
    )
