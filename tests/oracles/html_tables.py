"""A page of HTML as its tables and pictures, for tests."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from base64 import b64decode
from dataclasses import dataclass, field
from html.parser import HTMLParser


@dataclass
class Table:
    """The cells of a table, row by row, without tags."""

    caption: str = ""
    kind: str = ""
    head: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)


class Page(HTMLParser):
    """What a reader finds on a page: tables, pictures with their texts, addresses."""

    def __init__(self) -> None:
        super().__init__()
        self.tables, self.pictures, self.alts = list[Table](), list[ET.Element](), list[str]()
        self.names, self.links, self.sources = list[str](), list[str](), list[str]()
        self.scopes = list[str | None]()
        self._open: list[str] = []

    @staticmethod
    def of(content: str) -> Page:
        """The page of some HTML."""
        page = Page()
        page.feed(content)
        assert not page._open
        return page

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        known = dict(attrs)
        self.names += [known["id"]] if "id" in known else []
        self.links += [known["href"]] if "href" in known else []
        if tag == "table":
            self.tables.append(Table(kind=known.get("class") or ""))
        elif tag == "tr" and "tbody" in self._open:
            self.tables[-1].rows.append([])
        elif tag in ("th", "td"):
            if tag == "th":
                self.scopes.append(known.get("scope"))
            (self.tables[-1].rows[-1] if "tbody" in self._open else self.tables[-1].head).append("")
        elif tag == "img":
            self.sources.append(known["src"] or "")
            self.alts.append(known["alt"] or "")
            self.pictures.append(ET.fromstring(b64decode(self.sources[-1].split(",", 1)[1])))
        if tag not in ("img", "meta", "br", "!doctype"):
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "caption" in self._open:
            self.tables[-1].caption += data
        elif {"td", "th"} & set(self._open):
            table = self.tables[-1]
            cells = table.rows[-1] if "tbody" in self._open else table.head
            cells[-1] += data
