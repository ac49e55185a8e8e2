"""The verifier's answer and its reasons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from solvers.verifier.proofs.checked_condition import CheckedCondition, decisive
from solvers.verifier.proofs.tube_checks import Status

# --- The answers of the verifier, and how a claim is rejected -------------------------------------


class Outcome(Enum):
    """The verifier's answer.

    ``UNCHECKED``: part of the evidence is scripts, and no solver was asked to run them.
    ``UNEXPECTED``: the certificate is about another task or verdict than was asked for, and was not
    judged. ``DISAGREEMENT``: two trusted solvers contradict each other.
    """

    VALID = "valid"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    UNCHECKED = "not checked"
    UNEXPECTED = "not as expected"
    DISAGREEMENT = "disagreement"


class Refused(Exception):
    """A claim that is false, or that cannot be judged."""

    def __init__(self, reason: str, outcome: Outcome = Outcome.REFUTED) -> None:
        super().__init__(reason)
        self.outcome = outcome


# --- The report -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Report:
    """The result of a check; ``level`` is the level of the weakest evidence.

    ``task``, ``spec`` (its main file) and ``spec_sha256`` (of all its files) are those that the
    certificate names; None if it cannot be read. ``control`` is what drives the claimed robot:
    "open loop" or "feedback"; None if there is no robot or nothing drives it.
    """

    outcome: Outcome
    verdict: str | None
    level: str | None
    reason: str | None
    conditions: tuple[CheckedCondition, ...] = ()
    task: str | None = None
    spec: str | None = None
    spec_sha256: str | None = None
    control: str | None = None


def concluded(conditions: Sequence[CheckedCondition]) -> Report:
    """The report on a found robot: violated conditions refute it, open ones leave it undecided."""
    due = decisive(conditions)
    if due is None:
        return Report(Outcome.VALID, "found", "validated", None, tuple(conditions))
    outcome = Outcome.REFUTED if due.status is Status.FAILS else Outcome.UNDECIDED
    return Report(outcome, "found", None, due.reason, tuple(conditions))
