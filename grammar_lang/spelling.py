"""Hints for misspelt names."""

from __future__ import annotations

from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name most like ``name``, the first of equals; None if none is close."""
    from difflib import get_close_matches

    known = list(dict.fromkeys(known))
    for candidate in known:
        if candidate.lower() == name.lower():
            return candidate
    found = get_close_matches(name, known, n=1, cutoff=0.6 if len(name) > 3 else 0.5)
    return found[0] if found else None


def did_you_mean(name: str, known: Iterable[str], what: str) -> str:
    """A hint: the nearest known name, or else what there is."""
    known = list(dict.fromkeys(known))
    close = nearest(name, known)
    if close is not None:
        return f"did you mean `{close}`?"
    if not known:
        return f"no {what} is declared here"
    shown = ", ".join(f"`{k}`" for k in known[:6])
    return f"known: {shown}{', …' if len(known) > 6 else ''}"
