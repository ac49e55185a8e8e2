"""The page: its head, its contents, its sections, and a look for screens and for paper."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from paper.section import Section
from srgc.render.html_text import text

TITLE = "Correct-by-Construction Approach for Self-Evolvable Robots, computed again"
STYLE = Path(__file__).with_name("page.css")
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'"


def page(sections: Sequence[Section], seeds: int, command: str) -> str:
    """The page as HTML, which loads nothing."""
    links = "".join(f'<li><a href="#{one.name}">{text(one.title)}</a></li>' for one in sections)
    parts = "".join(
        f'<section id="{one.name}"><h2>{text(one.title)}</h2>{one.content}</section>'
        for one in sections
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{text(POLICY)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{text(TITLE)}</title>\n<style>\n{STYLE.read_text('utf-8')}</style>\n</head>\n"
        f"<body>\n<header><h1>{text(TITLE)}</h1>"
        "<p>What Gang Chen and Zhaodan Kong show and claim in the paper of that name, beside what "
        "srgc computes on the same example. Numbers of the paper are quoted; everything else on "
        f"this page was computed by <code>{text(command)}</code> with {seeds} seeds, and comes out "
        "the same, byte by byte, when it is run again.</p>"
        f'<nav aria-label="Contents"><ol>{links}</ol></nav></header>\n'
        f"<main>{parts}</main>\n</body>\n</html>\n"
    )
