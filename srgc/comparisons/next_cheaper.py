"""What a result folder says of the robots that would have had less than its design.

They are those that have less of the first objective of the task.  Nothing is claimed of them: what
the folder says was refuted is asked again.
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
"""So many structures that would have less are looked at, those with least first."""
MOST_EXPLAINED = 3
"""So many refuted robots of the same value are explained."""
UNTRIED = "it was not tried"


@dataclass(frozen=True, slots=True)
class CheaperRobot:
    """A structure that would have had less: its least ``value``, and why it is not the design.

    ``varies``: what its robots have depends on their parameters.
    """

    derivation: Derivation
    value: Fraction
    verdict: str
    reason: str
    lemma: int | None
    varies: bool


@dataclass(frozen=True, slots=True)
class NextCheaper:
    """Who would have had less than a design of the first objective, which is ``amount``.

    ``refuted`` are those with the most less than the design that are refuted, ``undecided`` all of
    which that is not known, ``found`` those that were found and have more of what comes behind.
    With ``other`` parameters than those that were found, some may have less, but not less than is
    claimed of all.  ``lemmas`` are about robots of the first kind.
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
    """Who would have had less than the design of a folder; None where no robot is ordered so.

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
    """What the design has of an objective that is no motion's."""
    nothing = MotionValues(None, Fraction(0), None)
    word = found.derivation.word
    bounds = value_bounds(amount, word, found.model, found.parameters, nothing)
    return None if bounds is None else bounds[1]


def _below(
    amount: Amount, every: Iterator[Candidate], value: Fraction
) -> Iterator[tuple[Derivation, Fraction, bool]]:
    """The structures that may have less than so much, with the least, and whether it varies."""
    for candidate in islice(every, MOST_STRUCTURES):
        least = amount.of_robot(candidate.derivation.word, candidate.model)
        if least >= value:
            return
        model = candidate.model
        yield candidate.derivation, least, not amount.exact and bool(model and model.parameters)


class _State:
    """What a folder says of structures: of those that were tried, and of those of lemmas."""

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
        """A structure, with what is known of it."""
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
