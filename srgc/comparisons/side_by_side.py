"""Result folders side by side: the values by which all their designs can be compared."""

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
"""Values that every design has, whatever its task asks for."""
USUAL = ("modules", "mass", "effort")
"""The values by which designs without common objectives are compared."""


@dataclass(frozen=True, slots=True)
class Measure:
    """A value to compare designs by; ``objective``: whether the tasks of all ask for less of it."""

    name: str
    word: str
    unit: str
    objective: bool


@dataclass(frozen=True, slots=True)
class Standing:
    """A result folder: its statements, and the figures of its design by the names of measures.

    ``asked`` are the measures that its task minimizes.  Each of ``parameters`` has the index of its
    symbol in the word, its name, value and unit.
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
    """Several results, the measures by which to compare their designs, and dominance among them.

    ``measures`` are those that all designs have; ``decisive`` are those that decide dominance.
    """

    standings: tuple[Standing, ...]
    measures: tuple[Measure, ...]
    decisive: tuple[Measure, ...]

    @property
    def found(self) -> tuple[int, ...]:
        """The indices of the results with a design."""
        return tuple(k for k, each in enumerate(self.standings) if each.word is not None)

    def best(self, measure: Measure) -> tuple[int, ...]:
        """The results with the least value of a measure; empty if all have the same."""
        costs = {k: self.standings[k].figures[measure.name].cost for k in self.found}
        least = [k for k, cost in costs.items() if cost == min(costs.values())]
        return () if len(least) == len(costs) else tuple(least)

    def less(self, one: int, other: int) -> tuple[Measure, ...]:
        """The decisive measures of which one design has less than the other."""
        a, b = (self.standings[k].figures for k in (one, other))
        return tuple(each for each in self.decisive if a[each.name].cost < b[each.name].cost)

    def dominates(self, one: int, other: int) -> bool:
        """Whether a design has less of some decisive measure than another, and more of none."""
        return bool(self.less(one, other)) and not self.less(other, one)

    def dominated_by(self, one: int) -> int | None:
        """The first design that dominates the given one; None if no design does."""
        return next((k for k in self.found if self.dominates(k, one)), None)

    @property
    def same_spec(self) -> bool:
        """Whether all results are about the same specification, byte for byte."""
        return len({each.spec_sha256 for each in self.standings}) == 1

    @property
    def tasks(self) -> tuple[str, ...]:
        """The distinct names of their tasks."""
        return tuple(dict.fromkeys(each.task for each in self.standings))


def side_by_side(folders: Sequence[Path]) -> SideBySide:
    """Result folders side by side; nothing in them is verified.

    Raises:
        UsageFault: a folder has no results, or they or the spec have been altered.
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
    """The sort key of a measure: those that a task asks for come before those of every design."""
    names = [each.kind for each in ALWAYS]
    return names.index(measure.name) if measure.name in names else -1


def _common(measure: Measure, designs: Sequence[Standing]) -> Measure:
    """A measure, with ``objective`` set if the tasks of all designs ask for it."""
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
    """The design's values of the objectives of its task, and of those that every design has."""
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
    """The energy that a certificate states; None if it states none."""
    stated = () if claim.objectives is None else claim.objectives.values
    values = (exact_number(each.value) for each in stated if each.objective == "energy")
    return next(((value, value) for value in values), None)


def _share(found: FoundDesign) -> float | None:
    """The least distance of an input from its bound, as a share; None if no input has a choice."""
    used = used_inputs(found.model, found.task, found.claim.inputs)
    return min((each.margin / each.widest for each in used if each.widest > 0), default=None)
