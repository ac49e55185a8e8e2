"""How often conditions were not proved in a run, so that a remedy is told once, not every time."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

OFTEN = 3
"""The failures of a condition after which a remedy is told."""


@dataclass(slots=True)
class FailureCounts:
    """The number of failed proofs by the condition that was not proved."""

    counts: Counter[str] = field(default_factory=Counter[str])
    told: bool = False

    def often(self, name: str) -> bool:
        """Count a failure; return whether a condition has now failed often, for the first time."""
        self.counts[name] += 1
        if self.told or self.counts[name] < OFTEN:
            return False
        self.told = True
        return True
