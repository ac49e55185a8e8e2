"""A page of HTML read strictly, with Python's own parser: what it holds, and what it would load."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from typing import Any

VOID = {"meta", "br", "input", "img", "link", "hr", "wbr"}
LOADING = ("src", "href", "xlink:href", "action", "data", "poster", "srcset", "background")
OPTIONAL = {"li", "p", "td", "tr"}


@dataclass
class Element:
    """An element: its name, its attributes, the text in it and in all below it."""

    name: str
    attributes: dict[str, str]
    parent: Element | None = None
    text: str = ""

    def within(self, name: str, value: str) -> bool:
        """Whether it is in an element whose attribute has that value."""
        above: Element | None = self
        while above is not None:
            if above.attributes.get(name) == value:
                return True
            above = above.parent
        return False


@dataclass
class Page(HTMLParser):
    """All elements of a page in order; faults are what is not well-formed."""

    source: str
    elements: list[Element] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()
        self.open: list[Element] = []
        self.feed(self.source)
        self.close()
        self.faults += [f"never closed: {each.name}" for each in self.open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = [name for name, _ in attrs]
        if len(set(names)) < len(names):
            self.faults.append(f"an attribute twice: {tag} {names}")
        element = Element(
            tag, {name: value or "" for name, value in attrs}, self.open[-1] if self.open else None
        )
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open[-1].name != tag:
            self.faults.append(f"</{tag}> closes {self.open[-1].name if self.open else 'nothing'}")
            return
        self.open.pop()

    def handle_data(self, data: str) -> None:
        for element in self.open:
            element.text += data

    def all(self, name: str, **attributes: str) -> list[Element]:
        """The elements of that name; ``data_seek`` stands for the attribute ``data-seek``."""
        wanted = {key.rstrip("_").replace("_", "-"): value for key, value in attributes.items()}
        return [
            each
            for each in self.elements
            if each.name == name
            and all(each.attributes.get(key) == value for key, value in wanted.items())
        ]

    def with_attribute(self, name: str) -> list[Element]:
        return [each for each in self.elements if name in each.attributes]

    def section(self, name: str) -> str:
        """The text of a section, blanks made one."""
        (found,) = self.all("section", id=name)
        return " ".join(found.text.split())

    def data(self, name: str) -> Any:
        """The JSON in a script element."""
        (found,) = self.all("script", id=name)
        return json.loads(found.text)

    @property
    def loaded(self) -> list[str]:
        """What a browser would fetch: all but fragments of the page itself."""
        named = [
            each.attributes[key]
            for each in self.elements
            for key in LOADING
            if key in each.attributes
            and not each.attributes[key].startswith("#")
            and not (each.name == "object" and key == "data")
        ]
        styles = [each.text for each in self.all("style")]
        styles += [each.attributes.get("style", "") for each in self.elements]
        for style in styles:
            named += re.findall(r"url\(\s*['\"]?(?!#)([^)]*)", style)
            named += re.findall(r"@import\s*([^;]*)", style)
        return named

    @property
    def handlers(self) -> list[str]:
        """Attributes that are scripts."""
        return [
            f"{each.name} {key}"
            for each in self.elements
            for key, value in each.attributes.items()
            if key.startswith("on") or value.strip().lower().startswith("javascript:")
        ]

    @property
    def dangling(self) -> list[str]:
        """Links to fragments that are not there."""
        ids = {each.attributes["id"] for each in self.with_attribute("id")}
        links = [each.attributes["href"] for each in self.all("a")]
        return [link for link in links if link.removeprefix("#") not in ids]
