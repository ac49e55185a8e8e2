"""Lemmas in an explanation: their text, the lines that they depend on, and some of their robots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from compiler.robots.robot_key import robot_key_in_task
from grammar_lang import ir
from grammar_lang.conditions import condition_of
from solvers.conclusion import module_bound
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.task_line import TaskLine, task_lines
from solvers.verifier.claims.lemma_claims import LemmaClaim, VariantClaim, WeightsClaim, lemma_text

MOST_ROBOTS = 60
"""The most different robots of lemmas that are examined, from the first structures."""
MOST_STRUCTURES = 300


@dataclass(frozen=True, slots=True)
class Learnt:
    """A lemma, in words, and the lines of the spec that it depends on."""

    claim: LemmaClaim
    says: str
    lines: tuple[TaskLine, ...]


def learnt(posed: PosedTask, claims: Sequence[LemmaClaim]) -> tuple[Learnt, ...]:
    """The lemmas of a result.

    Raises:
        ValueError: a condition is not one on words of the family.
    """
    return tuple(Learnt(c, lemma_text(c), tuple(_lines(posed, c))) for c in claims)


def _lines(posed: PosedTask, claim: LemmaClaim) -> Iterator[TaskLine]:
    """The lines that a lemma depends on: places, obstacles, drives, and counted modules."""
    task, program = posed.task, posed.program
    if isinstance(claim, VariantClaim):
        kinds = ("start", "reach", "avoid", "avoid_self", "bounds_body")
        yield from (line for line in task_lines(posed) if line.kind in kinds)
        return
    if isinstance(claim, WeightsClaim):
        kinds = ("start", "reach", "effort", "joint_effort", "horizon")
        yield from (line for line in task_lines(posed) if line.kind in kinds)
        return
    counted = _counted(condition_of(claim.condition, program.terminals), frozenset(program.modules))
    for line in task_lines(posed):
        match line.kind:
            case "start":
                about = isinstance(task.start, ir.StartIn) and task.start.region == claim.region
            case "reach":
                about = task.reach is not None and task.reach.region == claim.region
            case "satisfy":
                about = claim.region in _text(posed, line)
            case "carry":
                carry = task.carries[int(line.key[0])]
                about = claim.region in (carry.source, carry.target)
            case "parameter":
                about = line.key[0] in counted
            case _:
                about = False
        if about:
            yield line


def _counted(condition: ir.Accept, modules: frozenset[str]) -> frozenset[str]:
    """The modules that a condition counts; all of them if it bounds the length of the word."""
    match condition:
        case ir.Count(str(symbol), _, _):
            return frozenset({symbol})
        case ir.Count(None, "<=", _):
            return modules
        case ir.AllOf(parts) | ir.AnyOf(parts):
            return frozenset[str]().union(*(_counted(part, modules) for part in parts))
        case ir.NotAccept(part):
            return _counted(part, modules)
        case _:
            return frozenset()


def _text(posed: PosedTask, line: TaskLine) -> str:
    return posed.program.sources[line.span.file].text[line.span.start : line.span.end]


def robots_of_lemmas(
    posed: PosedTask, claims: Sequence[LemmaClaim], known: Sequence[tuple[str, ...]]
) -> tuple[tuple[str, ...], ...]:
    """Derivations of some structures that lemmas cover, one for each robot not known yet.

    Args:
        posed: the task.
        claims: the lemmas.
        known: the derivations of structures that were refuted on their own.

    Raises:
        ValueError: a condition is not one on words of the family.
    """
    if not claims:
        return ()
    family = family_of(posed.program, posed.task)
    conditions = tuple(condition_of(c.condition, posed.program.terminals) for c in claims)
    narrowed = family.with_condition(ir.AnyOf(conditions))
    seen: set[str] = set()
    found: list[tuple[str, ...]] = []
    every = candidates(narrowed, module_bound(family, posed.task), posed.task.origin)
    for candidate in islice(every, MOST_STRUCTURES):
        if len(seen) == MOST_ROBOTS:
            break
        if candidate.model is None:
            continue
        key = robot_key_in_task(candidate.model, posed.task)
        if key not in seen and candidate.derivation.labels not in known:
            found.append(candidate.derivation.labels)
        seen.add(key)
    return tuple(found)
