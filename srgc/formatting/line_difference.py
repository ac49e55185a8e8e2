"""The difference of two texts that differ in blanks only, as a unified diff, in linear time.

Where as many other characters come before the end of a line in both texts, the lines belong
together; no search for a longest common subsequence is needed.
Source: the unified format of GNU diffutils, section "Detailed Description of Unified Format".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

CONTEXT = 3

_BYTE_ORDER_MARK = "\ufeff"
_COLOURS = {"-": "\033[31m", "+": "\033[32m", "@": "\033[36m"}
_BOLD, _RESET = "\033[1m", "\033[0m"


class Change(NamedTuple):
    """Lines ``start <= i < stop`` of the one text and those of the other that replace them."""

    start: int
    stop: int
    other_start: int
    other_stop: int


def _lines(text: str) -> list[str]:
    """Lines with their ends; only a line feed ends a line."""
    *lines, rest = text.split("\n")
    return [f"{line}\n" for line in lines] + ([rest] if rest else [])


def _ends(lines: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Per line that is not blank: the characters up to its end but for blanks, and its number."""
    count = 0
    for number, line in enumerate(lines, start=1):
        inked = sum(map(len, line.replace(_BYTE_ORDER_MARK, "").split()))
        if inked:
            count += inked
            yield count, number


def _cuts(before: Sequence[str], after: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Where both texts can be cut between lines."""
    ends, others = list(_ends(before)), list(_ends(after))
    here = there = 0
    while here < len(ends) and there < len(others):
        if ends[here][0] == others[there][0]:
            yield ends[here][1], others[there][1]
        move, step = ends[here][0] <= others[there][0], ends[here][0] >= others[there][0]
        here, there = here + move, there + step
    yield len(before), len(after)


def _differences(before: Sequence[str], after: Sequence[str]) -> Iterator[Change]:
    """What differs between cuts, without the lines that are the same at its ends."""
    start = other_start = 0
    for end, other_end in _cuts(before, after):
        old, new = before[start:end], after[other_start:other_end]
        most = min(len(old), len(new))
        head = next((i for i in range(most) if old[i] != new[i]), most)
        most -= head
        tail = next((i for i in range(most) if old[-1 - i] != new[-1 - i]), most)
        if head + tail < max(len(old), len(new)):
            yield Change(start + head, end - tail, other_start + head, other_end - tail)
        start, other_start = end, other_end


def changes(before: Sequence[str], after: Sequence[str]) -> Iterator[Change]:
    """What differs, in order; between two changes are lines that are the same in both."""
    found: Change | None = None
    for change in _differences(before, after):
        if found is not None and change.start == found.stop:
            found = Change(found.start, change.stop, found.other_start, change.other_stop)
        else:
            if found is not None:
                yield found
            found = change
    if found is not None:
        yield found


def _hunks(found: Iterator[Change]) -> Iterator[list[Change]]:
    """Changes whose contexts touch, together."""
    hunk: list[Change] = []
    for change in found:
        if hunk and change.start - hunk[-1].stop > 2 * CONTEXT:
            yield hunk
            hunk = []
        hunk.append(change)
    if hunk:
        yield hunk


def _range(start: int, stop: int) -> str:
    if stop - start == 1:
        return f"{start + 1}"
    return f"{start + (stop > start)},{stop - start}"


def _hunk(hunk: Sequence[Change], before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    lead = min(CONTEXT, hunk[0].start)
    tail = min(CONTEXT, len(before) - hunk[-1].stop)
    here, end = hunk[0].start - lead, hunk[-1].stop + tail
    there, other_end = hunk[0].other_start - lead, hunk[-1].other_stop + tail
    yield f"@@ -{_range(here, end)} +{_range(there, other_end)} @@\n"
    for change in hunk:
        yield from (f" {line}" for line in before[here : change.start])
        yield from (f"-{line}" for line in before[change.start : change.stop])
        yield from (f"+{line}" for line in after[change.other_start : change.other_stop])
        here = change.stop
    yield from (f" {line}" for line in before[here:end])


def _shown(line: str, *, colour: bool) -> str:
    body, end = (
        (line[:-1], "\n") if line.endswith("\n") else (line, "\n\\ No newline at end of file\n")
    )
    paint = _COLOURS.get(line[0]) if colour else None
    return f"{body}{end}" if paint is None else f"{paint}{body}{_RESET}{end}"


def unified(before: str, after: str, name: str, *, colour: bool = False) -> str:
    """The unified diff of two texts that differ in blanks only; empty where they do not differ.

    Args:
        before: the text.
        after: what becomes of it.
        name: what the file is called.
        colour: whether for a terminal with colours.
    """
    old, new = _lines(before), _lines(after)
    parts: list[str] = []
    for hunk in _hunks(changes(old, new)):
        parts += (_shown(line, colour=colour) for line in _hunk(hunk, old, new))
    if not parts:
        return ""
    head = (f"--- {name}", f"+++ {name}")
    shown = (f"{_BOLD}{line}{_RESET}\n" if colour else f"{line}\n" for line in head)
    return "".join((*shown, *parts))
