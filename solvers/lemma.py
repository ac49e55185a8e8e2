"""What one refutation says of many structures: a condition on words, and why it refutes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

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
    VariantClaim,
    WeightsClaim,
    lemma_text,
)


@dataclass(frozen=True, slots=True)
class DistanceLemma:
    """No robot of a word of the family with this ``condition`` has an effector in ``region``."""

    condition: ir.Accept
    automaton: Dfa
    region: str
    bound: EffectorBound

    def is_about(self, word: Sequence[str]) -> bool:
        """Whether a word satisfies the condition."""
        return self.automaton.accepts(word)

    @property
    def text(self) -> str:
        """The lemma in words."""
        return lemma_text(self.claim())

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
class VariantLemma:
    """All robots with this ``condition`` are variants of a refuted one, given by its derivation."""

    condition: ir.Accept
    automaton: Dfa
    word: tuple[str, ...]
    labels: tuple[str, ...]

    def is_about(self, word: Sequence[str]) -> bool:
        """Whether a word satisfies the condition."""
        return self.automaton.accepts(word)

    @property
    def text(self) -> str:
        """The lemma in words."""
        return lemma_text(self.claim())

    def claim(self, script: str | None = None, boxes: str | None = None) -> VariantClaim:
        """The lemma as a certificate states it, with the files that refute the one robot."""
        condition = condition_text(self.condition)
        return VariantClaim(VARIANTS, condition, self.word, self.labels, script, boxes)


@dataclass(frozen=True, slots=True)
class WeightsLemma:
    """All robots with this ``condition`` are one with weights, whose drives ``boxes`` refute."""

    condition: ir.Accept
    automaton: Dfa
    word: tuple[str, ...]
    labels: tuple[str, ...]
    most: int
    boxes: str

    def is_about(self, word: Sequence[str]) -> bool:
        """Whether a word satisfies the condition."""
        return self.automaton.accepts(word)

    @property
    def text(self) -> str:
        """The lemma in words."""
        return lemma_text(self.claim(""))

    def claim(self, boxes: str = "") -> WeightsClaim:
        """The lemma as a certificate states it, with the file of the covering."""
        condition = condition_text(self.condition)
        return WeightsClaim(WEIGHTS, condition, self.word, self.labels, self.most, boxes)


Lemma: TypeAlias = DistanceLemma | VariantLemma | WeightsLemma


def covers(lemma: Lemma, other: Lemma) -> bool:
    """Whether one lemma is about all words that another one is about."""
    return intersection(other.automaton, complement(lemma.automaton)).longest() == -1
