"""What is proved of the least of each objective, and what that rests on.

No robot has less than so much, as far as all structures that may have less are refuted.  A refuted
structure counts if a covering shows it; a script that a solver has answered does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction

from compiler.objectives.cheaper_robots import Less
from compiler.objectives.least_values import Amount
from compiler.objectives.objective_text import amount_text, value_text
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
from solvers.search.parameter_bounds import ParameterBounds
from solvers.search.time_bound import TimeBound

MOST_RAISED = 20
"""So many structures are shown to have more of an objective than their words say."""
NOT_WITH_LESS = "no robot of it with less does the task"


@dataclass(frozen=True, slots=True)
class ObjectiveResult:
    """What the design has of an objective, and the least that is proved of all robots.

    ``value`` and ``least`` are in SI units: no robot that has of the objectives before what these
    leave has less than ``least``.  Of some design they have ``reached`` so much.  So many robots
    that may have less than that are ``undecided``; where not all of them were looked at, there may
    be ``more``.
    """

    amount: Amount
    value: Fraction
    least: Fraction
    reached: Fraction
    undecided: int
    more: bool

    @property
    def is_least(self) -> bool:
        """Whether no robot has less than the design."""
        return self.least >= self.value and self._is_settled

    @property
    def _is_settled(self) -> bool:
        """Whether no robot has less than some design."""
        return self.least >= self.reached and not self.undecided and not self.more

    @property
    def gap(self) -> Fraction | None:
        """By which part of the proved least the best design is above it; None where that is 0."""
        return self.reached / self.least - 1 if self.least > 0 else None

    @property
    def text(self) -> str:
        """What is known of it, in words."""
        said = self._best_text()
        if self.value > self.reached:
            return f"{amount_text(self.amount.objective, self.value)} ({said})"
        return said

    def _best_text(self) -> str:
        best = amount_text(self.amount.objective, self.reached)
        if self._is_settled:
            return f"least {best}"
        if self.amount.is_ordering and (self.undecided or self.more):
            return f"least {best}, unless {self._others()} for less"
        if self.gap is None:
            return best
        least = value_text(self.amount.objective, self.least)
        return f"{best}; no robot has less than {least} (gap {gap_text(self.gap)})"

    def _others(self) -> str:
        """The robots that may have less, and do it."""
        if not self.undecided:
            return "a robot that was not tried does it"
        which = "the undecided robot"
        if self.undecided > 1:
            which = f"one of {self.undecided} undecided robots"
        return f"{which}, or one that was not tried, does it" if self.more else f"{which} does it"


@dataclass(frozen=True, slots=True)
class Optimality:
    """The objectives of a design, and the evidence for the least of each.

    ``modules`` is the bound on modules that they are about, None without one; ``by_default`` it is
    not that of the task.  ``records`` are the structures that may have less, all with coverings,
    and those whose variants the ``lemmas`` are about; ``dearer`` are words of which each robot has
    as much.  The least time rests on ``time``, ``untimed`` says why there is no bound on it.
    """

    objectives: tuple[ObjectiveResult, ...]
    modules: int | None
    by_default: bool
    records: tuple[StructureRecord, ...]
    dearer: tuple[tuple[str, ...], ...]
    lemmas: tuple[Lemma, ...]
    time: TimeBound | None = None
    untimed: str | None = None

    def with_least_time(self, least: Fraction, bound: TimeBound | None = None) -> Optimality:
        """The same with the time that no motion of any robot is below, in s.

        It needs no ``bound`` where the task allows no motion of fewer steps.
        """
        objectives = (
            replace(each, least=least, more=False) if each.amount.objective.kind == "time" else each
            for each in self.objectives
        )
        return replace(self, objectives=tuple(objectives), time=bound)

    @property
    def text(self) -> str:
        """What is known of the objectives, in words."""
        known = "; then ".join(each.text for each in self.objectives)
        bound = f", of robots with up to {self.modules} modules" if self.by_default else ""
        return known + bound


def optimality(
    family: RobotFamily,
    task: ir.Task,
    values: Sequence[Fraction],
    reached: Sequence[Limit],
    known: Sequence[StructureRecord],
    lemmas: Sequence[Lemma],
    context: RunContext,
) -> Optimality:
    """What is proved of the least of each objective.

    Args:
        family: the whole family of the task, without maps.
        task: the task, without maps.
        values: what the design has of each of its objectives.
        reached: the least that designs have of each, which the design is within.
        known: what became of the structures that were tried.
        lemmas: those of the search.
        context: how to search for coverings.

    Raises:
        OutOfTimeError: there was no time for the coverings.
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
    """The objectives of a design of which nothing is proved but what it has."""
    pairs = zip(amounts, values, strict=True)
    found = tuple(
        ObjectiveResult(amount, value, Fraction(0), value, 0, more=True) for amount, value in pairs
    )
    return Optimality(found, task.modules, by_default=False, records=(), dearer=(), lemmas=())


