"""Repairs of a statement at the token that does not fit: add, remove or replace one token.

Repairs are tried on the states of the parser only.  With one, the message can say what to write,
and the statement need not be dropped.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from grammar_lang.parsing.habits import FOREIGN
from grammar_lang.parsing.tables import RESERVED, Tables
from grammar_lang.parsing.tokens import NUMBER, SKIPPED, WORD, Tokens
from grammar_lang.units import UNIT_NAMES

_NAMES = "|".join(sorted(UNIT_NAMES, key=lambda name: (-len(name), name)))
UNIT = re.compile(
    rf"(?:{_NAMES})(?:\^-?[0-9]+)?(?:[*/](?:{_NAMES})(?:\^-?[0-9]+)?)*(?![A-Za-z0-9_.(])"
)
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

MOST_LINES = 4
"""The most preceding line ends at which a missing ``;`` is tried."""
MOST_TOKENS = 500
"""Longer statements are not repaired."""

_INSTEAD = {
    "**": ("^",),
    "&&": ("and",),
    "&": ("and",),
    "||": ("or",),
    "|": ("or",),
    "!": ("not",),
    "~": ("not",),
    "=": ("==", "<=", "in", ":"),
    ":": ("=", "in"),
    "==": ("=", "<="),
    ":=": ("=",),
    "::=": ("->",),
    "=>": ("->", "implies"),
    "->": ("implies", "."),
    "<": ("<=",),
    ">": (">=", "->"),
    ",": (";", "and", "then", "x"),
    "and": (",", "then"),
    ";": (",",),
    "*": ("x",),
    "@": ("*",),
    ".": ("*",),
    "\N{RIGHTWARDS ARROW}": ("->",),
    "\N{LESS-THAN OR EQUAL TO}": ("<=",),
    "\N{GREATER-THAN OR EQUAL TO}": (">=",),
    "\N{MINUS SIGN}": ("-",),
    "\N{EN DASH}": ("-",),
    "\N{MULTIPLICATION SIGN}": ("x", "*"),
    "\N{MIDDLE DOT}": ("*",),
    "\N{DOT OPERATOR}": ("*",),
    "\N{LOGICAL AND}": ("and",),
    "\N{LOGICAL OR}": ("or",),
    "\N{NOT SIGN}": ("not",),
}
"""Terminals that other notations, or texts copied from documents, write differently."""
_ONLY_WHOLE = frozenset({";", ",", "and", ".", "->", "*", "|"})
"""Tokens with so many uses that a repair must mend the whole statement."""
_SUPERFLUOUS = frozenset({"=", ":", ",", "=="})
_CHANGED = frozenset({SKIPPED, "=", "==", "<=", "in", ":"})
_MISSING = (",", ":", "in", "<=", "==", "=", "->", "x", "with", "*")
_CLOSERS = {"(": ")", "[": "]", "{": "}"}


@dataclass(frozen=True, slots=True)
class Repair:
    """Terminals that replace tokens, or a terminal to add before the token ``here``.

    ``instead`` maps a token to its new terminal, or to SKIPPED if it is left out; if it is empty,
    ``missing`` is added before the token ``here``.  ``whole`` is whether the statement then fits up
    to its end, the token ``stop``.
    """

    here: int
    stop: int
    instead: Mapping[int, str] = field(default_factory=dict[int, str])
    missing: str = ""
    whole: bool = False

    @property
    def plain(self) -> bool:
        """Whether it only respells one operator, so that what follows may have its own errors."""
        return len(self.instead) == 1 and not _CHANGED & {*self.instead.values()}

    @property
    def supplied(self) -> bool:
        """Whether a ``;`` or a ``}`` is supplied, before which the statement is parsed again."""
        return self.missing in {";", "}"}


@dataclass(slots=True)
class Trial:
    """A stack of states that consumes tokens without making values or changing the tokens."""

    tables: Tables
    tokens: Tokens
    states: list[int]
    instead: Mapping[int, str] = field(default_factory=dict[int, str])

    def shift(self, terminal: str) -> bool:
        """Consume a terminal; False if it does not fit."""
        return self.tables.shift(self.states, terminal)

    def accepts(self, terminal: str) -> bool:
        """Whether a terminal would fit."""
        return self.tables.accepts(self.states, terminal)

    def take(self, here: int) -> int | None:
        """Consume a token and return the next one; None if it does not fit."""
        terminal, after = self._terminal(here)
        return after if terminal == SKIPPED or self.shift(terminal) else None

    def run(self, here: int, stop: int) -> int:
        """Consume tokens from ``here`` on; return the first that does not fit, or ``stop``."""
        while here < stop:
            after = self.take(here)
            if after is None:
                return here
            here = after
        return here

    def _terminal(self, here: int) -> tuple[str, int]:
        """The terminal of a token in this state, and the next token; a unit is one terminal."""
        if here in self.instead:
            return self.instead[here], here + 1
        tokens = self.tokens
        kind, _ = unread(tokens, here)
        if kind != WORD:
            return kind, here + 1
        row = self.tables.actions[self.states[-1]]
        word = _WORD.match(tokens.text, tokens.starts[here])
        text = "" if word is None else word[0]
        if text in row and text in self.tables.words:
            return text, here + 1
        unit = UNIT.match(tokens.text, tokens.starts[here]) if "UNIT" in row else None
        if unit is None:
            return text if text in RESERVED else "NAME", here + 1
        after = here + 1
        while after < len(tokens) and tokens.starts[after] < unit.end():
            after += 1
        return "UNIT", after


def unread(tokens: Tokens, here: int) -> tuple[str, int]:
    """The class and the end of a token as they were before the parser wrote its terminal.

    Replacements made by a repair are kept.
    """
    start, kind = tokens.starts[here], tokens.kinds[here]
    word = _WORD.match(tokens.text, start)
    if word is not None:
        return WORD if kind.isidentifier() else kind, word.end()
    first = tokens.text[start]
    if kind == SKIPPED and (first.isdigit() or first in "*/^-"):  # a part of a unit
        kind = NUMBER if first.isdigit() else first
    return kind, tokens.ends[here]


@dataclass(frozen=True, slots=True)
class Place:
    """A token that does not fit.

    ``opening`` are the states before the statement, whose first token is ``first``.  ``states`` are
    those before the token ``here``, where one of ``expected`` should stand.  ``stop`` is the end of
    the item.
    """

    tables: Tables
    tokens: Tokens
    opening: tuple[int, ...]
    states: tuple[int, ...]
    first: int
    here: int
    stop: int
    expected: frozenset[str]

    def trial(self, instead: Mapping[int, str] | None = None) -> Trial:
        """A trial parser in the state before the token."""
        return Trial(self.tables, self.tokens, list(self.states), instead or {})

    def end(self, here: int) -> int:
        """The ``;`` that ends the statement around a token, or an earlier closing brace or end."""
        depth, stop = 0, min(self.stop, here + MOST_TOKENS)
        for index in range(here, stop):
            kind = self.tokens.kinds[index]
            if kind == "{":
                depth += 1
            elif kind == "}":
                if depth == 0:
                    return index
                depth -= 1
            elif kind == ";" and depth == 0:
                return index
        return stop


def find(place: Place) -> Repair | None:
    """The first repair that lets the parser go on; the most certain kinds are tried first."""
    end = place.end(place.here)
    if end - place.first >= MOST_TOKENS:
        return None
    supplied = _foreign(place, end) or _semicolon(place) or _brace(place)
    return supplied or _other(place, end) or _brackets(place, end) or _more(place, end)


def _foreign(place: Place, end: int) -> Repair | None:
    """The word of the language for one of another notation."""
    meant = _meant(place)
    if meant is None:
        return None
    instead = {place.here: meant}
    whole = _ends(place, place.trial(instead), place.here, end)
    return Repair(place.here, end, instead, whole=True) if whole else None


def _meant(place: Place) -> str | None:
    """The word of the language that a token stands for; None if it begins a statement."""
    meant = FOREIGN.get(place.tokens.at(place.here))
    calls = place.here + 1 < place.stop and place.tokens.at(place.here + 1) == "("
    return None if calls or meant not in place.expected else meant


def _semicolon(place: Place) -> Repair | None:
    """A missing ``;``: before this token, or at the end of an earlier line."""
    tokens, here = place.tokens, place.here
    if ";" in place.expected:
        trial = place.trial()
        trial.shift(";")
        word = tokens.at(here)
        begins = word in place.tables.words and word in place.tables.actions[trial.states[-1]]
        begins = begins and _meant(place) is None
        if tokens.on_new_line(here) or unread(tokens, here)[0] == "}" or begins:
            return Repair(here, here, missing=";")
    breaks = [index for index in range(place.first + 1, here) if tokens.on_new_line(index)]
    for line in breaks[: -MOST_LINES - 1 : -1]:
        trial = Trial(place.tables, tokens, list(place.opening))
        fits = trial.run(place.first, line) == line and trial.shift(";")
        if fits and trial.run(line, here + 1) > here:
            return Repair(line, line, missing=";")
    return None


def _brace(place: Place) -> Repair | None:
    """A missing ``}`` before a statement that begins like a block."""
    trial = Trial(place.tables, place.tokens, list(place.opening))
    if place.tokens.at(place.here) != "{" or not trial.shift("}"):
        return None
    fits = trial.run(place.first, place.here + 1) > place.here
    return Repair(place.first, place.first, missing="}") if fits else None


def _ends(place: Place, trial: Trial, here: int, end: int) -> bool:
    """Whether a statement fits to its end, with or without its ``;``."""
    reached = trial.run(here, end)
    if reached == end:
        return trial.accepts(";") or trial.accepts("}")
    return place.tokens.on_new_line(reached) and trial.accepts(";")


def _other(place: Place, end: int) -> Repair | None:
    """Another terminal instead of the token, or the token left out."""
    here, text = place.here, place.tokens.at(place.here)
    after = min(here + 2, place.stop)
    opens = here + 1 < place.stop and place.tokens.at(here + 1) == "{"
    offers = [terminal for terminal in _INSTEAD.get(text, ()) if terminal in place.expected]
    offers += [SKIPPED] if text in _SUPERFLUOUS else []
    if text == ";":
        end = place.end(here + 1)
    found: Repair | None = None
    for terminal in offers:
        instead = {here: terminal}
        trial = place.trial(instead)
        if terminal in _CHANGED and trial.run(here, after) < after:
            continue
        if opens or _ends(place, place.trial(instead), here, end):
            return Repair(here, end, instead, whole=True)
        if found is None and text not in _ONLY_WHOLE:
            found = Repair(here, end, instead)
    return found


def _brackets(place: Place, end: int) -> Repair | None:
    """Brackets of another kind, or none, instead of a pair."""
    tokens, here = place.tokens, place.here
    opener = tokens.at(here)
    closer = _closer(tokens, here, end) if opener in _CLOSERS else None
    if closer is None:
        return None
    offers = [(other, _CLOSERS[other]) for other in _CLOSERS if other in place.expected]
    wraps = tokens.at(here + 1) == "(" or closer == here + 2
    offers.insert(0 if wraps else len(offers), (SKIPPED, SKIPPED))
    for first, last in offers:
        instead = {here: first, closer: last}
        if _ends(place, place.trial(instead), here, end):
            return Repair(here, end, instead, whole=True)
    return None


def _closer(tokens: Tokens, here: int, end: int) -> int | None:
    """The bracket that closes the one at a token."""
    opener, depth = tokens.at(here), 0
    for index in range(here, end):
        text = tokens.at(index)
        depth += (text == opener) - (text == _CLOSERS[opener])
        if depth == 0:
            return index
    return None


def _more(place: Place, end: int) -> Repair | None:
    """One more terminal before the token."""
    before = [place.tokens.at(index) for index in range(place.first, place.here)]
    frames = before[-1:] == [")"] or before[-2:-1] == ["."]
    for terminal in _MISSING:
        trial = place.trial()
        fits = terminal in place.expected and trial.shift(terminal)
        if terminal == "*" and not frames:
            continue
        if fits and _ends(place, trial, place.here, end):
            return Repair(place.here, end, missing=terminal, whole=True)
    return None


# --- The repaired statement -----------------------------------------------------------------------


MAX_WRITTEN = 72
"""Longer statements are not written out."""


def mended(place: Place, repair: Repair) -> str | None:
    """The statement with a repair; None if the repair is not enough, or the text is too long."""
    tokens, last = place.tokens, min(repair.stop, place.stop - 1)
    if tokens.kinds[last] == "}":
        last -= 1
    start, end = tokens.starts[place.first], tokens.ends[last]
    if not repair.whole or last < place.here or end - start > MAX_WRITTEN:
        return None
    edits = {tokens.starts[k]: (tokens.ends[k], new) for k, new in repair.instead.items()}
    if repair.missing:
        near = repair.missing in {",", ":"}
        at = tokens.ends[place.here - 1] if near else tokens.starts[place.here]
        edits = {at: (at, repair.missing)}
    text = tokens.text[start:end]
    for at in sorted(edits, reverse=True):
        stop, new = edits[at]
        new = "" if new == SKIPPED else f" {new} " if new[0] not in ",:;.([)]" else new
        text = text[: at - start] + new + text[stop - start :]
    text = " ".join(text.split())
    if ":" in repair.instead.values():
        text = text.replace(" :", ":")
    if "//" in text or "/*" in text or text.endswith("{"):
        return None
    return text if text.endswith(";") else f"{text};"
