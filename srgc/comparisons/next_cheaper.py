"""What a result folder says about the robots that would have less than its design.

These robots have less of the first objective of the task.  The folder makes no claim about them:
what it says was refuted is asked again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.ordered_structures import structures_by
from compiler.objectives.values import MotionValues, value_bounds
from compiler.robots.candidate import Candidate
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.words.derivation import Derivation
from grammar_lang.conditions import condition_of
from solvers.explanation.learnt_lines import Learnt, learnt
from solvers.explanation.posed_task import PosedTask
from solvers.search.least_search import searched_modules
from solvers.verifier.claims.lemma_claims import LemmaClaim
from srgc.results.found_design import FoundDesign, found_design
from srgc.results.result_folder import json_object
from srgc.results.why_folder import TriedFolder

MOST_STRUCTURES = 2000
"""The number of structures with less to look at, those with the least first."""
MOST_EXPLAINED = 3
"""The number of refuted robots with the same value to explain."""
UNTRIED = "it was not tried"


@dataclass(frozen=True, slots=True)
class CheaperRobot:
    """A structure that would have less: its least ``value``, and why it is not the design.

    ``varies``: whether the value depends on the parameters.
    """

    derivation: Derivation
    value: Fraction
    verdict: str
    reason: str
    lemma: int | None
    varies: bool


@dataclass(frozen=True, slots=True)
class NextCheaper:
    """The robots that would have less of the first objective, ``amount``, than the design.

    ``refuted`` are, of the refuted ones, those with the largest value; ``undecided`` are all that
    are not decided; ``found`` are those that were found but have more of the later objectives.
    Those in ``other`` may have less with other parameters than those found, but not less than is
    claimed for all robots.  ``lemmas`` are about robots in ``refuted``.
    """

    posed: PosedTask
    amount: Amount
    value: Fraction
    refuted: tuple[CheaperRobot, ...]
    undecided: tuple[CheaperRobot, ...]
    found: tuple[CheaperRobot, ...]
    other: tuple[CheaperRobot, ...]
    lemmas: tuple[Learnt, ...]


def next_cheaper(folder: Path, tried: TriedFolder) -> NextCheaper | None:
    """The robots with less than the design of a folder; None if the objective orders no robots.

    Raises:
        UsageFault: there is no design, or it has been altered.
    """
    posed = tried.posed
    asked = amounts(posed.program, posed.task)
    if not asked or not asked[0].is_ordering:
        return None
    found = found_design(folder)
    value = _value(asked[0], found)
    if value is None:
        return None
    design = json_object(folder / "design.json")
    structures, claimed = design["structures_tried"], Fraction(design["objectives"][0]["least"])
    family = family_of(posed.program, posed.task)
    bound = searched_modules(family, posed.task, asked)
    every = structures_by(asked[0], family, bound, (), posed.task.origin)
    state = _State(family, structures, tried.lemmas)
    robots = [state.robot(*each) for each in _below(asked[0], every, value)]
    refuted = [each for each in robots if each.verdict == "refuted"]
    designed = [each for each in robots if each.verdict == "found"]
    nearest = [each for each in refuted if each.value == refuted[-1].value][:MOST_EXPLAINED]
    used = dict.fromkeys(each.lemma for each in nearest if each.lemma is not None)
    return NextCheaper(
        posed,
        asked[0],
        value,
        tuple(nearest),
        tuple(each for each in robots if each.verdict not in ("refuted", "found")),
        tuple(each for each in designed if not each.varies),
        tuple(replace(each, value=max(each.value, claimed)) for each in designed if each.varies),
        learnt(posed, [tried.lemmas[number] for number in used]),
    )


def _value(amount: Amount, found: FoundDesign) -> Fraction | None:
    """The design's value of an objective that does not depend on the motion."""
    nothing = MotionValues(None, Fraction(0), None)
    word = found.derivation.word
    bounds = value_bounds(amount, word, found.model, found.parameters, nothing)
    return None if bounds is None else bounds[1]


def _below(
    amount: Amount, every: Iterator[Candidate], value: Fraction
) -> Iterator[tuple[Derivation, Fraction, bool]]:
    """The structures that may have less than ``value``, with their least and whether it varies."""
    for candidate in islice(every, MOST_STRUCTURES):
        least = amount.of_robot(candidate.derivation.word, candidate.model)
        if least >= value:
            return
        model = candidate.model
        yield candidate.derivation, least, not amount.exact and bool(model and model.parameters)


class _State:
    """What a folder says about structures: those that were tried, and those that lemmas refute."""

    def __init__(
        self,
        family: RobotFamily,
        structures: Sequence[Mapping[str, Any]],
        lemmas: Sequence[LemmaClaim],
    ) -> None:
        self.known = {tuple(one["derivation"]): one for one in structures}
        terminals = family.program.terminals
        conditions = [condition_of(lemma.condition, terminals) for lemma in lemmas]
        self.narrowed = [family.with_condition(condition) for condition in conditions]

    def robot(self, derivation: Derivation, value: Fraction, varies: bool) -> CheaperRobot:  # noqa: FBT001
        """A structure, with what is known about it."""
        one = self.known.get(derivation.labels)
        word = derivation.word
        lemma = next(
            (k for k, each in enumerate(self.narrowed) if each.language.accepts(word)), None
        )
        if one is None:
            verdict, reason = ("untried", UNTRIED) if lemma is None else ("refuted", "")
            return CheaperRobot(derivation, value, verdict, reason, lemma, varies)
        verdict, reason = str(one["verdict"]), str(one["reason"])
        return CheaperRobot(derivation, value, verdict, reason, lemma, varies)
