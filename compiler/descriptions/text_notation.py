"""Expressions as plain text that computer algebra systems read, too."""

from __future__ import annotations

from collections.abc import Sequence


class TextNotation:
    """``l1^2*l2*cos(q2)/3``."""

    pi = "pi"

    def product(self, factors: Sequence[str]) -> str:
        """Factors with asterisks."""
        return "*".join(factors)

    def quotient(self, numerator: Sequence[str], denominator: Sequence[str]) -> str:
        """One line; several divisors in parentheses."""
        below = self.product(denominator)
        return f"{self.product(numerator)}/{below if len(denominator) == 1 else f'({below})'}"

    def power(self, base: str, exponent: int) -> str:
        """With a caret."""
        return f"{base}^{exponent}"

    def function(self, name: str, argument: str) -> str:
        """A call."""
        return f"{name}({argument})"

    def grouped(self, expression: str) -> str:
        """In parentheses."""
        return f"({expression})"

    def named(self, number: int) -> str:
        """``w1``."""
        return f"w{number}"
