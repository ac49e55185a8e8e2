"""A whole page: a head and sections, styles and scripts, in one file that loads nothing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.resources import files

from srgc.render.html_text import text
from srgc.render.svg import marks_style

POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src data:; base-uri 'none'; form-action 'none'"
)
"""What a browser lets the page do: nothing is loaded, nothing is sent."""


def html_page(title: str, head: str, rest: Sequence[str]) -> str:
    """A page of a head, which has a ``<header>``, and of sections; empty ones are left out."""
    body = _with_contents(head, [section for section in rest if section])
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{text(POLICY)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>{text(title)}</title>\n<style>\n{_assets('.css')}</style>\n</head>\n"
        f"<body>\n<main>{body}</main>\n<script>\n{_assets('.js')}</script>\n</body>\n</html>\n"
    )


_TITLE = re.compile('<section id="([a-z-]+)"[^>]*><h2>(.*?)</h2>', re.DOTALL)


def _with_contents(head: str, rest: Sequence[str]) -> str:
    """All sections, with links to them behind the head of the page."""
    titles = [found.groups() for section in rest for found in _TITLE.finditer(section)]
    links = "".join(f'<li><a href="#{name}">{title}</a></li>' for name, title in titles)
    contents = f'<nav class="screen-only" aria-label="Sections"><ul>{links}</ul></nav></header>'
    return head.replace("</header>", contents, 1) + "".join(rest)


def _assets(ending: str) -> str:
    """All styles or all scripts, in order; the styles of marks come first."""
    folder = files("srgc.report") / "assets"
    found = (each for each in folder.iterdir() if each.name.endswith(ending))
    parts = [each.read_text("utf-8") for each in sorted(found, key=lambda each: each.name)]
    return "".join([marks_style() if ending == ".css" else "", *parts])
