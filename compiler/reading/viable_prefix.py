"""How far a word is the beginning of a word of a grammar."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.grammars.binary_normal_form import BinaryGrammar
from compiler.reading.residuals import Residuals


def viable_prefix(grammar: BinaryGrammar, names: Sequence[str], word: Sequence[str]) -> int:
    """The length of the longest prefix of ``word`` with which some word of the grammar begins.

    ``names`` are those of the grammar's terminals.  For an empty language it is 0.
    """
    residual = Residuals(grammar, names).root
    for length, symbol in enumerate(word):
        try:
            residual = residual[symbol]
        except KeyError:
            return length
    return len(word)
