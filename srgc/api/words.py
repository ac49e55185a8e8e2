"""The words of a family of robots."""

from __future__ import annotations

from collections.abc import Sequence

from srgc.api.program import Program
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault
from srgc.session import chosen


@spoken
def words(
    program: Program,
    *,
    grammar: str | None = None,
    max_length: int | None = None,
    limit: int = 100,
) -> list[str]:
    """The first words of a family, the shorter ones first; a word is a robot.

    Args:
        program: the specification.
        grammar: the family; may be left out where there is one.
        max_length: no longer words than so many symbols.
        limit: how many words.

    Returns:
        Words, each the symbols of its modules and edges with blanks between them.

    Raises:
        SrgcError: there is no such grammar, or several and none is named.
    """
    from srgc.text_reports.word_list import listed

    if limit < 0 or (max_length is not None and max_length < 0):
        raise UsageFault("`limit` and `max_length` are not negative")
    family = chosen(program.ir.grammars, grammar, "grammar")
    return list(listed(program.ir, family, max_length, limit))


def symbols(word: str | Sequence[str]) -> tuple[str, ...]:
    """The symbols of a word that is given as a text with blanks, or as its symbols."""
    return tuple(word.split() if isinstance(word, str) else word)
