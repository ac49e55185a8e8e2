"""What became of each structure, and what follows for the family when none of them was proved.

Section 6 of the design: ``impossible`` only if every structure up to an explicit bound, or of a
finite language, was refuted; everything else is ``unknown``, with what was tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from compiler.robots.normal_form import RobotFamily
from compiler.words.budget import WordsTooLongError
from grammar_lang import ir
from solvers.verdict import NotFound

DEFAULT_MODULES = 12
MOTION_SEARCHES = 10
"""Robots that are searched for a motion without success before the synthesis gives up."""
DEFAULT_ROBOTS = 1000
"""Robots that are tried where neither the task nor the language bounds their number."""

DEFAULT_DESIGNS = 20
"""Robots that are designed where all are asked for and nothing bounds their number."""

StructureVerdict = Literal["found", "refuted", "inadmissible", "unresolved", "same"]


@dataclass(frozen=True, slots=True)
class StructureRecord:
    """What became of one structure.

    ``script`` is its refutation in SMT-LIB 2, ``boxes`` one by a covering.
    """

    word: tuple[str, ...]
    derivation: tuple[str, ...]
    verdict: StructureVerdict
    reason: str
    script: str | None = None
    same_robot_as: int | None = None
    boxes: str | None = None


def module_bound(family: RobotFamily, task: ir.Task) -> int:
    """The number of modules up to which structures are tried.

    That of the task; all robots of a finite language; else the default.
    """
    if task.modules is not None:
        return task.modules
    return _longest(family) or DEFAULT_MODULES


def robot_limit(family: RobotFamily, task: ir.Task) -> int | None:
    """How many different robots are tried; None where the task or the language bounds them."""
    bounded = task.modules is not None or _longest(family) is not None
    return None if bounded else DEFAULT_ROBOTS


def conclude(
    records: Sequence[StructureRecord], family: RobotFamily, task: ir.Task, stopped: str | None
) -> tuple[NotFound, str]:
    """The verdict without a design; ``stopped`` is the limit that ended the search, if one did."""
    tried = len(records)
    open_ones = [r for r in records if r.verdict in ("unresolved", "inadmissible")]
    parts = []
    if open_ones:
        first = open_ones[0]
        parts.append(
            f"{len(open_ones)} of {tried} structures are neither built nor refuted; "
            f"the first is {' '.join(first.word)}: {first.reason}"
        )
    if stopped is not None:
        parts.append(stopped)
    if parts:
        return "unknown", "; ".join(parts)
    return _all_refuted(tried, family, task)


def _all_refuted(tried: int, family: RobotFamily, task: ir.Task) -> tuple[NotFound, str]:
    """Every structure that was tried is refuted: the verdict depends on what bounds them."""
    if task.modules is not None:
        within = f"of at most {task.modules} modules"
        if not tried:
            return "impossible", f"the family has no robot {within}"
        return "impossible", f"{_all(tried)} {within} {_are(tried)} refuted"
    if _longest(family) is not None:
        if not tried:
            return "impossible", "the family has no robot"
        return "impossible", f"{_all(tried)} of the family {_are(tried)} refuted"
    within = f"of at most {DEFAULT_MODULES} modules, the default search bound"
    if not tried:
        return "unknown", (
            f"the family has no robot {within}: say `modules <= n` in the task, "
            f"with n from {family.language.fewest_modules()} on"
        )
    return "unknown", (
        f"{_all(tried)} {within}, {_are(tried)} refuted; "
        "say `modules <= n` in the task to ask about a bound"
    )


def _longest(family: RobotFamily) -> int | None:
    """The length of the longest word, which has no more modules; None where there is no bound.

    None, too, where words are longer than those that are listed.
    """
    try:
        return family.language.longest()
    except WordsTooLongError:
        return None


def _all(structures: int) -> str:
    return "the only structure" if structures == 1 else f"all {structures} structures"


def _are(structures: int) -> str:
    return "is" if structures == 1 else "are"
