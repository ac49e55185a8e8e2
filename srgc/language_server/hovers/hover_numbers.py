"""The SI value of the number under the cursor."""

from __future__ import annotations

import re
from fractions import Fraction

from grammar_lang.parsing.tokens import NUMBER, Tokens, tokenise
from grammar_lang.source import Span
from grammar_lang.units import UNIT_NAMES, describe, unit
from srgc.language_server.hovers.quantity_text import in_si

_NAMES = "|".join(sorted(UNIT_NAMES, key=len, reverse=True))
_UNIT = re.compile(
    rf"\s*((?:{_NAMES})(?:\^-?[0-9]+)?(?:[*/](?:{_NAMES})(?:\^-?[0-9]+)?)*)(?![A-Za-z0-9_.(])"
)
_CLOSING = {")": "(", "]": "[", "}": "{"}
_FAR = 400
"""A list's unit is looked for among so many tokens."""


def _unit_after(text: str, end: int) -> tuple[str, int] | None:
    found = _UNIT.match(text, end)
    return None if found is None else (found[1], found.end())


def _list_unit(tokens: Tokens, index: int) -> tuple[str, int] | None:
    """The unit behind the bracket that closes about a token."""
    depth = 0
    for here in range(index + 1, min(index + _FAR, len(tokens))):
        kind = tokens.kinds[here]
        if kind in _CLOSING.values():
            depth += 1
        elif kind in _CLOSING and depth:
            depth -= 1
        elif kind in _CLOSING:
            found = _unit_after(tokens.text, tokens.ends[here])
            if found is not None or kind != ")":
                return found
        elif kind == ";" and depth == 0 and not _in_inequalities(tokens, here):
            return None
    return None


def _in_inequalities(tokens: Tokens, index: int) -> bool:
    """Whether a semicolon stands between the inequalities of a polytope."""
    for here in range(index, 0, -1):
        if tokens.kinds[here] == "}":
            return False
        if tokens.kinds[here] == "{":
            return tokens.at(here - 1) == "polytope"
    return False


def hover_number(text: str, offset: int) -> tuple[str, Span] | None:
    """The value of the number with a unit at an offset, in SI; None where there is none."""
    tokens = tokenise(text)
    for index, start in enumerate(tokens.starts):
        if start > offset:
            break
        if tokens.kinds[index] != NUMBER:
            continue
        own = _unit_after(text, tokens.ends[index])
        stop = tokens.ends[index] if own is None else own[1]
        if not start <= offset <= stop:
            continue
        found = own or _list_unit(tokens, index)
        number = tokens.at(index)
        read = None if found is None or len(number) > 40 else unit(found[0])
        if found is None or read is None or abs(_exponent(number)) > 40:
            return None
        value = in_si(Fraction(number), read)
        written = f"{number} {found[0]}"
        what = describe(read.dimension) if not read.angular else "an angle or a rate of it"
        return f"`{written}` = {value}\n\nIn SI units; {what}.", Span(start, stop)
    return None


def _exponent(number: str) -> int:
    return int(number.lower().partition("e")[2] or 0)
