"""What is exact up to a budget says so when the budget is used up."""

from __future__ import annotations

MOVE_BUDGET = 200_000
"""So many moves, a state with a symbol each, are made to count or compare words."""


LENGTH_LIMIT = 1_000_000
"""No words of more symbols are listed, counted or compared."""


class BudgetExceededError(ValueError):
    """A question about a language that would take more moves than were allowed."""

    def __init__(self, question: str, budget: int, reason: str) -> None:
        super().__init__(f"{question} needs more than {budget} moves: {reason}")
        self.budget = budget


class WordsTooLongError(BudgetExceededError):
    """A question about words of more than ``LENGTH_LIMIT`` symbols."""

    def __init__(self) -> None:
        ValueError.__init__(self, f"words of more than {LENGTH_LIMIT} symbols are not looked at")
        self.budget = LENGTH_LIMIT
