"""Budgets for exact answers, and the errors raised when they are used up."""

from __future__ import annotations

MOVE_BUDGET = 200_000
"""The most moves (of a state under a symbol) that are made to count or compare words."""


LENGTH_LIMIT = 1_000_000
"""Longer words are not listed, counted or compared."""


class BudgetExceededError(ValueError):
    """A question about a language would take more moves than allowed."""

    def __init__(self, question: str, budget: int, reason: str) -> None:
        super().__init__(f"{question} needs more than {budget} moves: {reason}")
        self.budget = budget


class WordsTooLongError(BudgetExceededError):
    """A question is about words of more than ``LENGTH_LIMIT`` symbols."""

    def __init__(self) -> None:
        ValueError.__init__(self, f"words of more than {LENGTH_LIMIT} symbols are not looked at")
        self.budget = LENGTH_LIMIT
