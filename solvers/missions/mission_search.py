"""From a mission to its verdict: found, impossible or unknown, with the evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from compiler.expressions.exact_numbers import rational_bounds
from compiler.missions.chains import Link, cheapest_chain
from compiler.missions.open_layers import OpenRobots, open_links
from compiler.missions.parameter_boxes import BoxTree
from compiler.missions.parameter_ranges import Range
from compiler.missions.robot_changes import built
from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.objective_text import objective_unit
from compiler.objectives.ordered_structures import Limit, words_below
from compiler.time_limits.time_limit import OutOfTimeError, time_limit
from compiler.words.derivation import Derivation
from compiler.words.structures import InfiniteAmbiguityError, structures_of
from grammar_lang import ir
from solvers.conclusion import StructureRecord, with_lemmas
from solvers.lemma import Lemma, VariantLemma
from solvers.missions.compared_structures import compared_structures
from solvers.missions.mission_result import (
    Existing,
    MissionResult,
    ObjectiveValue,
    TaskEvidence,
)
from solvers.missions.one_robot import OneRobotSearch
from solvers.missions.rebuilt_robots import RebuiltSearch
from solvers.missions.refuted_parts import RefutedParts
from solvers.missions.task_robots import TaskRobots
from solvers.missions.undecided_robots import OUT_OF_TIME, grouped
from solvers.missions.without_robots import (
    TIME,
    all_undecided,
    without_chain,
    without_one_robot,
)
from solvers.run_context import RunContext
from solvers.search.design_values import design_values
from solvers.search.least_search import searched_modules

MOTIONS = ("time", "energy", "effort")
"""Objectives about a motion rather than a robot."""


def solve(
    program: ir.Program,
    mission: ir.Mission,
    context: RunContext,
    existing: Existing | None = None,
) -> MissionResult:
    """Search for the robots of a mission.

    Args:
        program: the spec.
        mission: one of its missions.
        context: how to search.
        existing: the robot before the first task; None for that of its `from`, if any.

    Raises:
        MapFault: if a map of obstacles cannot be used.
    """
    try:
        tasks = [_task_robots(program, mission, name, context) for name in mission.tasks]
        first = tasks[0].task.origin
        if existing is None and first is not None:
            existing = _existing(program, first)
        separated = [each for each in tasks if each.separation is not None]
        if separated:
            return _separated(mission, tasks, existing)
        if mission.prices is None:
            return _one_robot(mission, tasks)
        return _rebuilt(mission, mission.prices, tasks, existing)
    except OutOfTimeError:
        return MissionResult(
            mission, "unknown", TIME, existing=existing, ended=OUT_OF_TIME, unfinished=True
        )
    except InfiniteAmbiguityError as error:
        return MissionResult(mission, "unknown", str(error), existing=existing)


def _task_robots(
    program: ir.Program, mission: ir.Mission, name: str, context: RunContext
) -> TaskRobots:
    """The robots of a task; their motions are optimised for the mission's objectives, if any."""
    task = program.tasks[name]
    asked = tuple(each for each in mission.minimize if each.kind in MOTIONS)
    if asked:
        task = replace(task, minimize=asked)
    return TaskRobots(program, task, context)


def _existing(program: ir.Program, origin: ir.Origin) -> Existing:
    """The robot of a `from`, with the parameter values that it fixes."""
    values = {
        (fixed.symbol, fixed.name): (Range(*rational_bounds(fixed.value)),)
        for fixed in origin.fixed
    }
    return Existing(origin.word, built(origin.word, program.modules, values))


def _separated(
    mission: ir.Mission, tasks: Sequence[TaskRobots], existing: Existing | None
) -> MissionResult:
    """The result for a mission with a task that no robot can do."""
    evidence = tuple(TaskEvidence((), (), each.separation) for each in tasks)
    first = next(each for each in tasks if each.separation is not None)
    reason = f"no robot does `{first.task.name}`: {first.separated}"
    return MissionResult(mission, "impossible", reason, evidence=evidence, existing=existing)


def counts_of(tasks: Sequence[TaskRobots], robots: int) -> dict[str, int]:
    """The counts of what was tried; ``robots`` is their number in all layers together."""
    return {
        "robots": robots,
        "examined": sum(len(each.examined) for each in tasks),
        "refutations": sum(each.screened for each in tasks),
        "motion searches": sum(each.searched for each in tasks),
    }


