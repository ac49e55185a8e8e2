"""The answers of the verifier, and how a claim is turned down."""

from __future__ import annotations

from enum import Enum


class Outcome(Enum):
    """The verifier's answer.

    ``UNCHECKED``: what is left are scripts that no solver was asked to run.  ``UNEXPECTED``: the
    certificate is about another task or verdict than was asked for, and was not judged.
    """

    VALID = "valid"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    UNCHECKED = "not checked"
    UNEXPECTED = "not as expected"


class Refused(Exception):
    """A claim that is false, or that cannot be judged."""

    def __init__(self, reason: str, outcome: Outcome = Outcome.REFUTED) -> None:
        super().__init__(reason)
        self.outcome = outcome
