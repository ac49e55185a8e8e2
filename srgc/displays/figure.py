"""A picture as an element of its own, whose names cannot meet those of another one."""

from __future__ import annotations

from base64 import b64encode

from srgc.render.html_block import block
from srgc.render.html_text import text


def image(svg: str, says: str) -> str:
    """An SVG picture, with what it says for those who do not see it."""
    data = b64encode(svg.encode()).decode("ascii")
    return f'<img alt="{text(says)}" src="data:image/svg+xml;base64,{data}">'


def figure_html(svg: str, says: str) -> str:
    """A display of a picture alone."""
    return block(image(svg, says))
