"""A whole page in a frame of a notebook."""

from __future__ import annotations

from html import escape

HEIGHT = 640


def page_frame(page: str) -> str:
    """A frame that holds the page; its scripts run, and can reach nothing outside of it."""
    return (
        f'<iframe title="report" sandbox="allow-scripts" width="100%" height="{HEIGHT}" '
        f'style="border:1px solid #8885;background:#fff" srcdoc="{escape(page)}"></iframe>'
    )
