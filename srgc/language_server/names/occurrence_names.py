"""How a word calls its symbols (section "Names" of the language), from the syntax alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from grammar_lang import syntax as s


def named_positions(
    symbols: Sequence[s.Ident], aliases: Sequence[s.Ident | None], taken: Collection[str]
) -> dict[str, int]:
    """The position that each name means.

    X where it occurs once, X1 to Xn where it occurs n times, and the names given in the production.

    Args:
        symbols: the word.
        aliases: the name given to each of its symbols, if there is one.
        taken: names of symbols, which no numbered occurrence can have.
    """
    total = Counter(symbol.text for symbol in symbols)
    seen: Counter[str] = Counter()
    found: dict[str, int] = {}
    for position, symbol in enumerate(symbols):
        seen[symbol.text] += 1
        numbered = f"{symbol.text}{seen[symbol.text]}"
        if total[symbol.text] == 1:
            found[symbol.text] = position
        elif numbered not in taken:
            found[numbered] = position
    for position, alias in enumerate(aliases):
        if alias is not None:
            found[alias.text] = position
    return found
