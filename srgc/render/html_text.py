"""Building blocks of HTML pages: escaped text, short numbers, data for scripts, displays."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from math import isfinite

_INVISIBLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff\u202a-\u202e\u2066-\u2069]"
)
"""Characters that HTML does not allow, and those that change the direction of writing."""


def text(content: object) -> str:
    """Escape text for an element or an attribute; forbidden characters become U+FFFD."""
    return escape(_INVISIBLE.sub("\ufffd", str(content)))


def number(value: float, digits: int = 4) -> str:
    """A number to ``digits`` significant digits, without an exponent if it stays short."""
    if not isfinite(value):
        return "∞" if value > 0 else "-∞" if value < 0 else "none"
    short = f"{value:.{digits}g}"
    if "e" in short and 1e-6 <= abs(value) < 1e9:
        short = f"{float(short):.12f}".rstrip("0").rstrip(".")
    mantissa, mark, exponent = short.partition("e")
    if mark:
        return f"{mantissa}e{int(exponent)}"
    return "0" if short == "-0" else short


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """A number with its unit, spelled as in a spec; dimensionless ones have none."""
    shown = number(value, digits)
    return shown if unit in ("", "1") else f"{shown} {unit}"


LONGEST_NAME = 24
"""The most characters of a name in a picture."""


def name_in_picture(name: str) -> str:
    """A name; the middle of one that is too long for a picture is replaced by an ellipsis."""
    if len(name) <= LONGEST_NAME:
        return name
    return f"{name[: LONGEST_NAME - 9]}…{name[-8:]}"


def many(count: int, thing: str) -> str:
    """A count with its noun in the singular or plural."""
    plural = f"{thing}es" if thing.endswith("x") else f"{thing}s"
    return f"{count} {thing if count == 1 else plural}"


def json_script(name: str, data: object) -> str:
    """Data for a script of the page, in an element with that id; no data can close the element."""
    content = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        content = content.replace(character, f"\\u{ord(character):04x}")
    return f'<script type="application/json" id="{text(name)}">{content}</script>'


# --- Displays: a frame with its style, tables, pictures, and coloured text ------------------------
#
# Colours suit light and dark notebooks. Coloured words mix their colour with that of the text,
# which keeps a contrast of at least 4.5 (WCAG 2.1, 1.4.3) on either background.


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
    ".srgc .good{color:color-mix(in srgb,#2e8b57 65%,currentColor);font-weight:600}"
    ".srgc .bad{color:color-mix(in srgb,#d1495b 65%,currentColor);font-weight:600}"
    ".srgc .open{color:color-mix(in srgb,#c77d0a 65%,currentColor);font-weight:600}"
    ".srgc .faint{color:color-mix(in srgb,#3a8fa8 65%,currentColor)}"
    ".srgc .strong{font-weight:600}.srgc .quiet{opacity:.7}"
    ".srgc .side{display:flex;flex-wrap:wrap;gap:1.5em;align-items:flex-start}"
    ".srgc img{max-width:100%;height:auto}.srgc summary{cursor:pointer}"
    "</style>"
)


def block(*parts: str) -> str:
    """A display of the given elements."""
    return f'<div class="srgc">{STYLE}{"".join(parts)}</div>'


def head(title: str, mark: str = "", colour: str = "") -> str:
    """A first line, after a coloured word."""
    word = f'<span class="{colour}">{text(mark)}</span> ' if mark else ""
    return f'<div>{word}<span class="strong">{text(title)}</span></div>'


def lines(*content: str) -> str:
    """Plain lines of text."""
    return "".join(f"<div>{text(line)}</div>" for line in content)


def table(names: Sequence[str], rows: Iterable[Sequence[str]], numbers: Sequence[int] = ()) -> str:
    """A table; ``numbers`` are the columns that are aligned right.

    Names are plain text, cells are HTML.
    """
    top = "".join(f"<th>{text(name)}</th>" if name else "<td></td>" for name in names)
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
    """A name or a word of the specification, as code."""
    return f"<code>{text(content)}</code>"


def with_code(sentence: str) -> str:
    """A sentence in HTML; its parts in backquotes become code."""
    parts = sentence.split("`")
    return "".join(code(part) if i % 2 else text(part) for i, part in enumerate(parts))


def details(summary: str, content: str) -> str:
    """Content that a click on the summary opens."""
    return f"<details><summary>{text(summary)}</summary>{content}</details>"


_ESCAPE = re.compile("\033\\[([0-9;]*)m")
_CLASSES = {"1;31": "bad", "1;33": "open", "1;36": "faint", "36": "faint", "1": "strong"}


def coloured(content: str) -> str:
    """A block of text, with its colour escape sequences turned into elements.

    A sequence without a known colour ends the preceding colour.
    """
    pieces = _ESCAPE.split(content)
    found = [text(pieces[0])]
    for paint, piece in zip(pieces[1::2], pieces[2::2], strict=True):
        name = _CLASSES.get(paint)
        found.append(text(piece) if name is None else f'<span class="{name}">{text(piece)}</span>')
    return f"<pre>{''.join(found)}</pre>"


def image(svg: str, says: str) -> str:
    """An SVG picture, with alternative text."""
    data = b64encode(svg.encode()).decode("ascii")
    return f'<img alt="{text(says)}" src="data:image/svg+xml;base64,{data}">'


def figure_html(svg: str, says: str) -> str:
    """A display of one picture."""
    return block(image(svg, says))
