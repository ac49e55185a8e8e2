"""Parts of messages: hints for misspelt names, and counted nouns."""

from __future__ import annotations

from collections.abc import Collection
from itertools import islice

from grammar_lang.diagnostics.diagnostic import Sink

MAX_LENGTH = 100
"""Longer names are not taken for misspellings."""

_SHOWN = 6


def nearest(name: str, known: Collection[str], sink: Sink | None = None) -> str | None:
    """The known name most like ``name``, the first of equals; None if none is close.

    Args:
        name: the unknown name.
        known: the names that it may stand for.
        sink: limits the number of comparisons; without it there is no limit.
    """
    if len(name) > MAX_LENGTH or (sink is not None and len(known) > sink.comparisons):
        return None
    if sink is not None:
        sink.comparisons -= len(known)
    names = [candidate for candidate in dict.fromkeys(known) if len(candidate) <= MAX_LENGTH]
    for candidate in names:
        if candidate.lower() == name.lower():
            return candidate
    return _most_similar(name, names)


def _most_similar(name: str, names: list[str]) -> str | None:
    """The best candidate by the Ratcliff-Obershelp ratio, trying its quick upper bounds first."""
    from difflib import SequenceMatcher

    matcher = SequenceMatcher(b=name)
    found, least = None, 0.6 if len(name) > 3 else 0.5
    for candidate in names:
        matcher.set_seq1(candidate)
        if matcher.real_quick_ratio() < least or matcher.quick_ratio() < least:
            continue
        ratio = matcher.ratio()
        if ratio > least or (found is None and ratio == least):
            found, least = candidate, ratio
    return found


def did_you_mean(name: str, known: Collection[str], what: str, sink: Sink) -> str:
    """A hint with the nearest known name, or else a list of the known names."""
    close = nearest(name, known, sink)
    if close is not None:
        return f"did you mean `{close}`?"
    if not known:
        return f"no {what} is declared here"
    names = list(islice(dict.fromkeys(islice(known, 2 * _SHOWN)), _SHOWN + 1))
    shown = ", ".join(f"`{name}`" for name in names[:_SHOWN])
    return f"known: {shown}{', …' if len(names) > _SHOWN else ''}"


def counted(number: int, what: str) -> str:
    """``1 error``, ``2 errors``, ``1,200 errors``."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
