"""Membership in any context-free language, ambiguous or not, by the residuals of prefixes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from operator import getitem

from compiler.grammars.binary_normal_form import BinaryGrammar
from compiler.reading.residuals import Residuals


class ResidualReader:
    """The words of a grammar over terminals with these names."""

    def __init__(self, grammar: BinaryGrammar, names: Sequence[str]) -> None:
        self.residuals = Residuals(grammar, names)

    def accepts(self, word: Iterable[str]) -> bool:
        """Whether the word is in the language; a word with an unknown token is not."""
        try:
            return reduce(getitem, word, self.residuals.root).accepting
        except KeyError:
            return False