# --- Refutations and their evidence ---------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Known:
    """The refutations in a task, by coverings only or by solvers too."""

    records: tuple[StructureRecord, ...]
    lemmas: tuple[Lemma, ...]

    def refutes(self, derivation: Derivation) -> bool:
        """Whether a structure is refuted for all values of its parameters."""
        if any(lemma.is_about(derivation.word) for lemma in self.lemmas):
            return True
        return any(each.derivation == derivation.labels for each in self.records)

    @property
    def evidence(self) -> TaskEvidence:
        """These refutations as part of a result."""
        return TaskEvidence(self.records, self.lemmas)


def _known(robots: TaskRobots, *, covered: bool) -> _Known:
    """The refutations in a task; with ``covered``, only those by coverings."""
    records, lemmas = robots.evidence(), list(robots.lemmas)
    if covered:
        kept = [i for i, each in enumerate(records) if each.boxes is not None]
        place = {old: new for new, old in enumerate(kept)}
        records = [
            replace(
                records[i],
                script=None,
                same_robot_as=None if (s := records[i].same_robot_as) is None else place.get(s),
            )
            for i in kept
        ]
        labels = {each.derivation for each in records}
        lemmas = [
            each for each in lemmas if not isinstance(each, VariantLemma) or each.labels in labels
        ]
    return _Known(with_lemmas(records, lemmas), tuple(lemmas))


# --- One robot ------------------------------------------------------------------------------------


def _one_robot(mission: ir.Mission, tasks: Sequence[TaskRobots]) -> MissionResult:
    search = OneRobotSearch(tasks, mission)
    late = False
    try:
        search.search()
    except OutOfTimeError:
        late, search.found = True, search.found or search.incumbent
    counts = counts_of(tasks, len(search.words) * len(tasks))
    bound = search.task.modules
    cut = tuple(search.cut.values())
    try:
        known = [_known(each, covered=bool(search.found)) for each in tasks]
    except OutOfTimeError:
        late, known = True, [_Known((), ()) for _ in tasks]
    evidence = tuple(each.evidence for each in known)
    undecided = grouped((search.words[key], why) for key, why in search.undecided.items())
    if search.found:
        parts = RefutedParts(tasks, shared=True)
        try:
            values = _values(search, known, parts)
        except OutOfTimeError:
            # A lower bound without refutations takes no search.
            late, known = True, [_Known((), ()) for _ in tasks]
            with time_limit(None):
                values = _values(search, known, parts)
            evidence = tuple(each.evidence for each in known)
        return MissionResult(
            mission, "found", None, search.found, (None,) * len(tasks), values=values,
            evidence=evidence, cut=(*cut, *parts.cut.values()), modules=bound,
            undecided=len(search.undecided), open_robots=undecided, counts=counts,
            unfinished=late or parts.late,
        )  # fmt: skip
    said = without_one_robot(search, undecided, late=late)
    return MissionResult(
        mission, said.verdict, said.reason, evidence=evidence, cut=cut, modules=bound,
        undecided=len(search.undecided), open_robots=undecided, ended=said.ended, counts=counts,
        unfinished=late,
    )  # fmt: skip


def _values(
    search: OneRobotSearch, known: Sequence[_Known], parts: RefutedParts
) -> tuple[ObjectiveValue, ...]:
    """The values of the robot in the objectives, with lower bounds over all robots."""
    task, limits, found = search.task, list[Limit](), list[ObjectiveValue]()
    family = search.tasks[0].family
    refuted = {labels for labels, cut in search.cut.items() if cut.tree.is_refuted}
    bound = searched_modules(family, task, search.amounts) if search.amounts else None
    for amount in search.amounts:
        (value,) = design_values(search.found[0], (amount,), search.tasks[0].task)
        least = _least(amount, search, known, parts, refuted, limits, value, bound)
        found.append(
            ObjectiveValue(
                amount.objective, amount.text, value, least, objective_unit(amount.objective)
            )
        )
        limits.append(Limit(amount, value, value))
    return tuple(found)


