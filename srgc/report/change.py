"""What a design changes of the existing robot of its task, and the robots on the way."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from srgc.render.html_text import many, text
from srgc.report.evidence import Evidence


def change_section(evidence: Evidence) -> str:
    """The section of a design with an existing robot; nothing for others."""
    change = evidence.design.get("reconfiguration")
    if evidence.found is None or change is None:
        return ""
    old, new = change["from"], evidence.found.claim.word
    words = change["configurations"]
    if len(words) == 1:
        said = "<p>No module: this is the existing robot, with other parameters where it may.</p>"
    else:
        steps = "".join(f'<li class="word">{text(" ".join(word))}</li>' for word in words)
        said = (
            f"<p>{_count(evidence, old, new)} The robots on the way, each a word of the grammar:"
            f'</p><ol start="0">{steps}</ol>'
        )
    return f'<section id="change"><h2>What changes of the existing robot</h2>{said}</section>'


def _count(evidence: Evidence, old: Sequence[str], new: Sequence[str]) -> str:
    """Which modules are added and removed, by their places in the new and in the old word."""
    kept = evidence.design["reconfiguration"]["kept"]
    modules = evidence.program.modules
    added = [i for i, name in enumerate(new) if name in modules and i not in {b for _, b in kept}]
    removed = [i for i, name in enumerate(old) if name in modules and i not in {a for a, _ in kept}]
    if not added and not removed:
        return "No module, only edges."
    said = [
        f"{many(len(places), 'module')} {done}{_named(places, word)}"
        for places, word, done in ((added, new, "added"), (removed, old, "removed"))
    ]
    return f"{', '.join(said)}."


def _named(places: Iterable[int], word: Sequence[str]) -> str:
    names = ", ".join(f"<b>{text(word[place])} {place}</b>" for place in places)
    return f" ({names})" if names else ""
