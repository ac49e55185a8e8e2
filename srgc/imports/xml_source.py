"""Parse untrusted XML with lxml: no entities, no other documents, bounded depth."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.source import Source, Span
from srgc.imports.source_fault import WHOLE, SourceFault
from srgc.imports.source_warning import SourceWarning

if TYPE_CHECKING:
    from lxml.etree import _Element

Element: TypeAlias = "_Element"

_TAG = re.compile(r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|(?P<start><[^\s/>!?]+)", re.DOTALL)
"""Start tags, and parts whose text may look like one; an attribute value has no `<`."""


@dataclass(frozen=True, slots=True)
class XmlFile:
    """A document: its text, for messages, and its root element."""

    source: Source
    root: Element

    def fault(
        self, element: Element, message: str, hint: str | None = None, attribute: str | None = None
    ) -> SourceFault:
        """A fault at an element of the document, or at one of its attributes."""
        span = self._place(element, attribute)
        return SourceFault(Code.FOREIGN_CONTENT, message, self.source, span, hint)

    def warning(
        self, element: Element, message: str, hint: str | None = None, attribute: str | None = None
    ) -> SourceWarning:
        """A warning at an element of the document, or at one of its attributes."""
        return SourceWarning(message, self.source, self._place(element, attribute), hint)

    def _place(self, element: Element, attribute: str | None) -> Span:
        span, text = self._span(element), self.source.text
        if attribute is None:
            return span
        written = re.compile(rf"(?<=\s){re.escape(attribute)}\s*=\s*(\"[^\"]*\"|'[^']*')")
        place = written.search(text, span.end, max(text.find(">", span.end), span.end))
        return Span(*place.span()) if place else span

    def line(self, element: Element) -> int:
        """The number of the line on which an element begins."""
        return self.source.position(self._span(element).start)[0]

    def lines(self, elements: Sequence[Element]) -> list[int]:
        """The numbers of the lines on which elements begin, in the order of the file."""
        wanted = set(elements)
        starts = (each.start() for each in _TAG.finditer(self.source.text) if each["start"])
        pairs = zip(self.root.iter(), starts, strict=False) if wanted else ()
        return [self.source.position(at)[0] for each, at in pairs if each in wanted]

    def _span(self, element: Element) -> Span:
        """The beginning of the start tag, by counting elements: lxml knows only their lines."""
        number = next(count for count, each in enumerate(self.root.iter()) if each is element)
        starts = (each.span() for each in _TAG.finditer(self.source.text) if each["start"])
        return next((Span(*span) for count, span in enumerate(starts) if count == number), WHOLE)


def xml_file(data: bytes, path: Path | str) -> XmlFile:
    """Parse an XML document; comments and processing instructions are left out.

    Raises:
        SourceFault: the document is not well-formed, or has a document type, whose entities could
            stand for other files or for endless text.
    """
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        said = (error.msg or "not well-formed").partition(", line ")[0].partition(", use ")[0]
        source = Source(str(path), _text(data, "utf-8"))
        span = _offset(source.text, *error.position)
        raise SourceFault(Code.FOREIGN_FILE, f"this is not XML: {said}", source, span) from None
    except ValueError as error:
        source = Source(str(path), "")
        raise SourceFault(Code.FOREIGN_FILE, f"this is not XML: {error}", source) from None
    described = root.getroottree().docinfo
    source = Source(str(path), _text(data, described.encoding or "utf-8"))
    if described.doctype:
        start = max(0, source.text.find("<!DOCTYPE"))
        raise SourceFault(
            Code.FOREIGN_FILE,
            "it declares a document type, whose entities are never expanded",
            source,
            Span(start, start + len("<!DOCTYPE")),
            "remove <!DOCTYPE ...>",
        )
    return XmlFile(source, root)


def _text(data: bytes, encoding: str) -> str:
    try:
        return data.decode(encoding, errors="replace")
    except LookupError:
        return data.decode("utf-8", errors="replace")


def _offset(text: str, line: int, column: int) -> Span:
    """A place that libxml2 reports; it may count bytes, and lines after the last one."""
    lines = text.split("\n")
    number = min(max(line, 1), len(lines))
    start = sum(len(each) + 1 for each in lines[: number - 1])
    at = start + min(max(column - 1, 0), len(lines[number - 1]))
    return Span(at, at + 1)
