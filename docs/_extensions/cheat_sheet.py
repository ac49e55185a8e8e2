"""The cheat sheet as one printed page: A4, landscape, in two columns; `make pictures` writes it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from fpdf import FPDF

if TYPE_CHECKING:
    from collections.abc import Iterator

DOCS = Path(__file__).parents[1]
PAGE, PRINTED = DOCS / "reference" / "cheat-sheet.md", DOCS / "_static" / "cheat-sheet.pdf"
WIDTH, HEIGHT, MARGIN, GAP = 297.0, 210.0, 8.0, 6.0
"""Of the page and its columns (mm)."""
COLUMN = (WIDTH - 2 * MARGIN - GAP) / 2
POINT = 25.4 / 72
"""Of a length in points (mm)."""
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


@dataclass(frozen=True, slots=True)
class Line:
    """A line of the sheet: ``heading``, ``code``, ``comment`` (behind code) or ``prose``."""

    kind: str
    text: str


def sheet_lines(page: str) -> Iterator[Line]:
    """The headings, specs, sentences and tables of the Markdown page, without its first ones."""
    _, _, body = page.partition("\n## ")
    within = False
    for row in f"## {body}".splitlines():
        if row.startswith("```"):
            within = not within
        elif within:
            yield Line("code", row)
        elif row.startswith("## "):
            yield Line("heading", row[3:])
        elif row and not row.startswith("|---") and not row.startswith("| to "):
            plain = _LINK.sub(r"\1", row).replace("`", "")
            yield Line("prose", "   ".join(cell.strip() for cell in plain.strip("| ").split("|")))


class Sheet(FPDF):
    """Draws lines down two columns; ``size`` is that of code, in points."""

    def __init__(self, size: float) -> None:
        super().__init__("landscape", "mm", "A4")
        self.size = size
        self.set_auto_page_break(auto=False)
        self.set_title("srgc: the language on one page")
        # The same bytes each time, whatever the clock and zlib.
        self.set_creation_date(datetime(2000, 1, 1, tzinfo=UTC))
        self.set_compression(False)
        self.add_page()
        self.column, self.at = 0, MARGIN
        self.fits, self.above = True, ""

    def place(self, height: float) -> tuple[float, float]:
        """Where a line of a height begins."""
        if self.at + height > HEIGHT - MARGIN:
            self.column, self.at = self.column + 1, MARGIN
        self.fits = self.fits and self.column < 2
        found = MARGIN + self.column * (COLUMN + GAP), self.at
        self.at += height
        return found

    def draw(self, line: Line) -> None:
        """Put a line below the one before it; long ones go on in the next."""
        leading = self.size * POINT * 1.12
        if line.kind == "prose" and self.above == "code":
            self.at += 0.35 * leading
        self.above = line.kind
        if line.kind == "heading":
            self.set_font("Helvetica", "B", self.size * 1.35)
            self.set_text_color(20, 60, 120)
            self.at += 0.4 * leading if self.at > MARGIN else 0
            x, y = self.place(1.6 * leading)
            self.text(x, y + 1.2 * leading, line.text)
        elif not line.text:
            self.at += 0.35 * leading
        elif line.kind == "code":
            code, slashes, comment = line.text.partition("//")
            x, y = self.place(leading)
            self.set_font("Courier", "", self.size)
            self.set_text_color(0, 0, 0)
            self.text(x, y + 0.8 * leading, code)
            self.set_text_color(90, 90, 90)
            self.text(x + self.get_string_width(code), y + 0.8 * leading, slashes + comment)
            self.fits = self.fits and self.get_string_width(line.text) <= COLUMN
        else:
            self.set_font("Helvetica", "", self.size)
            self.set_text_color(0, 0, 0)
            parts = self.multi_cell(COLUMN, leading, line.text, dry_run=True, output="LINES")
            for part in parts:
                x, y = self.place(leading)
                self.text(x, y + 0.8 * leading, part)


def sheet(page: str) -> Sheet:
    """The printed page, with the largest letters that it has room for."""
    lines = list(sheet_lines(page))
    for tenths in range(90, 29, -1):
        made = Sheet(tenths / 10)
        for line in lines:
            made.draw(line)
        if made.fits:
            return made
    raise ValueError("the cheat sheet is too long for a page")


if __name__ == "__main__":
    PRINTED.write_bytes(bytes(sheet(PAGE.read_text(encoding="utf-8")).output()))