def _least(
    amount: Amount,
    search: OneRobotSearch,
    known: Sequence[_Known],
    parts: RefutedParts,
    refuted: set[tuple[str, ...]],
    limits: Sequence[Limit],
    value: Fraction,
    bound: int | None,
) -> Fraction:
    """A lower bound over robots within the limits: the value of the first word not refuted."""
    language = search.tasks[0].family.language
    for word in words_below(amount, search.tasks[0].family, bound, limits, value):
        for derivation in structures_of(language, [word]):
            if derivation.labels in refuted or any(each.refutes(derivation) for each in known):
                continue
            if any(parts.refutes(k, derivation) for k in range(len(known))):
                continue
            return amount.of_word(word)
    return value


# --- Robots that are rebuilt ----------------------------------------------------------------------


def _rebuilt(
    mission: ir.Mission,
    prices: ir.Prices,
    tasks: Sequence[TaskRobots],
    existing: Existing | None,
) -> MissionResult:
    compared = compared_structures(tasks, prices, existing)
    by_default = compared.by_default
    ranked = _ranked(compared.structures, mission, tasks)
    search = RebuiltSearch(tasks, mission, prices, existing, ranked)
    late = False
    robots = sum(map(len, search.layers))
    try:
        search.search()
    except OutOfTimeError:
        late = True
        search.take_incumbent()
    try:
        known = [_known(each, covered=bool(search.found)) for each in tasks]
    except OutOfTimeError:
        late, known = True, [_Known((), ()) for _ in tasks]
    undecided = grouped(all_undecided(search))
    parts = RefutedParts(tasks, shared=False)
    cost = search.cost
    try:
        least = None if compared.left_out else _least_cost(search, known, parts)
    except OutOfTimeError:
        late, least = True, None
    common = MissionResult(
        mission, "unknown", None, evidence=tuple(each.evidence for each in known),
        cut=(*search.cut.values(), *parts.cut.values()), existing=existing,
        modules=compared.modules, by_default=by_default,
        undecided=sum(each.robots for each in undecided), open_robots=undecided,
        counts=counts_of(tasks, robots), unfinished=late or parts.late,
    )  # fmt: skip
    if search.found:
        bound = Fraction(0) if by_default or least is None else min(cost, least)
        return replace(
            common,
            verdict="found",
            designs=search.found,
            steps=search.steps,
            cost=cost,
            least=bound,
        )
    said = without_chain(search, least, undecided, compared, late=common.unfinished)
    return replace(common, verdict=said.verdict, reason=said.reason, least=least, ended=said.ended)


def _ranked(
    structures: Sequence[Derivation], mission: ir.Mission, tasks: Sequence[TaskRobots]
) -> list[Derivation]:
    """The structures by preference: by the objectives about robots, then in the given order."""
    first = tasks[0]
    asked = tuple(o for o in mission.minimize if o.kind != "changes" and o.kind not in MOTIONS)
    weights = amounts(first.program, replace(first.task, minimize=asked))
    return sorted(structures, key=lambda d: [amount.of_word(d.word) for amount in weights])


def _least_cost(
    search: RebuiltSearch, known: Sequence[_Known], parts: RefutedParts
) -> Fraction | None:
    """A lower bound on the cost of a chain of robots that are not refuted; None if there is none.

    If it is below the cost of the chain that was found, structures on the cheapest chain that only
    solvers refute are refuted part by part, if possible.
    """
    while True:
        layers = _open_layers(search, known, parts)
        chain = cheapest_chain(search.costs, layers)
        if chain is None or not search.found or chain.cost >= search.cost:
            return None if chain is None else chain.cost
        pairs = enumerate(zip(layers, chain.robots, strict=True))
        open_ones = [(k, search.ranked[layer[place].rank]) for k, (layer, place) in pairs]
        if not any(parts.refutes(k, derivation) for k, derivation in open_ones):
            return chain.cost


def _open_layers(
    search: RebuiltSearch, known: Sequence[_Known], parts: RefutedParts
) -> list[list[Link]]:
    trees: list[dict[tuple[str, ...], BoxTree]] = [{} for _ in search.tasks]
    for (layer, labels), cut in (search.cut | parts.cut).items():
        trees[layer][labels] = cut.tree
    return [
        open_links(
            search.ranked,
            robots.program.modules,
            OpenRobots(
                robots.task.modules, what.refutes, own, robots.model, search.is_narrow(layer)
            ),
        )
        for layer, (robots, what, own) in enumerate(zip(search.tasks, known, trees, strict=True))
    ]
