"""On which module each module of a word stands, told from the word and its brackets alone."""

from __future__ import annotations

from collections.abc import Container, Sequence

BRACKETS = {"(": ")", "[": "]", "{": "}", "<": ">"}
OPENING = {closing: opening for opening, closing in BRACKETS.items()}


def word_neighbours(
    word: Sequence[str], modules: Container[str], bases: Container[str]
) -> dict[int, int | None]:
    """The module that each module stands on, by place in the word; None where there is none.

    A module stands on the one before it at its level.  An opening bracket begins a level that
    starts at the module before it, the closing one goes back to that; brackets that do not
    balance are ignored.  A base stands on nothing.
    """
    partners = bracket_partners(word)
    balanced = len(partners) == sum(symbol in BRACKETS or symbol in OPENING for symbol in word)
    found: dict[int, int | None] = {}
    outer: list[int | None] = []
    below: int | None = None
    for place, symbol in enumerate(word):
        if symbol in modules:
            found[place] = None if symbol in bases else below
            below = place
        elif balanced and symbol in BRACKETS:
            outer.append(below)
        elif balanced and symbol in OPENING:
            below = outer.pop()
    return found


def bracket_partners(word: Sequence[str]) -> dict[int, int]:
    """The bracket that each bracket belongs to, by place; nothing for those without a partner."""
    partners: dict[int, int] = {}
    opened: list[int] = []
    for place, symbol in enumerate(word):
        if symbol in BRACKETS:
            opened.append(place)
        elif symbol in OPENING and opened and word[opened[-1]] == OPENING[symbol]:
            partners[place] = opened.pop()
            partners[partners[place]] = place
    return partners


def bracket_levels(symbols: Sequence[str]) -> tuple[tuple[int, ...], ...]:
    """Per symbol the places of the brackets around it; all empty where they do not balance."""
    partners = bracket_partners(symbols)
    if any(i not in partners for i, s in enumerate(symbols) if s in BRACKETS or s in OPENING):
        return ((),) * len(symbols)
    found: list[tuple[int, ...]] = []
    level: tuple[int, ...] = ()
    for place, symbol in enumerate(symbols):
        level = level[:-1] if symbol in OPENING else level
        found.append(level)
        level = (*level, place) if symbol in BRACKETS else level
    return tuple(found)
