"""What is exact up to a budget says so when the budget is used up."""

from __future__ import annotations

MOVE_BUDGET = 200_000
"""So many moves, a state with a symbol each, are made to count or compare words."""


class BudgetExceededError(ValueError):
    """A question about a language that would take more moves than were allowed."""

    def __init__(self, question: str, budget: int, reason: str) -> None:
        super().__init__(f"{question} needs more than {budget} moves: {reason}")
        self.budget = budget
