"""Links from the first use of a term on a page to its row of the glossary.

Pages stay plain Markdown. While the site is built, each row of ``reference/glossary.md`` becomes a
target, ``glossary.html#term-cell``, and the first occurrence of each term on every other page
becomes a link to it, outside headings, code and links. Records of decisions have no such links.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from docutils import nodes
from sphinx import addnodes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from sphinx.application import Sphinx

GLOSSARY = "reference/glossary"
RECORDS = "decisions/"
"""Records keep the words of their time."""
UNLINKED = (
    nodes.FixedTextElement,
    nodes.Invisible,
    nodes.field_name,
    nodes.literal,
    nodes.math,
    nodes.raw,
    nodes.reference,
    nodes.rubric,
    nodes.thead,
    nodes.title,
    addnodes.desc_signature,
    addnodes.literal_emphasis,
    addnodes.literal_strong,
    addnodes.pending_xref,
)
"""Where no occurrence is linked: code, formulas, links, headings and heads of tables."""

EVERYDAY = {
    "answer", "ball", "change", "claim", "cut", "defect", "edge", "history", "language",
    "level", "output", "path", "set of a loop", "spread", "terminal",
}  # fmt: skip
"""Terms that pages also use as common words: their occurrences are not linked."""

OTHER_SENSES: Mapping[str, frozenset[str]] = {
    "contributing/add-a-clause": frozenset({"word"}),
    "contributing/add-a-solver": frozenset({"certificate"}),
    "contributing/add-an-evaluator": frozenset({"module"}),
    "contributing/add-an-export": frozenset({"word"}),
    "explanation/guarantees": frozenset({"formula"}),
    "how-to/editors": frozenset({"port", "structural reconfiguration grammar (SRG)"}),
    "how-to/export": frozenset({"attribute"}),
    "how-to/kit": frozenset({"mounting", "tube"}),
    "how-to/objectives": frozenset({"tube"}),
    "how-to/view": frozenset({"port"}),
    "how-to/words": frozenset({"conflict"}),
    "reference/benchmark-method": frozenset({"conflict"}),
    "reference/codes": frozenset({"tube"}),
    "reference/examples": frozenset({"tube"}),
    "reference/language": frozenset({"tube"}),
    "reference/library": frozenset({"mounting", "tube"}),
}
"""Pages whose first use of a term means something else: a TCP port, a tube of steel."""

IDIOMS = ("in words", "in other words", "python module", "same words")
"""Phrases that contain a term without meaning it."""


class Term(NamedTuple):
    """A term with the forms in which pages write it, its target and its definition."""

    forms: tuple[str, ...]
    target: str
    definition: str


def plural(term: str) -> str:
    """The plural of a term: of its head, which stands before ``of``, else of its last word."""
    head, of, rest = term.partition(" of ")
    if head.endswith("y") and head[-2] not in "aeou":
        head = f"{head[:-1]}ies"
    else:
        head += "es" if head.endswith(("s", "x", "ch", "sh")) else "s"
    return head + of + rest


def target_of(term: str) -> str:
    """The fragment of a term: letters and digits, joined by hyphens."""
    return "term-" + re.sub(r"[^a-z0-9]+", "-", term.lower()).strip("-")


def terms(glossary: str) -> Iterator[Term]:
    """The terms of the glossary's table; one in brackets behind a term is its abbreviation.

    A term that occurs twice, for different things, and one of everyday language have no forms.
    """
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in glossary.splitlines()
        if line.startswith("|")
    ][2:]
    for name, definition, *_ in rows:
        found = re.fullmatch(r"(.+?) \((.+)\)", name)
        forms = [found[1]] if found else [name]
        if found and found[2].isupper():
            forms.append(found[2])
        if (found and len(forms) == 1) or name in EVERYDAY:
            forms = []
        shown = re.sub(r"[`*]|\[([^]]*)\]\([^)]*\)", r"\1", definition)
        yield Term((*forms, *map(plural, forms)), target_of(name), shown)


class Linker:
    """Links the first occurrence of each term in a document."""

    def __init__(self, found: Iterable[Term]) -> None:
        self.terms = {_key(form): term for term in found for form in term.forms}
        longest_first = sorted((*self.terms, *IDIOMS), key=len, reverse=True)
        forms = "|".join(re.escape(form).replace(r"\ ", r"\s+") for form in longest_first)
        self.pattern = re.compile(rf"(?<![\w-])(?:{forms})(?![\w-])", re.IGNORECASE)

    def link(self, document: nodes.document, address: str, left_out: Iterable[str]) -> None:
        """Put links into a document, but not for the terms that are left out.

        ``address`` is that of the glossary's page.
        """
        seen = set(map(target_of, left_out))
        for element in list(document.findall(nodes.TextElement)):
            _join(element)
        for text in list(document.findall(nodes.Text)):
            if not _inside(text, UNLINKED):
                parts = list(self._parts(text.astext(), address, seen))
                if len(parts) > 1 or not isinstance(parts[0], nodes.Text):
                    text.parent.replace(text, parts)

    def _parts(self, text: str, address: str, seen: set[str]) -> Iterator[nodes.Node]:
        end = 0
        for found in self.pattern.finditer(text):
            term = self.terms.get(_key(" ".join(found[0].split())))
            if term is None or term.target in seen:
                continue
            seen.add(term.target)
            if found.start() > end:
                yield nodes.Text(text[end : found.start()])
            place = f"{address}#{term.target}"
            yield nodes.reference(
                "", found[0], internal=True, refuri=place, reftitle=term.definition,
                classes=["term"],
            )  # fmt: skip
            end = found.end()
        if end < len(text) or not end:
            yield nodes.Text(text[end:])


def _join(element: nodes.TextElement) -> None:
    """Join texts that follow each other: MyST makes three of two lines."""
    for one in range(len(element) - 1, 0, -1):
        before, after = element[one - 1], element[one]
        if isinstance(before, nodes.Text) and isinstance(after, nodes.Text):
            element[one - 1 : one + 1] = [nodes.Text(before + after)]


def _key(form: str) -> str:
    """A form without its case, but for abbreviations: ``SRG`` is a term, and ``.srg`` is none."""
    return form if form.removesuffix("s").isupper() else form.casefold()


def _inside(node: nodes.Node, kinds: tuple[type[nodes.Node], ...]) -> bool:
    parent: nodes.Node | None = node
    while (parent := parent.parent if parent else None) is not None:
        if isinstance(parent, kinds):
            return True
    return False


def name_rows(app: Sphinx, document: nodes.document) -> None:
    """Make each row of the glossary a target; pages are read again when the glossary changes."""
    app.env.note_dependency(app.env.doc2path(GLOSSARY))
    if app.env.docname == GLOSSARY:
        for body in document.findall(nodes.tbody):
            for row in body.findall(nodes.row):
                row["ids"].append(target_of(row.children[0].astext()))


def link_page(app: Sphinx, document: nodes.document, name: str) -> None:
    """Put links into a page that is neither the glossary nor a record of a decision."""
    if app.builder.format == "html" and name != GLOSSARY and not name.startswith(RECORDS):
        text = Path(app.srcdir, f"{GLOSSARY}.md").read_text(encoding="utf-8")
        address = app.builder.get_relative_uri(name, GLOSSARY)
        Linker(terms(text)).link(document, address, OTHER_SENSES.get(name, ()))


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to pages that are read, and to pages that are about to be written."""
    app.connect("doctree-read", name_rows)
    app.connect("doctree-resolved", link_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
