"""Text with the colours of a terminal as HTML."""

from __future__ import annotations

import re

from srgc.render.html_text import text

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
