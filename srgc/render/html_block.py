"""What displays consist of: a frame with its style, tables, pictures, and text in colours.

Colours are those of the notebook, light or dark, but for marks of their own.
"""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Iterable, Sequence

from srgc.render.html_text import text

STYLE = (
    "<style>"
    ".srgc{font-family:system-ui,sans-serif;font-size:13px;line-height:1.45;max-width:60rem}"
    ".srgc table{border-collapse:collapse;margin:.4em 0}"
    ".srgc th,.srgc td{text-align:left;padding:.15em .7em;border-bottom:1px solid #8885;"
    "vertical-align:top;white-space:normal}"
    ".srgc th{font-weight:600}.srgc td.n{text-align:right;font-variant-numeric:tabular-nums}"
    ".srgc pre{white-space:pre;overflow-x:auto;background:none;margin:.4em 0;"
    "font:12px/1.4 ui-monospace,monospace;color:inherit}"
    ".srgc code{font:12px ui-monospace,monospace;background:none;color:inherit}"
    ".srgc .good{color:#2e8b57;font-weight:600}.srgc .bad{color:#d1495b;font-weight:600}"
    ".srgc .open{color:#c77d0a;font-weight:600}.srgc .faint{color:#3a8fa8}"
    ".srgc .strong{font-weight:600}.srgc .quiet{opacity:.7}"
    ".srgc .side{display:flex;flex-wrap:wrap;gap:1.5em;align-items:flex-start}"
    ".srgc img{max-width:100%;height:auto}.srgc summary{cursor:pointer}"
    "</style>"
)


def block(*parts: str) -> str:
    """A display of these elements."""
    return f'<div class="srgc">{STYLE}{"".join(parts)}</div>'


def head(title: str, mark: str = "", colour: str = "") -> str:
    """A first line, and a word in a colour before it."""
    word = f'<span class="{colour}">{text(mark)}</span> ' if mark else ""
    return f'<div>{word}<span class="strong">{text(title)}</span></div>'


def lines(*content: str) -> str:
    """Plain lines."""
    return "".join(f"<div>{text(line)}</div>" for line in content)


def table(names: Sequence[str], rows: Iterable[Sequence[str]], numbers: Sequence[int] = ()) -> str:
    """A table of elements; ``numbers`` are the columns that are set to the right.

    Names are plain texts, cells are HTML.
    """
    top = "".join(f"<th>{text(name)}</th>" for name in names)
    body = "".join(
        "<tr>"
        + "".join(
            f'<td class="n">{cell}</td>' if column in numbers else f"<td>{cell}</td>"
            for column, cell in enumerate(row)
        )
        + "</tr>"
        for row in rows
    )
    return f"<table>{f'<tr>{top}</tr>' if any(names) else ''}{body}</table>"


def code(content: object) -> str:
    """A name or a word of the specification."""
    return f"<code>{text(content)}</code>"


def details(summary: str, content: str) -> str:
    """What is opened by a click."""
    return f"<details><summary>{text(summary)}</summary>{content}</details>"


_ESCAPE = re.compile("\033\\[([0-9;]*)m")
_CLASSES = {"1;31": "bad", "1;33": "open", "1;36": "faint", "36": "faint", "1": "strong"}


def coloured(content: str) -> str:
    """A block of text, its escape sequences of colours turned into elements.

    A sequence without a colour of ours ends the colour before it.
    """
    pieces = _ESCAPE.split(content)
    found = [text(pieces[0])]
    for paint, piece in zip(pieces[1::2], pieces[2::2], strict=True):
        name = _CLASSES.get(paint)
        found.append(text(piece) if name is None else f'<span class="{name}">{text(piece)}</span>')
    return f"<pre>{''.join(found)}</pre>"


def image(svg: str, says: str) -> str:
    """An SVG picture, with what it says for those who do not see it."""
    data = b64encode(svg.encode()).decode("ascii")
    return f'<img alt="{text(says)}" src="data:image/svg+xml;base64,{data}">'


def figure_html(svg: str, says: str) -> str:
    """A display of a picture alone."""
    return block(image(svg, says))