def _may_be_less(
    record: StructureRecord, before: Sequence[Limit], amount: Amount, bound: Fraction
) -> bool:
    """Whether a structure may be within limits and below a bound, by its word."""
    word = record.word
    within = all(limit.amount.of_word(word) <= limit.most for limit in before)
    return within and amount.of_word(word) < bound


@dataclass(slots=True)
class _Judgement:
    """What the structures that may have less come to."""

    family: RobotFamily
    task: ir.Task
    values: tuple[Fraction, ...]
    reached: tuple[Limit, ...]
    known: Sequence[StructureRecord]
    lemmas: Sequence[Lemma]
    bounds: ParameterBounds
    less: list[Less] = field(default_factory=list[Less])
    """What no robot has, of the objectives so far."""
    modules: int | None = field(init=False)
    records: dict[tuple[str, ...], StructureRecord] = field(init=False)
    left: RobotFamily = field(init=False)
    """The robots that no lemma with a covering is about."""

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
        """Whether no solver has to be believed for a lemma."""
        if not isinstance(lemma, VariantLemma):
            return True
        record = self.records.get(lemma.labels)
        return record is not None and record.boxes is not None

    def result(self) -> Optimality:
        """What is proved of each objective, and what that rests on."""
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
        """The structures within limits that may have less than so much of an objective, in order.

        The last one may be one that was not tried.
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
        """What is known of an objective, and proved of robots within limits."""
        value, reached = self.values[place], self.reached[place]
        amount, best = reached.amount, reached.least
        if not amount.is_ordering:
            return ObjectiveResult(amount, value, Fraction(0), best, 0, more=False)
        before = self.reached[:place]
        least, undecided, more = self._open(amount, before, best)
        bound = best
        if [limit.most for limit in limits] != [limit.most for limit in before]:
            least, _, _ = self._open(amount, limits, value)
            bound = value
        if least < bound and not amount.exact:
            least = self._raised(amount, limits, bound)
        undecided = 0 if least >= best else undecided
        return ObjectiveResult(amount, value, least, best, undecided, more)

    def _open(
        self, amount: Amount, limits: Sequence[Limit], bound: Fraction
    ) -> tuple[Fraction, int, bool]:
        """Of structures below a bound that are not refuted the least, their number, and if more."""
        least, undecided, more = bound, 0, False
        for candidate in self._below(amount, limits, bound):
            record = self.records.get(candidate.derivation.labels)
            if record is not None and self._refuted(candidate)[1] is not None:
                continue
            own = amount.of_robot(candidate.derivation.word, candidate.model)
            least, more = min(least, own), more or record is None
            if record is not None and record.verdict not in ("found", "same"):
                undecided += 1
        return least, undecided, more

    def _raised(self, amount: Amount, limits: Sequence[Limit], bound: Fraction) -> Fraction:
        """The least of structures below a bound that are not refuted, by their parameters, too."""
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
            before = [less for less in self.less if _may_have(candidate, less)]
            less = Less(allowed, amount, least)
            least = self.bounds.least(candidate, before, less, reached=least == bound)
            raised += 1
        return least

    def _evidence(
        self, candidate: Candidate
    ) -> tuple[StructureRecord | None, StructureRecord | None]:
        """The record of a structure, and the one that shows that none with less does the task."""
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


def _may_have(candidate: Candidate, less: Less) -> bool:
    """Whether a robot of a structure may have less, by its word."""
    word, model = candidate.derivation.word, candidate.model
    within = all(amount.of_robot(word, model) <= most for amount, most in less.limits)
    return within and less.amount.of_robot(word, model) < less.bound


@dataclass(slots=True)
class _Used:
    """Structures with coverings, each once; what is the same robot as others is numbered here.

    All derivations of a word stand together, in the order in which they are listed anew.
    """

    records: list[StructureRecord] = field(default_factory=list[StructureRecord])
    places: dict[tuple[str, ...], int] = field(default_factory=dict[tuple[str, ...], int])
    robots: dict[tuple[str, ...], int] = field(default_factory=dict[tuple[str, ...], int])

    def add(self, record: StructureRecord, first: StructureRecord) -> None:
        """A structure; ``first`` is the record with the evidence about its robot."""
        if record.derivation in self.places:
            return
        place = self.places[record.derivation] = len(self.records)
        same = self.robots.setdefault(first.derivation, place)
        copied = replace(first, word=record.word, derivation=record.derivation, script=None)
        boxes, first_place = (first.boxes, None) if same == place else (None, same)
        self.records.append(replace(copied, lemma=None, boxes=boxes, same_robot_as=first_place))


def gap_text(gap: Fraction) -> str:
    """A gap in percent, in two digits that say no less than it is."""
    percent = 100 * gap
    digits = Context(prec=2, rounding=ROUND_CEILING)
    return f"{digits.divide(Decimal(percent.numerator), Decimal(percent.denominator)):f} %"
