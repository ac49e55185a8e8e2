"""The structures of a family in the order of an objective, the least first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import count

from compiler.objectives.least_values import Amount
from compiler.robots.candidate import Candidate, candidates_of
from compiler.robots.normal_form import RobotFamily
from compiler.words.finite_automaton import AutomatonTooLargeError
from compiler.words.language import Language, restrict
from compiler.words.weighted_words import weight_at_most, words_by_weight
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Limit:
    """The largest value that structures may have of an objective whose minimum is ``least``.

    It is at least the ``value`` of a design.
    """

    amount: Amount
    least: Fraction
    value: Fraction = Fraction(0)

    @property
    def most(self) -> Fraction:
        """The largest value allowed: the least one plus the objective's tolerance."""
        return max(self.value, self.least * (1 + self.amount.objective.within))

    def allows(self, word: Sequence[str], candidate: Candidate) -> bool:
        """Whether a structure may satisfy the limit."""
        return self.amount.of_robot(word, candidate.model) <= self.most


def structures_by(
    amount: Amount,
    family: RobotFamily,
    modules: int | None,
    limits: Sequence[Limit],
    origin: ir.Origin | None,
) -> Iterator[Candidate]:
    """The structures that may satisfy some limits, ordered by their least value of an objective.

    Structures with equal values are ordered by the weight of their words, then by length, then as
    in section 2.

    Args:
        amount: the objective.
        family: the robots.
        modules: the largest number of modules; None means any.
        limits: the limits for other objectives.
        origin: the existing robot of the task, if there is one.
    """
    language = _within(family.language, modules, limits)
    waiting: list[tuple[Fraction, int, Candidate]] = []
    numbers = count()
    for weight, word in words_by_weight(language, amount.weights, max_modules=modules):
        while waiting and waiting[0][0] <= weight:
            yield heappop(waiting)[2]
        if not word:
            continue
        for candidate in candidates_of(family, [word], origin):
            if all(limit.allows(word, candidate) for limit in limits):
                least = amount.of_robot(word, candidate.model)
                heappush(waiting, (least, next(numbers), candidate))
    while waiting:
        yield heappop(waiting)[2]


def words_below(
    amount: Amount,
    family: RobotFamily,
    modules: int | None,
    limits: Sequence[Limit],
    bound: Fraction,
) -> Iterator[tuple[str, ...]]:
    """The words that weigh less than ``bound`` in an objective, and satisfy the limits.

    The arguments are those of :func:`structures_by`.
    """
    language = _within(family.language, modules, limits)
    for weight, word in words_by_weight(language, amount.weights, max_modules=modules):
        if weight >= bound:
            return
        if word and all(limit.amount.of_word(word) <= limit.most for limit in limits):
            yield word


def _within(language: Language, modules: int | None, limits: Sequence[Limit]) -> Language:
    """The words whose weights satisfy limits, as far as automata for this are not too large."""
    for limit in limits:
        if not limit.amount.weights:
            continue
        try:
            within = weight_at_most(
                language.srg.terminals,
                limit.amount.weights,
                limit.most,
                inside=language.condition(modules),
            )
        except AutomatonTooLargeError:
            continue
        language = restrict(language.srg, within)
    return language
