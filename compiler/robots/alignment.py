"""The modules of a word that are kept in another word, and those that are removed and added.

An alignment matches equal symbols of two words in order (Needleman & Wunsch 1970, with deletions
and insertions only). Its cost counts, in lexicographic order, unmatched modules, unmatched edges,
and runs of unmatched symbols, which are the places where the robot is opened. The cost of modules
and edges is a metric on words.
"""

from __future__ import annotations

from collections.abc import Container, Hashable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Alignment:
    """The modules of two words, by their indices in them.

    ``kept`` holds pairs of indices, in the old word and in the new one; ``edges`` is the number of
    unmatched edges of both words.
    """

    kept: tuple[tuple[int, int], ...]
    removed: tuple[int, ...]
    added: tuple[int, ...]
    edges: int

    @property
    def distance(self) -> int:
        """The number of modules added or removed."""
        return len(self.removed) + len(self.added)


def alignment(
    old: Sequence[Hashable], new: Sequence[Hashable], modules: Container[Hashable]
) -> Alignment:
    """The cheapest alignment; of several, the one that keeps what comes first in the old word.

    Args:
        old: the symbols of the old word.
        new: the symbols of the new word.
        modules: which symbols are modules; all others are edges.
    """
    matched = _matched(old, new, modules)
    kept = [pair for pair in matched if old[pair[0]] in modules]
    removed = {i for i, symbol in enumerate(old) if symbol in modules} - {i for i, _ in kept}
    added = {j for j, symbol in enumerate(new) if symbol in modules} - {j for _, j in kept}
    edges = len(old) + len(new) - 2 * len(matched) - len(removed) - len(added)
    return Alignment(tuple(kept), tuple(sorted(removed)), tuple(sorted(added)), edges)


def _matched(
    old: Sequence[Hashable], new: Sequence[Hashable], modules: Container[Hashable]
) -> list[tuple[int, int]]:
    """The matched positions, in order."""
    rest = _costs(old, new, modules)
    found: list[tuple[int, int]] = []
    i = j = 0
    opened = False
    while i < len(old) or j < len(new):
        best = rest[i][j][opened]
        can_match = i < len(old) and j < len(new) and old[i] == new[j]
        if can_match and best == rest[i + 1][j + 1][False]:
            found.append((i, j))
            i, j, opened = i + 1, j + 1, False
            continue
        # Within a run the order of removals and additions makes no difference.
        cost = best - (not opened)
        if j < len(new) and cost == _weight(old, new, new[j], modules) + rest[i][j + 1][True]:
            j += 1
        else:
            i += 1
        opened = True
    return found


def _weight(
    old: Sequence[Hashable], new: Sequence[Hashable], symbol: Hashable, modules: Container[Hashable]
) -> int:
    """The cost of an unmatched symbol, where a run costs 1."""
    base = len(old) + len(new) + 1
    return base * base if symbol in modules else base


def _costs(
    old: Sequence[Hashable], new: Sequence[Hashable], modules: Container[Hashable]
) -> list[list[tuple[int, int]]]:
    """The least cost of aligning ``old[i:]`` and ``new[j:]``, outside a run and within one."""
    n, m = len(old), len(new)
    out = [_weight(old, new, symbol, modules) for symbol in old]
    come = [_weight(old, new, symbol, modules) for symbol in new]
    rest = [[(0, 0)] * (m + 1) for _ in range(n + 1)]
    for i in range(n, -1, -1):
        for j in range(m, -1, -1):
            if i == n and j == m:
                continue
            changes = []
            if i < n:
                changes.append(out[i] + rest[i + 1][j][True])
            if j < m:
                changes.append(come[j] + rest[i][j + 1][True])
            change = min(changes)
            if i < n and j < m and old[i] == new[j]:
                keep = rest[i + 1][j + 1][False]
                rest[i][j] = (min(keep, change + 1), min(keep, change))
            else:
                rest[i][j] = (change + 1, change)
    return rest
