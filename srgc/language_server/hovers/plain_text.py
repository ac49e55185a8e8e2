"""The text of a hover for clients that show no Markdown."""

from __future__ import annotations

import re

_FENCE = re.compile(r"^```\w*\n(.*?)^```$\n?", re.MULTILINE | re.DOTALL)
_MARKED = re.compile(r"`([^`\n]+)`|\*\*(.+?)\*\*")


def plain_text(markdown: str) -> str:
    """Markdown as our hovers have it, without its marks: fences, code and bold.

    What is inside of a fence stays as it is.
    """
    outside_and_fenced = _FENCE.split(markdown)
    return "".join(
        part if index % 2 else _unmarked(part) for index, part in enumerate(outside_and_fenced)
    )


def _unmarked(text: str) -> str:
    return _MARKED.sub(lambda found: found[1] or _unmarked(found[2]), text)
