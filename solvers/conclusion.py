"""The verdict on each structure, and on the family when no structure yields a proved design.

Section 6 of the design: the verdict is ``impossible`` only if every structure up to an explicit
bound, or every structure of a finite language, was refuted.  Otherwise it is ``unknown``, with a
list of what was tried.
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
"""The synthesis stops after this many robots for which no motion was found."""
DEFAULT_ROBOTS = 1000
"""The number of robots tried if neither the task nor the language bounds it."""

DEFAULT_DESIGNS = 20
"""The number of designs made if all are asked for and nothing bounds their number."""

LEMMAS_NAMED = 2
"""The number of lemmas named in a reason."""

StructureVerdict = Literal["found", "refuted", "inadmissible", "unresolved", "same"]


@dataclass(frozen=True, slots=True)
class StructureRecord:
    """The verdict on one structure, with its evidence.

    ``script`` is a refutation in SMT-LIB 2, ``boxes`` a refutation by a covering.  ``lemma`` is the
    number, from 0, of a lemma whose condition the word satisfies.
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
    """The records, with every structure that a lemma covers refuted by that lemma alone.

    If other records refer to such a structure as the same robot, the first of them that no lemma
    covers gets its evidence.
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
    """A record refuted by a lemma; the base structure of a variant lemma keeps its own evidence."""
    reason = lemmas[number].text
    about = replace(record, verdict="refuted", reason=reason, lemma=number, same_robot_as=None)
    bases = [lemma.labels for lemma in lemmas if isinstance(lemma, VariantLemma)]
    return about if record.derivation in bases else replace(about, script=None, boxes=None)


def module_bound(family: RobotFamily, task: ir.Task) -> int:
    """The number of modules up to which structures are tried.

    This is the bound of the task, or else the longest word of a finite language, or else the
    default.
    """
    if task.modules is not None:
        return task.modules
    return _longest(family) or DEFAULT_MODULES


def robot_limit(family: RobotFamily, task: ir.Task) -> int | None:
    """The number of different robots to try; None if the task or the language bounds it."""
    bounded = task.modules is not None or _longest(family) is not None
    return None if bounded else DEFAULT_ROBOTS


def conclude(
    records: Sequence[StructureRecord], family: RobotFamily, task: ir.Task, stopped: str | None
) -> tuple[NotFound, str]:
    """The verdict when there is no design.

    ``stopped`` names the limit that ended the search, if one did.  ``family`` contains the robots
    that no lemma covers.
    """
    tried = len(records)
    open_ones = [r for r in records if r.verdict in ("unresolved", "inadmissible")]
    parts = []
    if open_ones:
        count, first = len(open_ones), open_ones[0]
        which = "it is" if count == 1 else "the first is"
        parts.append(
            f"{count} of {counted(tried, 'structure')} {'is' if count == 1 else 'are'} neither "
            f"built nor refuted; {which} {' '.join(first.word)}: {first.reason}"
        )
    if stopped is not None:
        parts.append(stopped)
    if parts:
        return "unknown", "; ".join(parts)
    return _all_refuted(records, family, task)


def _all_refuted(
    records: Sequence[StructureRecord], family: RobotFamily, task: ir.Task
) -> tuple[NotFound, str]:
    """The verdict when every structure tried is refuted; it depends on what bounds their number."""
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
    """The statement that all structures of a kind are refuted, and by which lemmas."""
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
    """The length of the longest word, which bounds its modules; None if there is no bound.

    Also None if words are too long to be listed.
    """
    try:
        return family.language.longest()
    except WordsTooLongError:
        return None
