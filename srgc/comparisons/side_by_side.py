"""Result folders side by side: what their designs have of what all can be compared by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from compiler.expressions.exact_numbers import Bounds, exact_number
from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.objective_text import objective_name, objective_text, objective_unit
from compiler.objectives.values import MotionValues, value_bounds
from grammar_lang import ir
from solvers.verifier.claims.certificate import FoundClaim
from srgc.results.found_design import FoundDesign, found_design
from srgc.results.pareto_front import Figure, objective_figure
from srgc.results.result_folder import json_object
from srgc.results.why_folder import tried_folder
from srgc.text_reports.synthesis_report import used_inputs

ALWAYS = (
    ir.Objective("modules"),
    ir.Objective("mass"),
    ir.Objective("effort"),
    ir.Objective("time"),
)
"""What every design has, whatever its task asks for."""
USUAL = ("modules", "mass", "effort")
"""What designs are compared by where they have no objective in common."""


@dataclass(frozen=True, slots=True)
class Measure:
    """What designs have more or less of; ``objective``: whether the tasks of all ask for less."""

    name: str
    word: str
    unit: str
    objective: bool


@dataclass(frozen=True, slots=True)
class Standing:
    """A result folder: what it says, and of its design the figures by the names of measures.

    ``asked`` are the measures that its task asks to be least; ``parameters`` have the place of
    their symbol in the word, their names, values and units.
    """

    folder: Path
    verdict: str
    reason: str | None
    task: str
    spec_sha256: str
    asked: tuple[str, ...]
    word: tuple[str, ...] | None
    figures: Mapping[str, Figure]
    measures: Mapping[str, Measure]
    parameters: tuple[tuple[int, str, float, str], ...]


@dataclass(frozen=True, slots=True)
class SideBySide:
    """Several results, what their designs are compared by, and which dominate which.

    ``measures`` are those that all designs have; ``decisive`` those of them that dominance is
    about.
    """

    standings: tuple[Standing, ...]
    measures: tuple[Measure, ...]
    decisive: tuple[Measure, ...]

    @property
    def found(self) -> tuple[int, ...]:
        """Which of the results have a design."""
        return tuple(k for k, each in enumerate(self.standings) if each.word is not None)

    def best(self, measure: Measure) -> tuple[int, ...]:
        """Which have least of something; none where all have the same."""
        costs = {k: self.standings[k].figures[measure.name].cost for k in self.found}
        least = [k for k, cost in costs.items() if cost == min(costs.values())]
        return () if len(least) == len(costs) else tuple(least)

    def less(self, one: int, other: int) -> tuple[Measure, ...]:
        """The decisive measures of which a design has less than another one."""
        a, b = (self.standings[k].figures for k in (one, other))
        return tuple(each for each in self.decisive if a[each.name].cost < b[each.name].cost)

    def dominates(self, one: int, other: int) -> bool:
        """Whether a design has nowhere more and somewhere less than another one."""
        return bool(self.less(one, other)) and not self.less(other, one)

    def dominated_by(self, one: int) -> int | None:
        """The first design that dominates one; None where none does."""
        return next((k for k in self.found if self.dominates(k, one)), None)

    @property
    def same_spec(self) -> bool:
        """Whether all are about one specification, byte for byte."""
        return len({each.spec_sha256 for each in self.standings}) == 1

    @property
    def tasks(self) -> tuple[str, ...]:
        """The different names of their tasks."""
        return tuple(dict.fromkeys(each.task for each in self.standings))


def side_by_side(folders: Sequence[Path]) -> SideBySide:
    """Result folders side by side; nothing of them is verified.

    Raises:
        UsageFault: one holds no results, or they or the spec have been altered.
    """
    standings = tuple(map(_standing, folders))
    designs = [each for each in standings if each.word is not None]
    measures: tuple[Measure, ...] = ()
    if designs:
        first = designs[0]
        measures = tuple(
            _common(measure, designs)
            for name, measure in first.measures.items()
            if all(each.measures.get(name) == measure for each in designs)
        )
    decisive = tuple(each for each in measures if each.objective)
    others = sorted((each for each in measures if not each.objective), key=_place)
    usual = tuple(each for each in others if each.name in USUAL)
    return SideBySide(standings, (*decisive, *others), decisive or usual)


def _place(measure: Measure) -> int:
    """Where what every design has stands; what a task asks for comes before it."""
    names = [each.kind for each in ALWAYS]
    return names.index(measure.name) if measure.name in names else -1


def _common(measure: Measure, designs: Sequence[Standing]) -> Measure:
    """A measure, as one that the tasks of all designs ask for or not."""
    asked = all(measure.name in each.asked for each in designs)
    return Measure(measure.name, measure.word, measure.unit, asked)


def _standing(folder: Path) -> Standing:
    tried = tried_folder(folder)
    content = json_object(folder / "design.json")
    task = tried.posed.task
    reason = content["reason"]
    known = str(content["verdict"]), None if reason is None else str(reason), task.name
    digest = str(content["spec_sha256"])
    asked = tuple(map(objective_text, task.minimize))
    if tried.tried is not None:
        return Standing(folder, *known, digest, asked, None, {}, {}, ())
    found = found_design(folder)
    figures, measures = _figures(found)
    parameters = tuple(
        (each.parameter.symbol, each.parameter.name, float(each), each.parameter.unit)
        for each in found.parameters
    )
    return Standing(
        folder, *known, digest, asked, found.derivation.word, figures, measures, parameters
    )


def _figures(found: FoundDesign) -> tuple[dict[str, Figure], dict[str, Measure]]:
    """What a design has of the objectives of its task, and of what every design has."""
    figures: dict[str, Figure] = {}
    measures: dict[str, Measure] = {}
    motion = MotionValues(
        _share(found), len(found.claim.inputs) * found.task.step, _energy(found.claim)
    )
    for amount in (*amounts(found.program, found.task), *_always(found)):
        word = found.derivation.word
        bounds = value_bounds(amount, word, found.model, found.parameters, motion)
        if bounds is None or amount.text in figures:
            continue
        objective = amount.objective
        figures[amount.text] = objective_figure(objective, bounds)
        name, unit = objective_name(objective), objective_unit(objective)
        measures[amount.text] = Measure(amount.text, name, unit, objective=False)
    return figures, measures


def _always(found: FoundDesign) -> list[Amount]:
    modules = dict.fromkeys(found.program.modules, Fraction(1))
    return [Amount(each, modules if each.kind == "modules" else {}, exact=False) for each in ALWAYS]


def _energy(claim: FoundClaim) -> Bounds | None:
    """The energy that a certificate states; None where it states none."""
    stated = () if claim.objectives is None else claim.objectives.values
    values = (exact_number(each.value) for each in stated if each.objective == "energy")
    return next(((value, value) for value in values), None)


def _share(found: FoundDesign) -> float | None:
    """What the inputs keep from their bounds, as a share; None where none has a choice."""
    used = used_inputs(found.model, found.task, found.claim.inputs)
    return min((each.margin / each.widest for each in used if each.widest > 0), default=None)
