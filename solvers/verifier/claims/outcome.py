"""The answers of the verifier, and how a claim is turned down."""

from __future__ import annotations

from enum import Enum


class Outcome(Enum):
    """The verifier's answer; ``ASSUMING_Z3`` rests on a solver's word."""

    VALID = "valid"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    ASSUMING_Z3 = "valid, assuming z3"


class Refused(Exception):
    """A claim that is false, or that cannot be judged."""

    def __init__(self, reason: str, outcome: Outcome = Outcome.REFUTED) -> None:
        super().__init__(reason)
        self.outcome = outcome
