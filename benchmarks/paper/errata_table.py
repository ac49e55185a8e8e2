"""The errata as a table, read from their page: what is written there is written once."""

from __future__ import annotations

import re
from dataclasses import dataclass

from timing import ROOT

from paper.section import Section, inline_html, paragraph, table
from srgc.render.html_text import many, text

PAGE = ROOT / "docs" / "explanation" / "errata.md"
_SECTION = re.compile(r"^## (4\.\d+) (.+)$", re.MULTILINE)
NAMES = ("The paper.", "The problem.", "srgc", "Shown by")
"""The parts of a correction, in order."""
_PART = re.compile(rf"^\*\*({'|'.join(map(re.escape, NAMES))})\*\*", re.MULTILINE)
_PLACE = re.compile(r"\*([^*]+)\.\* ")


@dataclass(frozen=True)
class Erratum:
    """A correction: its number, what it is about, the place in the paper, three parts in Markdown.

    ``tests`` is how many tests show it.
    """

    number: str
    title: str
    place: str
    paper: str
    case: str
    ours: str
    tests: int


def errata(page: str) -> list[Erratum]:
    """The corrections of the page, in order.

    Raises:
        ValueError: one of them has not the four parts that each has.
    """
    _, *found = _SECTION.split(page)
    return [
        _erratum(number, title, content)
        for number, title, content in zip(found[::3], found[1::3], found[2::3], strict=True)
    ]


def _erratum(number: str, title: str, content: str) -> Erratum:
    # A heading without a number ends the last of them.
    _, *found = _PART.split(content.partition("\n## ")[0])
    parts = dict(zip(found[::2], (" ".join(part.split()) for part in found[1::2]), strict=True))
    place = _PLACE.match(parts.get(NAMES[0], ""))
    if tuple(parts) != NAMES or place is None:
        raise ValueError(f"{number} {title}: {', '.join(NAMES)} are due, and the place first")
    paper, case, ours, shown = parts.values()
    said = paper[place.end() :]
    return Erratum(number, title, place[1], said, case, f"srgc {ours}", shown.count("::"))


def errata_section(page: str) -> Section:
    """The table of all corrections."""
    rows = [
        (
            f"<strong>{each.number}</strong> {inline_html(each.title)}",
            text(each.place),
            inline_html(each.paper),
            inline_html(each.case),
            f"{inline_html(each.ours)} <small>Shown by {many(each.tests, 'test')}.</small>",
        )
        for each in errata(page)
    ]
    names = ("Number", "Place", "The paper", "The problem", "What srgc does")
    intro = (
        "Numbers are those of <code>docs/explanation/errata.md</code>, from which this table is "
        "made. Each counterexample is computed by a test of the suite."
    )
    caption = f"The {len(rows)} corrections"
    return Section("errata", "Errata", paragraph(intro) + table(caption, names, rows))
