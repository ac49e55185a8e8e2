"""The specification with syntax highlighting and numbered lines."""

from __future__ import annotations

from pygments import highlight
from pygments.formatters.html import HtmlFormatter

from grammar_lang import ir
from grammar_lang.source import Source
from srgc.pygments_lexer import SrgLexer
from srgc.render.html_text import text

MOST_CHARACTERS = 40_000
"""The most characters of all files together; the rest is in the folder."""


def line_anchor(file: int, line: int) -> str:
    """The id of a line, counted from 1, of the source with number ``file``."""
    return f"spec{file}-{line}"


def spec_source(program: ir.Program) -> str:
    """All files in the language; maps and images are only named."""
    left, parts = MOST_CHARACTERS, []
    for number, source in enumerate(program.sources):
        if not source.path.endswith(".srg") and number:
            parts.append(f"<p><code>{text(source.path)}</code>: {len(source.data)} bytes</p>")
            continue
        parts.append(_source(number, source, left))
        left = max(0, left - len(source.text))
    return "".join(parts)


def _source(number: int, source: Source, most: int) -> str:
    shown = source.text[:most]
    cut = "" if len(shown) == len(source.text) else "<p>The rest is in the folder.</p>"
    opened = " open" if not number else ""
    formatter = HtmlFormatter(
        cssclass="srg", linespans=f"spec{number}", wrapcode=True, classprefix="p-"
    )
    lexer = SrgLexer(stripnl=False, ensurenl=False)
    coloured = highlight(_allowed(shown), lexer, formatter)
    return (
        f"<details{opened}><summary><code>{text(source.path)}</code></summary>"
        f"{coloured}{cut}</details>"
    )


def _allowed(content: str) -> str:
    """The source without characters that HTML forbids; unlike in ``text()``, nothing is escaped."""
    return "".join(
        c if c in "\n\t" or (c.isprintable() or c == " ") else "\ufffd"
        for c in content.replace("\r\n", "\n")
    )
