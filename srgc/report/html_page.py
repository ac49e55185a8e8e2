"""A page in one file, with a head, sections, styles and scripts; it loads nothing else."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.resources import files

from srgc.render.html_text import text
from srgc.render.svg import marks_style
from srgc.report.word_breaks import with_breaks

POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src data:; base-uri 'none'; form-action 'none'"
)
"""The browser's policy for the page: it may load nothing and send nothing."""


def html_page(title: str, head: str, rest: Sequence[str]) -> str:
    """A page with a head, which contains a ``<header>``, and the sections that are not empty."""
    body = with_breaks(_with_contents(head, [section for section in rest if section]))
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
    """The head with links to all sections, followed by the sections."""
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
