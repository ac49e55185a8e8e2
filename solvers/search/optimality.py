"""The proved lower bound on each objective, and the evidence for it.

A lower bound holds if all structures that may have less are refuted.  A refuted structure counts
only if a covering shows it; a script answered by a solver does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from compiler.objectives.cheaper_robots import Less
from compiler.objectives.least_values import Amount
from compiler.objectives.ordered_structures import Limit, structures_by, words_below
from compiler.robots.candidate import Candidate
from compiler.robots.normal_form import RobotFamily
from compiler.words.structures import structures_of
from grammar_lang import ir
from solvers.conclusion import StructureRecord, with_lemmas
from solvers.impossibility.box_evidence import covered
from solvers.lemma import Lemma, VariantLemma
from solvers.run_context import RunContext
from solvers.search.least_search import searched_modules
from solvers.search.objective_result import ObjectiveResult, Optimality
from solvers.search.parameter_bounds import ParameterBounds

MOST_RAISED = 20
"""The number of structures whose bound is raised above what their words give."""
UNDECIDED = ("unresolved", "inadmissible")
NOT_WITH_LESS = "no robot of it with less does the task"


def optimality(
    family: RobotFamily,
    task: ir.Task,
    values: Sequence[Fraction],
    reached: Sequence[Limit],
    known: Sequence[StructureRecord],
    lemmas: Sequence[Lemma],
    context: RunContext,
) -> Optimality:
    """The proved lower bound on each objective.

    Args:
        family: the whole family of the task, without maps.
        task: the task, without maps.
        values: the value of the design in each of its objectives.
        reached: the least value of any design in each objective; the design is within these limits.
        known: the records of the structures that were tried.
        lemmas: the lemmas of the search.
        context: how to search for coverings.

    Raises:
        OutOfTimeError: if there was no time for the coverings.
    """
    due = {
        number
        for number, record in enumerate(known)
        if any(
            _may_be_less(record, reached[:k], each.amount, value)
            for k, (each, value) in enumerate(zip(reached, values, strict=True))
        )
    }
    labels = {lemma.labels for lemma in lemmas if isinstance(lemma, VariantLemma)}
    due |= {number for number, record in enumerate(known) if record.derivation in labels}
    due |= {same for n in due if (same := known[n].same_robot_as) is not None}
    records, late = covered(known, family, task, context, due)
    if late is not None:
        raise late
    bounds = ParameterBounds(family, task, context)
    return _Judgement(family, task, tuple(values), tuple(reached), records, lemmas, bounds).result()


def stated(task: ir.Task, amounts: Sequence[Amount], values: Sequence[Fraction]) -> Optimality:
    """The objectives of a design with no proved bounds."""
    pairs = zip(amounts, values, strict=True)
    found = tuple(
        ObjectiveResult(amount, value, Fraction(0), value, 0, more=True) for amount, value in pairs
    )
    return Optimality(found, task.modules, by_default=False, records=(), dearer=(), lemmas=())


def _may_be_less(
    record: StructureRecord, before: Sequence[Limit], amount: Amount, bound: Fraction
) -> bool:
    """Whether a structure, judged by its word, may be below ``bound`` and within the limits."""
    word = record.word
    if not amount.is_ordering:  # A covering is no evidence for such an objective.
        return False
    within = all(limit.amount.of_word(word) <= limit.most for limit in before)
    return within and amount.of_word(word) < bound


@dataclass(frozen=True, slots=True)
class _Open:
    """The least value of some structures, and the undecided ones; see ``ObjectiveResult``."""

    least: Fraction
    undecided: int
    more: bool
    other: bool


@dataclass(slots=True)
class _Judgement:
    """Derives the bounds from the structures that may have less."""

    family: RobotFamily
    task: ir.Task
    values: tuple[Fraction, ...]
    reached: tuple[Limit, ...]
    known: Sequence[StructureRecord]
    lemmas: Sequence[Lemma]
    bounds: ParameterBounds
    less: list[Less] = field(default_factory=list[Less])
    """Values proved to be out of reach of any robot, for the objectives so far."""
    modules: int | None = field(init=False)
    records: dict[tuple[str, ...], StructureRecord] = field(init=False)
    left: RobotFamily = field(init=False)
    """The robots that no lemma with a covering applies to."""

    def __post_init__(self) -> None:
        self.records = {record.derivation: record for record in self.known}
        amounts = tuple(limit.amount for limit in self.reached)
        self.modules = searched_modules(self.family, self.task, amounts)
        self.lemmas = [lemma for lemma in self.lemmas if self._has_covering(lemma)]
        conditions = tuple(lemma.condition for lemma in self.lemmas)
        self.left = self.family
        if conditions:
            self.left = self.family.with_condition(ir.NotAccept(ir.AnyOf(conditions)))

    def _has_covering(self, lemma: Lemma) -> bool:
        """Whether a lemma is proved without relying on a solver."""
        if not isinstance(lemma, VariantLemma):
            return True
        record = self.records.get(lemma.labels)
        return record is not None and record.boxes is not None

    def result(self) -> Optimality:
        """The proved bound on each objective, with its evidence."""
        results, limits = list[ObjectiveResult](), list[Limit]()
        due: dict[tuple[str, ...], tuple[StructureRecord, StructureRecord]] = {}
        dearer: dict[tuple[str, ...], None] = {}
        for k, value in enumerate(self.values):
            found = self._objective(k, limits)
            results.append(found)
            if found.least > 0:
                for candidate in self._below(found.amount, limits, found.least):
                    record, first = self._evidence(candidate)
                    if record is not None and first is not None:
                        due[record.derivation] = record, first
                words = words_below(found.amount, self.left, self.modules, limits, found.least)
                dearer |= dict.fromkeys(words)
            if found.amount.is_ordering:
                allowed = tuple((limit.amount, limit.most) for limit in limits)
                self.less.append(Less(allowed, found.amount, found.least))
            limits.append(Limit(found.amount, found.least, value))
        used = _Used()
        listed = dict.fromkeys(record.word for record, _ in due.values())
        for derivation in structures_of(self.left.language, listed):
            if derivation.labels in due:
                used.add(*due[derivation.labels])
        for lemma in self.lemmas:
            if isinstance(lemma, VariantLemma):
                used.add(self.records[lemma.labels], self.records[lemma.labels])
        return Optimality(
            tuple(results),
            self.modules,
            self.task.modules is None and self.modules is not None,
            with_lemmas(used.records, self.lemmas),
            tuple(word for word in dearer if word not in listed),
            tuple(self.lemmas),
        )

    def _below(
        self, amount: Amount, limits: Sequence[Limit], bound: Fraction
    ) -> Sequence[Candidate]:
        """The structures within the limits that may be below ``bound``, in order.

        The last one may not have been tried.
        """
        found = list[Candidate]()
        every = structures_by(amount, self.left, self.modules, limits, self.task.origin)
        for candidate in every:
            if amount.of_robot(candidate.derivation.word, candidate.model) >= bound:
                break
            found.append(candidate)
            if candidate.derivation.labels not in self.records:
                break
        return found

    def _objective(self, place: int, limits: Sequence[Limit]) -> ObjectiveResult:
        """The result for one objective; ``limits`` restrict the robots that its bound is about."""
        value, reached = self.values[place], self.reached[place]
        amount, best = reached.amount, reached.least
        before = self.reached[:place]
        if not amount.is_ordering:
            return self._of_motions(amount, before, best, value)
        found = self._open(amount, before, best)
        least, bound = found.least, best
        if [limit.most for limit in limits] != [limit.most for limit in before]:
            least, bound = self._open(amount, limits, value).least, value
        if least < bound and not amount.exact:
            least = self._raised(amount, limits, bound)
        undecided = 0 if least >= best else found.undecided
        return ObjectiveResult(amount, value, least, best, undecided, found.more, found.other)

    def _of_motions(
        self, amount: Amount, before: Sequence[Limit], best: Fraction, value: Fraction
    ) -> ObjectiveResult:
        """The result for an objective that words do not bound: any robot may have less."""
        known = [
            self.records.get(candidate.derivation.labels)
            for candidate in self._below(amount, before, best)
        ]
        undecided = sum(each is not None and each.verdict in UNDECIDED for each in known)
        more = None in known
        return ObjectiveResult(amount, value, Fraction(0), best, undecided, more)

    def _open(self, amount: Amount, limits: Sequence[Limit], bound: Fraction) -> _Open:
        """The least value and the number of structures below a bound that are not refuted."""
        least, undecided, more, other = bound, 0, False, False
        for candidate in self._below(amount, limits, bound):
            record = self.records.get(candidate.derivation.labels)
            if record is not None and self._refuted(candidate)[1] is not None:
                continue
            own = amount.of_robot(candidate.derivation.word, candidate.model)
            least, more = min(least, own), more or record is None
            if record is not None and record.verdict not in ("found", "same"):
                undecided += 1
            other = other or (record is not None and record.verdict == "found")
        return _Open(least, undecided, more, other)

    def _raised(self, amount: Amount, limits: Sequence[Limit], bound: Fraction) -> Fraction:
        """The least value of unrefuted structures below a bound, raised using parameters."""
        allowed = tuple((limit.amount, limit.most) for limit in limits)
        least, raised = bound, 0
        for candidate in self._below(amount, limits, bound):
            if self._refuted(candidate)[1] is not None:
                continue
            own = amount.of_robot(candidate.derivation.word, candidate.model)
            if own >= least:
                break
            if candidate.derivation.labels not in self.records or raised == MOST_RAISED:
                return own
            word, model = candidate.derivation.word, candidate.model
            before = [less for less in self.less if less.is_open(word, model)]
            less = Less(allowed, amount, least)
            least = self.bounds.least(candidate, before, less, reached=least == bound)
            raised += 1
        return least

    def _evidence(
        self, candidate: Candidate
    ) -> tuple[StructureRecord | None, StructureRecord | None]:
        """The record of a structure, and the one proving that no cheaper robot of it will do."""
        record, first = self._refuted(candidate)
        boxes = self.bounds.coverings.get(candidate.derivation.labels)
        if record is None or first is not None or boxes is None:
            return record, first
        about = replace(
            record, verdict="refuted", reason=NOT_WITH_LESS, boxes=boxes, same_robot_as=None
        )
        return about, about

    def _refuted(
        self, candidate: Candidate
    ) -> tuple[StructureRecord | None, StructureRecord | None]:
        """The record of a structure, and that of its robot if a covering refutes it."""
        record = self.records.get(candidate.derivation.labels)
        if record is None:
            return None, None
        first = record if record.same_robot_as is None else self.known[record.same_robot_as]
        if first.verdict != "refuted" or first.boxes is None:
            return record, None
        return record, first


@dataclass(slots=True)
class _Used:
    """Structures with coverings, each once; references to the same robot are renumbered.

    All derivations of a word stand together, in the order in which they are enumerated.
    """

    records: list[StructureRecord] = field(default_factory=list[StructureRecord])
    places: dict[tuple[str, ...], int] = field(default_factory=dict[tuple[str, ...], int])
    robots: dict[tuple[str, ...], int] = field(default_factory=dict[tuple[str, ...], int])

    def add(self, record: StructureRecord, first: StructureRecord) -> None:
        """Add a structure; ``first`` is the record with the evidence about its robot."""
        if record.derivation in self.places:
            return
        place = self.places[record.derivation] = len(self.records)
        same = self.robots.setdefault(first.derivation, place)
        copied = replace(first, word=record.word, derivation=record.derivation, script=None)
        boxes, first_place = (first.boxes, None) if same == place else (None, same)
        self.records.append(replace(copied, lemma=None, boxes=boxes, same_robot_as=first_place))
