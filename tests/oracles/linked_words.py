"""The words of a page of the site, in order, with the links to the glossary that they are in.

Nothing is shared with the extension that puts the links: it works on Sphinx's tree with regular
expressions, this on the written HTML, word by word.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple

VOID = {"area", "br", "col", "hr", "img", "input", "link", "meta", "source", "wbr"}
CLOSED = {
    "a", "code", "h1", "h2", "h3", "h4", "h5", "h6", "math", "pre", "script", "style", "svg",
    "thead", "nav", "footer",
}  # fmt: skip
"""Elements in which nothing is linked."""
CLOSED_CLASSES = {"cell_output", "highlight", "rubric", "sig"}
FIELDS = {"field-even", "field-odd"}
"""Of the name of a field (`dt`), in which nothing is linked, and of what it says (`dd`)."""


class Word(NamedTuple):
    """A word or a mark of an article; ``run`` numbers stretches of text without a tag."""

    text: str
    run: int
    free: bool
    target: str


@dataclass
class Article(HTMLParser):
    """The words of an article of the site; ``rows`` are the first cells of rows with a name."""

    file: Path
    words: list[Word] = field(default_factory=list)
    rows: dict[str, str] = field(default_factory=dict)
    misplaced: list[str] = field(default_factory=list)
    _open: list[tuple[str, bool, str]] = field(default_factory=list)
    _row: str = ""
    _run: int = 0

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.file.read_text(encoding="utf-8"))

    def _closed(self) -> bool:
        return any(closed for _, closed, _ in self._open)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element is for."""
        self._run += 1
        given = {key: value or "" for key, value in attrs}
        classes = set(given.get("class", "").split())
        target = given.get("href", "") if "term" in classes and tag == "a" else ""
        if target and self._closed():
            self.misplaced.append(target)
        if tag == "tr" and given.get("id", "").startswith("term-"):
            self._row = given["id"]
        if tag not in VOID:
            closed = tag in CLOSED or bool(classes & CLOSED_CLASSES)
            closed |= tag == "dt" and bool(classes & FIELDS)
            named = tag in {"strong", "em"} and any(t == "field" for t, _, _ in self._open)
            kind = "field" if "field-list" in classes else tag
            self._open.append((kind, closed or named, target))

    def handle_endtag(self, tag: str) -> None:
        """Leave an element, and what was left open in it."""
        self._run += 1
        kinds = ["dl" if kind == "field" else kind for kind, _, _ in self._open]
        if tag in kinds:
            del self._open[len(kinds) - 1 - kinds[::-1].index(tag) :]
        if tag == "td":
            self._row = ""

    def handle_data(self, data: str) -> None:
        """The words of the article itself; those beside it are no part of the page."""
        if self._row:
            self.rows[self._row] = self.rows.get(self._row, "") + data
        if not any(kind == "article" for kind, _, _ in self._open):
            return
        target = next((target for _, _, target in reversed(self._open) if target), "")
        free = not self._closed()
        for text in re.findall(r"[\w-]+|[^\w\s]", data):
            self.words.append(Word(text, self._run, free, target))


def singular(word: str) -> set[str]:
    """What a word may be the plural of, and itself."""
    found = {word}
    if word.endswith("ies"):
        found.add(word.removesuffix("ies") + "y")
    if word.endswith(("ses", "xes", "ches", "shes")):
        found.add(word.removesuffix("es"))
    if word.endswith("s") and len(word) > 2:
        found.add(word.removesuffix("s"))
    return found


def means(words: list[str], term: list[str]) -> bool:
    """Whether words are a term, or its plural: of its last word, or of the one before ``of``.

    The case of letters counts in abbreviations alone.
    """
    if len(words) != len(term):
        return False
    if len(term) == 1 and term[0].isupper():
        return words[0].removesuffix("s") == term[0]
    words = [word.lower() for word in words]
    head = term.index("of") - 1 if "of" in term else len(term) - 1
    return all(
        b in singular(a) if i == head else a == b
        for i, (a, b) in enumerate(zip(words, term, strict=True))
    )
