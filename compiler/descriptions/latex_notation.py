"""Expressions in LaTeX's mathematics."""

from __future__ import annotations

from collections.abc import Sequence

FUNCTIONS = {"sin": r"\sin", "cos": r"\cos", "tan": r"\tan"}


class LatexNotation:
    r"""``\frac{\ell_{1}^{2} \ell_{2} \cos(q_{2})}{3}``."""

    pi = r"\pi"

    def product(self, factors: Sequence[str]) -> str:
        """Factors side by side."""
        return " ".join(factors)

    def quotient(self, numerator: Sequence[str], denominator: Sequence[str]) -> str:
        """A fraction; what is long stays beside it."""
        short = [part for part in numerator if "(" not in part]
        beside = [part for part in numerator if "(" in part]
        fraction = rf"\frac{{{self.product(short or ['1'])}}}{{{self.product(denominator)}}}"
        return self.product([fraction, *beside])

    def power(self, base: str, exponent: int) -> str:
        """A superscript; a base with one of its own is grouped."""
        return f"{{{base}}}^{{{exponent}}}" if "^" in base else f"{base}^{{{exponent}}}"

    def function(self, name: str, argument: str) -> str:
        """A function or a root."""
        if name == "sqrt":
            return rf"\sqrt{{{argument}}}"
        if name == "abs":
            return rf"\left\lvert {argument} \right\rvert"
        return rf"{FUNCTIONS[name]}\left({argument}\right)"

    def grouped(self, expression: str) -> str:
        """In parentheses."""
        return rf"\left({expression}\right)"

    def named(self, number: int) -> str:
        """``w_{1}``."""
        return f"w_{{{number}}}"
