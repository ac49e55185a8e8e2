"""What became of each structure, and what follows for the family when none of them was proved.

Section 6 of the design: ``impossible`` only if every structure up to an explicit bound, or of a
finite language, was refuted; everything else is ``unknown``, with what was tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from compiler.robots.normal_form import RobotFamily
from compiler.words.budget import WordsTooLongError
from grammar_lang import ir
from grammar_lang.diagnostics.wording import counted
from solvers.lemma import Lemma, VariantLemma
from solvers.verdict import NotFound

DEFAULT_MODULES = 12
MOTION_SEARCHES = 10
"""Robots that are searched for a motion without success before the synthesis gives up."""
DEFAULT_ROBOTS = 1000
"""Robots that are tried where neither the task nor the language bounds their number."""

DEFAULT_DESIGNS = 20
"""Robots that are designed where all are asked for and nothing bounds their number."""

LEMMAS_NAMED = 2
"""So many lemmas are named in a reason."""

StructureVerdict = Literal["found", "refuted", "inadmissible", "unresolved", "same"]


@dataclass(frozen=True, slots=True)
class StructureRecord:
    """What became of one structure.

    ``script`` is its refutation in SMT-LIB 2, ``boxes`` one by a covering; ``lemma`` is the number,
    from 0, of one that its word satisfies.
    """

    word: tuple[str, ...]
    derivation: tuple[str, ...]
    verdict: StructureVerdict
    reason: str
    script: str | None = None
    same_robot_as: int | None = None
    boxes: str | None = None
    lemma: int | None = None


def with_lemmas(
    records: Sequence[StructureRecord], lemmas: Sequence[Lemma]
) -> tuple[StructureRecord, ...]:
    """The records, of which those that lemmas are about rest on these and on nothing else.

    Where they are the same robot as others, the first of those has the evidence.
    """
    found: list[StructureRecord] = []
    heirs: dict[int, int] = {}
    for number, record in enumerate(records):
        about = next((k for k, lemma in enumerate(lemmas) if lemma.is_about(record.word)), None)
        if record.verdict == "found":
            about = None
        first = record.same_robot_as
        if about is not None:
            found.append(_under(record, about, lemmas))
        elif first is None or found[first].lemma is None:
            found.append(record)
        elif first in heirs:
            found.append(replace(record, same_robot_as=heirs[first]))
        else:
            heirs[first] = number
            before = records[first]
            found.append(replace(before, word=record.word, derivation=record.derivation))
    return tuple(found)


def _under(record: StructureRecord, number: int, lemmas: Sequence[Lemma]) -> StructureRecord:
    """A record that rests on a lemma; a robot whose variants one is about keeps its evidence."""
    reason = lemmas[number].text
    about = replace(record, verdict="refuted", reason=reason, lemma=number, same_robot_as=None)
    bases = [lemma.labels for lemma in lemmas if isinstance(lemma, VariantLemma)]
    return about if record.derivation in bases else replace(about, script=None, boxes=None)


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
    """The verdict without a design; ``stopped`` is the limit that ended the search, if one did.

    ``family`` has the robots that no lemma is about.
    """
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
    return _all_refuted(records, family, task)


def _all_refuted(
    records: Sequence[StructureRecord], family: RobotFamily, task: ir.Task
) -> tuple[NotFound, str]:
    """Every structure that was tried is refuted: the verdict depends on what bounds them."""
    if task.modules is not None:
        within = f"of at most {task.modules} modules"
        if not records:
            return "impossible", f"the family has no robot {within}"
        return "impossible", _refuted(records, within)
    if _longest(family) is not None:
        if not records:
            return "impossible", "the family has no robot"
        return "impossible", _refuted(records, "of the family")
    within = f"of at most {DEFAULT_MODULES} modules, the default search bound"
    if not records:
        return "unknown", (
            f"the family has no robot {within}: say `modules <= n` in the task, "
            f"with n from {family.language.fewest_modules()} on"
        )
    return "unknown", (
        f"{_refuted(records, within + ',')}; say `modules <= n` in the task to ask about a bound"
    )


def _refuted(records: Sequence[StructureRecord], which: str) -> str:
    """That all structures of a kind are refuted, and by which lemmas."""
    learnt = list(dict.fromkeys(r.reason for r in records if r.lemma is not None))
    if not learnt:
        count = len(records)
        subject = "the only structure" if count == 1 else f"all {count} structures"
        return f"{subject} {which} {'is' if count == 1 else 'are'} refuted"
    alone = sum(record.lemma is None for record in records)
    rest = f"; {counted(alone, 'structure')} one by one" if alone else ""
    shown = "; ".join(learnt[:LEMMAS_NAMED])
    more = len(learnt) - LEMMAS_NAMED
    shown += f"; and {counted(more, 'more lemma')}" if more > 0 else ""
    return f"all structures {which} are refuted: {shown}{rest}"


def _longest(family: RobotFamily) -> int | None:
    """The length of the longest word, which has no more modules; None where there is no bound.

    None, too, where words are longer than those that are listed.
    """
    try:
        return family.language.longest()
    except WordsTooLongError:
        return None
