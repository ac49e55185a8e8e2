"""What the page consists of: sections, claims with what srgc has to them, tables and figures."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from srgc.render.html_text import image, text

_INLINE = re.compile(r"\[([^\]]*)\]\([^)\s]*\)|`([^`]*)`|\*\*([^*]+)\*\*|(?<![\w\\])\*([^*]+)\*")

Answer = Literal["agrees", "differs", "corrected", "not stated", "not confirmed"]
"""How srgc's side of a claim is to the paper's."""


@dataclass(frozen=True)
class Claim:
    """What the paper says somewhere, and what srgc says to it; both are HTML."""

    place: str
    paper: str
    ours: str
    answer: Answer


@dataclass(frozen=True)
class Figure:
    """A picture (SVG), what it shows for those who do not see it, and its caption (HTML).

    One that is ``wide`` keeps a width on small screens, where it can be scrolled.
    """

    svg: str
    says: str
    caption: str
    wide: bool = False


@dataclass(frozen=True)
class Section:
    """A part of the page: the fragment of its address, its title, and its HTML."""

    name: str
    title: str
    content: str


def claims_table(caption: str, claims: Sequence[Claim]) -> str:
    """Claims as a table: where, the paper, srgc, and how they are to each other."""
    rows = [
        (f"<strong>{text(claim.place)}</strong>", claim.paper, claim.ours, _answered(claim.answer))
        for claim in claims
    ]
    return table(caption, ("Place", "The paper", "srgc", "Result"), rows, of="claims")


def _answered(answer: Answer) -> str:
    return f'<span class="answer {answer.replace(" ", "-")}">{answer}</span>'


def table(
    caption: str,
    names: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    of: str = "",
    numbers: Sequence[int] = (),
) -> str:
    """A table with a caption; cells are HTML, the first of a row is its header.

    On narrow screens the cells of a row stand below each other, with the names of their columns;
    the roles say that they are a table there, too.

    Args:
        caption: what it shows; a text.
        names: of the columns; texts.
        rows: the cells.
        of: its class.
        numbers: the columns that are set to the right.
    """
    head = "".join(f'<th role="columnheader" scope="col">{text(name)}</th>' for name in names)
    kinds = ["number" if column in numbers else "" for column in range(len(names))]
    first = f'role="rowheader" scope="row" data-column="{text(names[0])}"'
    body = "".join(
        f'<tr role="row"><th {first}>{row[0]}</th>'
        + "".join(
            f'<td role="cell" data-column="{text(name)}" class="{kind}">{cell}</td>'
            for name, kind, cell in zip(names[1:], kinds[1:], row[1:], strict=True)
        )
        + "</tr>"
        for row in rows
    )
    return (
        f'<table role="table" class="{of}"><caption>{text(caption)}</caption>'
        f'<thead role="rowgroup"><tr role="row">{head}</tr></thead>'
        f'<tbody role="rowgroup">{body}</tbody></table>'
    )


def figure(one: Figure) -> str:
    """A picture as HTML.

    Raises:
        xml.etree.ElementTree.ParseError: it is no SVG.
    """
    ET.fromstring(one.svg)
    picture = image(one.svg, one.says)
    if one.wide:
        scrolled = f'class="scroll" tabindex="0" role="group" aria-label="{text(one.says)}"'
        picture = f"<div {scrolled}>{picture}</div>"
    return f"<figure>{picture}<figcaption>{one.caption}</figcaption></figure>"


def figures_of(some: Sequence[Figure]) -> str:
    """Pictures beside each other, as far as there is room."""
    return f'<div class="figures">{"".join(map(figure, some))}</div>'


def paragraph(content: str) -> str:
    """A paragraph of HTML."""
    return f"<p>{content}</p>"


def word(symbols: Sequence[str]) -> str:
    """A word as the paper writes it: the edge symbol is ε."""
    return f"<code>{text(plain_word(symbols))}</code>"


def plain_word(symbols: Sequence[str]) -> str:
    """The same as a text."""
    return " ".join("ε" if symbol == "eps" else symbol for symbol in symbols)


def number_of(value: float, digits: int) -> str:
    """A number with so many digits behind the point, with a true minus sign."""
    return f"{value:.{digits}f}".replace("-", "\N{MINUS SIGN}")


def inline_html(markdown: str) -> str:
    """A paragraph of Markdown as HTML: code, strong, emphasis, and the words of links."""
    pieces, end = list[str](), 0
    for found in _INLINE.finditer(markdown):
        pieces.append(_unescaped(markdown[end : found.start()]))
        end = found.end()
        link, code, strong, emphasis = found.groups()
        if code is not None:
            pieces.append(f"<code>{text(code)}</code>")
        elif link is not None:
            pieces.append(inline_html(link))
        else:
            name, content = ("strong", strong) if strong is not None else ("em", emphasis)
            pieces.append(f"<{name}>{inline_html(content)}</{name}>")
    return "".join([*pieces, _unescaped(markdown[end:])])


def _unescaped(markdown: str) -> str:
    return text(re.sub(r"\\([\\*_`])", r"\1", markdown))
