"""Lemmas: a condition on words, and why it refutes every structure whose word satisfies it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from compiler.expressions.exact_numbers import exact_text
from compiler.lemmas.effector_bounds import EffectorBound, HalfSpaceBound
from compiler.words.finite_automaton import Dfa, complement, intersection
from grammar_lang import ir
from grammar_lang.conditions import condition_text
from solvers.verifier.claims.lemma_claims import (
    TOO_FAR,
    TOO_NEAR,
    VARIANTS,
    WEIGHTS,
    DistanceClaim,
    LemmaClaim,
    VariantClaim,
    WeightsClaim,
    lemma_text,
)


@dataclass(frozen=True, slots=True)
class Lemma(ABC):
    """No robot of the family whose word satisfies ``condition`` can do the task."""

    condition: ir.Accept
    automaton: Dfa

    @abstractmethod
    def claim(self) -> LemmaClaim:
        """The lemma as a certificate states it, without file names."""

    @property
    def text(self) -> str:
        """The lemma in words."""
        return lemma_text(self.claim())

    def is_about(self, word: Sequence[str]) -> bool:
        """Whether a word satisfies the condition."""
        return self.automaton.accepts(word)

    def covers(self, other: Lemma) -> bool:
        """Whether this lemma applies to every word that the other one applies to."""
        left = intersection(other.automaton, complement(self.automaton))
        return left.longest() == -1


@dataclass(frozen=True, slots=True)
class DistanceLemma(Lemma):
    """No effector of these robots can reach ``region``."""

    region: str
    bound: EffectorBound

    def claim(self) -> DistanceClaim:
        """The lemma as a certificate states it."""
        if isinstance(self.bound, HalfSpaceBound):
            argument, vector, bound = TOO_FAR, self.bound.normal, self.bound.reach
        else:
            argument, vector, bound = TOO_NEAR, self.bound.centre, self.bound.distance
        return DistanceClaim(
            argument, condition_text(self.condition), self.region,
            tuple(exact_text(x) for x in vector), exact_text(bound),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class VariantLemma(Lemma):
    """All these robots are variants of a refuted robot, given by its ``word`` and derivation."""

    word: tuple[str, ...]
    labels: tuple[str, ...]

    def claim(self, script: str | None = None, boxes: str | None = None) -> VariantClaim:
        """The lemma as a certificate states it, with the files that refute the base robot."""
        condition = condition_text(self.condition)
        return VariantClaim(VARIANTS, condition, self.word, self.labels, script, boxes)


@dataclass(frozen=True, slots=True)
class WeightsLemma(Lemma):
    """These robots are one robot plus weights; ``boxes`` shows that its drives are too weak."""

    word: tuple[str, ...]
    labels: tuple[str, ...]
    most: int
    boxes: str

    def claim(self, boxes: str = "") -> WeightsClaim:
        """The lemma as a certificate states it, with the file of the covering."""
        condition = condition_text(self.condition)
        return WeightsClaim(WEIGHTS, condition, self.word, self.labels, self.most, boxes)
