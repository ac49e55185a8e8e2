"""For a task without a design: the motion that came nearest to one, and where it is stuck."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

from solvers.verifier.claims.spec_copy import bounded_bytes
from srgc.render.html_text import number, text, with_code
from srgc.report.evidence import Evidence
from srgc.results.folder_writer import NEAREST_PICTURE


def nearest_section(evidence: Evidence) -> str:
    """What the nearest motion lacks; with its picture if the page does not show the motion."""
    nearest = evidence.design.get("nearest")
    if evidence.found is not None or not isinstance(nearest, dict):
        return ""
    return (
        f'<section id="nearest"><h2>What the nearest motion lacks</h2>{_says(nearest)}'
        f"{''.join(_picture(evidence))}</section>"
    )


def _says(nearest: Mapping[str, Any]) -> str:
    """The robot of the motion, and what the motion lacks."""
    word = nearest.get("word")
    robot = " ".join(map(str, word)) if isinstance(word, list) else ""
    cause, reason = (with_code(str(nearest.get(name, ""))) for name in ("cause", "reason"))
    parts = [f'<p><span class="word">{text(robot)}</span>: {cause}{_stuck(nearest.get("stuck"))}.']
    if reason:
        parts.append(f' <span class="soft">{reason.removesuffix(".")}.</span>')
    parts.append(" Nothing of this motion is proved.</p>")
    return "".join(parts)


def _stuck(stuck: Any) -> str:
    """The time and the position at which it is stuck."""
    with suppress(TypeError, KeyError, ValueError):
        place = ", ".join(number(float(value)) for value in stuck["position"])
        return f"; it is stuck at {number(float(stuck['time']))} s at ({place}) m"
    return ""


def _picture(evidence: Evidence) -> Iterator[str]:
    if evidence.nearest is not None:
        return
    with suppress(OSError):
        picture = b64encode(bounded_bytes(evidence.folder / NEAREST_PICTURE)).decode()
        yield f'<img alt="the nearest motion" src="data:image/svg+xml;base64,{picture}">'
