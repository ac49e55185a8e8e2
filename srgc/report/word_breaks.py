"""Where long names may be broken: between their words, so that phones need not break within one."""

from __future__ import annotations

import re

LONG = 14
"""The fewest characters of a name that may need to be broken."""
_TAG = re.compile(r"(<[^>]*>)")
_KIND = re.compile(r"</?([a-z0-9]+)")
_NAME = re.compile(rf"[A-Za-z_][\w./]{{{LONG - 1},}}")
_BETWEEN = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[_./])(?=\w)")
_AS_IT_IS = {"script", "style", "svg", "pre", "select"}
"""Elements whose text is no running text."""


def with_breaks(markup: str) -> str:
    """HTML with ``<wbr>`` between the words of long names, as in CarbonFibre<wbr>Forearm.

    Elements that are not running text, such as pictures and excerpts of specs, stay as they are.
    """
    found, depth = [], 0
    for number, piece in enumerate(_TAG.split(markup)):
        if number % 2:
            depth += _deeper(piece)
        running = not depth and not number % 2
        found.append(_NAME.sub(_broken, piece) if running else piece)
    return "".join(found)


def _broken(name: re.Match[str]) -> str:
    """A name of several words, in a box that goes to the next line before it is broken."""
    words = _BETWEEN.sub("<wbr>", name[0])
    return words if words == name[0] else f'<span class="long-name">{words}</span>'


def _deeper(tag: str) -> int:
    """How a tag changes the number of enclosing elements whose text stays as it is."""
    kind = _KIND.match(tag)
    if kind is None or kind[1] not in _AS_IT_IS or tag.endswith("/>"):
        return 0
    return -1 if tag.startswith("</") else 1
