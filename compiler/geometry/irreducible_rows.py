"""Few inequalities that already contradict each other, or that leave no interior.

Source: Chinneck, *Feasibility and Infeasibility in Optimization* (2008), section 6.2 (additive
method), with the bisection of Junker, *QuickXplain* (2004).  By Helly's theorem an irreducible
set of half-spaces in dimension d without a common point has at most d + 1 members; the same holds
of their interiors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from compiler.geometry.polytope import Polytope
from grammar_lang.ir import HalfSpace


def irreducible_rows(
    rows: Sequence[HalfSpace], fails: Callable[[Polytope], bool]
) -> tuple[HalfSpace, ...]:
    """Rows with which ``fails`` holds, none of which can be left out, in the order given.

    Args:
        rows: half-spaces of one dimension with which ``fails`` holds.
        fails: a test that more rows can only make true, such as emptiness.
    """
    kept: list[int] = []
    pending = range(len(rows))
    while not kept or not fails(_polytope(rows, kept)):
        low, high = 1, len(pending)
        while low < high:
            middle = (low + high) // 2
            if fails(_polytope(rows, [*kept, *pending[:middle]])):
                high = middle
            else:
                low = middle + 1
        kept.append(pending[low - 1])
        pending = pending[: low - 1]
    return tuple(rows[i] for i in sorted(kept))


def _polytope(rows: Sequence[HalfSpace], chosen: Sequence[int]) -> Polytope:
    return Polytope(tuple(rows[i] for i in chosen))
