"""Spaces between the tokens of a statement, and the places where its line may be broken.

Both depend on the terminals only, never on the spacing of the text.  A ``*``, ``/`` or ``^`` after
a unit is set apart: without the space it would be part of the unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

NEVER = 1 << 60
"""The rank of a place where the line must not be broken."""

_OPERANDS = frozenset({"NAME", "NUMBER", "UNIT", ")", "]", "}", "x", "y", "z", "world"})
_TIGHT_BEFORE = frozenset({";", ",", ")", "]", ":", "."})
_TIGHT_AFTER = frozenset({"(", "[", "."})
_CALLED = frozenset({"NAME", "count", "der", "torque"})
_WINDOWED = frozenset({"always", "eventually", "last"})
_MARKS = frozenset({"*", "+", "?"})
_COMPARISONS = frozenset({"<=", "<", ">=", ">", "=="})
_UNBROKEN_BEFORE = frozenset({"UNIT", "{", "}", "%", "->", "="})
_UNBROKEN_AFTER = frozenset({
    "{", "}", ":", "->", "+", "-", "*", "/", "^", "|", "and", "or", "not", "implies", "until",
    *_COMPARISONS,
})  # fmt: skip
_BETTER = 5 * 10**9
"""Added to the rank of a poor place, which is used only if the line has no better one."""
_BEFORE = {
    "fixed": 0, "implies": 2, "or": 3, "|": 3, "and": 4, "until": 5,
    "rate": 6, "margin": 6, "rates": 6, "by": 6, **dict.fromkeys(_COMPARISONS, 7),
    "+": 8, "-": 8, "*": 9, "/": 9,
}  # fmt: skip
_COMPARED = frozenset({"accel", "effort", "modules", "rates", "length"})


@dataclass(frozen=True, slots=True)
class Spacing:
    """For each token, whether a space goes before it, and the rank of a line break there.

    A line is broken at the lowest rank, and at the last place of that rank; never at ``NEVER``.
    """

    blanks: Sequence[bool]
    ranks: Sequence[int]


@dataclass(slots=True)
class _Place:
    """What the tokens so far say about the next one; reset at every statement."""

    first: bool = True
    """Whether the previous token is the first of the statement."""
    depth: int = 0
    production: bool = False
    regex: int = -1
    """The depth at which a regular expression began; -1 outside one."""
    choices: bool = False
    sign: bool = False
    """Whether the previous token is a sign, not an operator."""

    def pass_by(self, before: str, kind: str) -> None:
        """Update the state after a token."""
        self.sign = kind == "-" and before not in _OPERANDS
        self.first = self.depth == 0 and before in {";", "{", "}"}
        if kind in {"(", "["} or (kind == "{" and before == "in"):
            self.depth += 1
            self.choices |= kind == "{"
        elif kind in {")", "]"} or (kind == "}" and self.choices):
            self.depth -= 1
            self.choices &= kind != "}"
            if self.depth < self.regex:
                self.regex = -1
        elif kind in {";", "{", "}"}:
            self.depth, self.production, self.regex = 0, False, -1
        elif kind == "matches":
            self.regex = self.depth
        elif kind in {"and", "or"}:
            self.regex = -1
        elif kind == "->":
            self.production = True

    def tight(self, before: str, kind: str) -> bool:
        """Whether no space goes between the previous token and this one."""
        if kind in _TIGHT_BEFORE or before in _TIGHT_AFTER or self.sign:
            return True
        if (before == ":" and self.production) or (before == "{" and self.choices):
            return True
        match kind:
            case "^":
                return before != "UNIT"
            case "(":
                return before in _CALLED and self.regex < 0
            case "[":
                return before in _WINDOWED
            case "*" | "+" | "?":
                return self.regex >= 0
            case "}":
                return self.choices
            case _:
                return False

    def rank(self, before: str, kind: str, *, tight: bool) -> int:
        """The rank of a line break between two tokens."""
        level = self.depth * 100
        if before == ",":
            return level + 1
        if tight:
            return _BETTER + level + 11 if before == "(" and kind != ")" else NEVER
        mark = self.regex >= 0 and before in _MARKS
        if self.first or kind in _UNBROKEN_BEFORE or (before in _UNBROKEN_AFTER and not mark):
            return NEVER
        if kind in _BEFORE and before not in _COMPARED:
            return level + _BEFORE[kind]
        if kind == "x" and before in {"]", "UNIT"}:
            return level + 6
        if before == "=":
            return _BETTER + level + 8
        return _BETTER + level + (10 if before in {"NAME", "STRING"} else 12)


def spacing(kinds: Sequence[str]) -> Spacing:
    """The spacing of a sequence of terminals."""
    blanks: list[bool] = []
    ranks: list[int] = []
    place = _Place()
    before = ";"
    power = False
    for kind in kinds:
        tight = place.tight(before, kind) or (before == "^" and power)
        if kind == "^":
            power = tight
        blanks.append(not tight)
        ranks.append(place.rank(before, kind, tight=tight))
        place.pass_by(before, kind)
        before = kind
    return Spacing(blanks, ranks)
