"""What one refutation says of many structures: words whose robots have no effector in a region."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compiler.expressions.exact_numbers import exact_text
from compiler.lemmas.effector_bounds import EffectorBound, HalfSpaceBound
from compiler.words.finite_automaton import Dfa, complement, intersection
from grammar_lang import ir
from grammar_lang.conditions import condition_text
from solvers.verifier.claims.lemma_claims import TOO_FAR, TOO_NEAR, LemmaClaim, lemma_text


@dataclass(frozen=True, slots=True)
class DistanceLemma:
    """No robot of a word of the family with this ``condition`` has an effector in ``region``."""

    condition: ir.Accept
    region: str
    bound: EffectorBound
    automaton: Dfa

    def is_about(self, word: Sequence[str]) -> bool:
        """Whether a word satisfies the condition."""
        return self.automaton.accepts(word)

    def covers(self, other: DistanceLemma) -> bool:
        """Whether this one is about all words that another one is about."""
        left = intersection(other.automaton, complement(self.automaton))
        return left.longest() == -1

    @property
    def argument(self) -> str:
        """Which kind of bound it is."""
        return TOO_FAR if isinstance(self.bound, HalfSpaceBound) else TOO_NEAR

    @property
    def text(self) -> str:
        """The lemma in words."""
        return lemma_text(self.claim())

    def claim(self) -> LemmaClaim:
        """The lemma as a certificate states it."""
        if isinstance(self.bound, HalfSpaceBound):
            vector, bound = self.bound.normal, self.bound.reach
        else:
            vector, bound = self.bound.centre, self.bound.distance
        return LemmaClaim(
            self.argument, condition_text(self.condition), self.region,
            tuple(exact_text(x) for x in vector), exact_text(bound),
        )  # fmt: skip
