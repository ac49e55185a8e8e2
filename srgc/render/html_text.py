"""What every part of a page is put together with: escaped text, short numbers, data for scripts."""

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
"""What HTML does not allow, and what turns the direction of writing in a name."""


def text(content: object) -> str:
    """Text for an element or an attribute; what may not stand there is replaced by U+FFFD."""
    return escape(_INVISIBLE.sub("\ufffd", str(content)))


def number(value: float, digits: int = 4) -> str:
    """A number to so many significant digits, without an exponent where that is short."""
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
    """A number with its unit, a middle dot for the product; dimensionless ones stand alone."""
    shown = number(value, digits)
    return shown if unit in ("", "1") else f"{shown} {unit.replace('*', '·')}"


LONGEST_NAME = 24
"""Characters of a name that pictures have room for."""


def name_in_picture(name: str) -> str:
    """A name, its middle left out where it is too long for a picture."""
    if len(name) <= LONGEST_NAME:
        return name
    return f"{name[: LONGEST_NAME - 9]}…{name[-8:]}"


def many(count: int, thing: str) -> str:
    """How many of a thing there are, in words that fit the number."""
    plural = f"{thing}es" if thing.endswith("x") else f"{thing}s"
    return f"{count} {thing if count == 1 else plural}"


def json_script(name: str, data: object) -> str:
    """Data for a script of the page, in an element of that id; nothing in it can end that."""
    content = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        content = content.replace(character, f"\\u{ord(character):04x}")
    return f'<script type="application/json" id="{text(name)}">{content}</script>'


# --- What displays consist of: a frame with its style, tables, pictures, and text in colours ------
#
# Colours are those of the notebook, light or dark. Marks mix theirs with that of the text, which
# keeps a contrast of at least 4.5 (WCAG 2.1, 1.4.3) on either ground.


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
