"""The LALR(1) parser: an explicit stack, values built bottom-up, and recovery from errors.

After an error the statement is repaired if adding, removing or replacing one token suffices.
Otherwise it is dropped, and parsing goes on with the next one.  Missing ``}`` at the end of an item
are supplied.

Source: A. V. Aho, M. S. Lam, R. Sethi, J. D. Ullman, *Compilers*, sections 4.7 and 4.8.3 (panic
mode and phrase-level recovery).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeAlias

from grammar_lang.parsing.repair import UNIT, Place, Repair, find, unread
from grammar_lang.parsing.tables import END, RESERVED, Reduction, Tables
from grammar_lang.parsing.tokens import SKIPPED, WORD, RawItem, Tokens
from grammar_lang.source import Span

MAX_DEPTH = 100
TOO_DEEP = frozenset({"less depth"})
"""Used instead of the expected terminals when the nesting is too deep."""

_RESERVED = frozenset(RESERVED)
_PATTERNS = frozenset({"NAME", "NUMBER", "STRING", "UNIT"})
"""The terminals that are not named by their text."""


class Token(NamedTuple):
    """A terminal that is part of a value."""

    kind: str
    text: str
    span: Span


Builder: TypeAlias = Callable[[list[Any], Span], object]
Complain: TypeAlias = Callable[[Place, Repair | None], bool]


@dataclass(slots=True)
class _Stack:
    """The states and, for each but the first, a value with its first and last tokens and depth."""

    states: list[int] = field(default_factory=lambda: [0])
    values: list[Any] = field(default_factory=list[Any])
    firsts: list[int] = field(default_factory=list[int])
    ends: list[int] = field(default_factory=list[int])
    depths: list[int] = field(default_factory=list[int])

    def push(self, state: int, value: object, first: int, end: int, depth: int) -> None:
        self.states.append(state)
        self.values.append(value)
        self.firsts.append(first)
        self.ends.append(end)
        self.depths.append(depth)

    def cut(self, size: int) -> None:
        """Keep the first ``size`` values."""
        del self.states[size + 1 :]
        del self.values[size:]
        del self.firsts[size:]
        del self.ends[size:]
        del self.depths[size:]

    def replace(self, base: int, state: int, value: object, depth: int) -> None:
        """Replace all values from ``base`` on by one, which keeps their first and last tokens."""
        if base + 1 < len(self.values):
            self.ends[base] = self.ends[-1]
            self.cut(base + 1)
        self.states[-1] = state
        self.values[base] = value
        self.depths[base] = depth


@dataclass(slots=True)
class Parser:
    """Parses the items of a text; ``builders`` make the values, ``complain`` reports errors.

    ``complain(place, repair)`` receives the place of a token that does not fit (the one after the
    last if the item ends too early) and a possible repair.  If it returns False, the rest of the
    item is not parsed.  The words of dropped text are added to ``skipped``.
    """

    tables: Tables
    tokens: Tokens
    builders: Mapping[str, Builder]
    complain: Complain
    skipped: set[str] = field(default_factory=set[str])
    _stack: _Stack = field(default_factory=_Stack)
    _failed: bool = False
    _quiet: int = -1
    """Errors up to this token are not reported, because their statement already had one."""

    def item(self, raw: RawItem) -> tuple[object | None, bool]:
        """The value of an item (None if it is unusable), and whether it has no errors."""
        self._stack, self._failed, self._quiet = _Stack(), False, -1
        here, stop = raw.first, raw.stop
        while here < stop:
            terminal = self._terminal(here)
            found = self._advance(terminal, here)
            if found is None:
                here = self._after(here)
                continue
            resumed = self._recover(here, stop, found)
            if resumed is None:
                return None, False
            here = resumed
        return self._finish(raw)

    def expected(self, raw: RawItem) -> frozenset[str]:
        """The terminals that may follow the tokens of an unfinished item."""
        self._stack, self._failed, self._quiet = _Stack(), False, -1
        here: int | None = raw.first
        while here is not None and here < raw.stop:
            found = self._advance(self._terminal(here), here)
            here = self._after(here) if found is None else self._recover(here, raw.stop, found)
        return frozenset() if here is None else self.tables.expected(self._stack.states)

    def _finish(self, raw: RawItem) -> tuple[object | None, bool]:
        """The value at the end of an item; open braces are closed."""
        while (expected := self._advance(END, raw.stop)) is not None:
            told = self._failed and expected is not TOO_DEEP
            if not told and not self._complain(self._place(raw.stop, raw.stop, expected), None):
                self._skip(raw.first, raw.stop)
                return None, False
            closer = next((c for c in (";", "}") if c in expected), None)
            if closer is None:
                point = self._recovery_point()
                if point is None:
                    self._skip(raw.first, raw.stop)
                    return None, False
                self._drop(point, raw.stop, raw.stop)
            if self._advance(closer or "}", raw.stop - 1) is not None:
                return None, False
        return self._stack.values[0], not self._failed

    def _complain(self, place: Place, repair: Repair | None) -> bool:
        self._failed = True
        return place.here <= self._quiet or self.complain(place, repair)

    # --- One token -----------------------------------------------------------------------------

    def _terminal(self, here: int) -> str:
        """The terminal of a token at the current state; a unit includes all its tokens."""
        kind = self.tokens.kinds[here]
        if kind != WORD:
            return kind
        row = self.tables.actions[self._stack.states[-1]]
        text = self.tokens.at(here)
        if text in row and text in self.tables.words:
            kind = text
        elif "UNIT" in row and self._unit(here):
            kind = "UNIT"
        else:
            kind = text if text in _RESERVED else "NAME"
        self.tokens.kinds[here] = kind
        return kind

    def _unit(self, here: int) -> bool:
        tokens = self.tokens
        match = UNIT.match(tokens.text, tokens.starts[here])
        if match is None:
            return False
        end = match.end()
        after = here + 1
        while after < len(tokens) and tokens.starts[after] < end:
            tokens.kinds[after] = SKIPPED
            after += 1
        tokens.ends[here] = end
        return True

    def _after(self, here: int) -> int:
        kinds = self.tokens.kinds
        here += 1
        while here < len(kinds) and kinds[here] == SKIPPED:
            here += 1
        return here

    def _advance(self, terminal: str, here: int) -> frozenset[str] | None:
        """Shift a terminal after all reductions; return the expected ones if it does not fit."""
        tables, states = self.tables, self._stack.states
        actions, gotos, rules = tables.actions, tables.gotos, tables.rules
        while True:
            action = actions[states[-1]].get(terminal)
            if action is None:
                return tables.expected(states)
            if action >= 0:
                self._stack.push(action, here, here, here, 0)
                return None
            rule = rules[-1 - action]
            if rule.passes:
                states[-1] = gotos[states[-2]][rule.origin]
            elif not self._reduce(rule):
                return TOO_DEEP
            if terminal == END and states[-1] == tables.end:
                return None

    def _reduce(self, rule: Reduction) -> bool:
        """Replace the symbols of a rule by its value; False if the value would be too deep."""
        stack, tokens = self._stack, self.tokens
        values = stack.values
        base = len(values) - rule.size
        depth = max(stack.depths[base:])
        children: list[Any] = []
        for place, splice in rule.parts:
            value: Any = None if place < 0 else values[base + place]
            if type(value) is int:
                start, end, kind = tokens.starts[value], tokens.ends[value], tokens.kinds[value]
                token = tokens.text[start:end] if kind in _PATTERNS else kind
                value = Token(kind, token, Span(start, end, tokens.file))
            if not splice:
                children.append(value)
            elif children:
                children.extend(value)
            else:
                children = value
        made: object = children
        if rule.transparent and len(children) == 1:
            made = children[0]
        elif rule.builder:
            # Statements end with one of these; the depth inside them does not count outside.
            depth = 0 if tokens.kinds[stack.ends[-1]] in {";", "}"} else depth + 1
            if depth > MAX_DEPTH:
                return False
            start, end = tokens.starts[stack.firsts[base]], tokens.ends[stack.ends[-1]]
            made = self.builders[rule.builder](children, Span(start, end, tokens.file))
        state = self.tables.gotos[stack.states[base]][rule.origin]
        stack.replace(base, state, made, depth)
        return True

    # --- After an error ------------------------------------------------------------------------

    def _recover(self, here: int, stop: int, expected: frozenset[str]) -> int | None:
        """Report an error and return the token to resume at; None if the item is lost."""
        self._settle()
        place = self._place(here, stop, expected)
        repair = None if expected is TOO_DEEP else find(place)
        if not self._complain(place, repair):
            self._skip(self._stack.firsts[0] if self._stack.firsts else here, stop)
            return None
        if repair is not None and repair.supplied:
            return self._supply(place, repair)
        if repair is not None and repair.instead:
            return self._replace(repair)
        point = self._recovery_point()
        if point is None:
            self._skip(self._stack.firsts[0] if self._stack.firsts else here, stop)
            return None
        return self._drop(point, here, self._resume(here, stop, point))

    def _settle(self) -> None:
        """Do the reductions that do not depend on what follows, as after a finished statement."""
        rows, states = self.tables.actions, self._stack.states
        while len(actions := {*rows[states[-1]].values()}) == 1 and (action := actions.pop()) < 0:
            rule = self.tables.rules[-1 - action]
            if rule.passes:
                states[-1] = self.tables.gotos[states[-2]][rule.origin]
            elif not self._reduce(rule):
                return

    def _place(self, here: int, stop: int, expected: frozenset[str]) -> Place:
        """The place of a token that does not fit, with its statement (or else its item)."""
        stack, size = self._stack, self._recovery_point() or 0
        first = stack.firsts[size] if size < len(stack.firsts) else here
        states = tuple(stack.states)
        return Place(
            self.tables, self.tokens, states[: size + 1], states, first, here, stop, expected
        )

    def _supply(self, place: Place, repair: Repair) -> int:
        """Supply a terminal, and parse the statement again with its end before that token."""
        tokens, line = self.tokens, repair.here
        if line < place.here:
            self._stack.cut(len(place.opening) - 1)
            here = place.first
            while here < line:
                self._advance(tokens.kinds[here], here)
                here = self._after(here)
        self._advance(repair.missing, line - 1)
        for index in range(line, self._after(place.here)):
            tokens.kinds[index], tokens.ends[index] = unread(tokens, index)
        return line

    def _replace(self, repair: Repair) -> int:
        """Replace tokens; unless that mends the whole statement, report no more errors in it."""
        for index, terminal in repair.instead.items():
            self.tokens.kinds[index] = terminal
        if not repair.whole and not repair.plain:
            self._quiet = repair.stop
        here = repair.here
        return self._after(here) if self.tokens.kinds[here] == SKIPPED else here

    def _recovery_point(self) -> int | None:
        """How many values to keep so that a statement may begin after them; None if impossible."""
        states, actions = self._stack.states, self.tables.actions
        for size in range(len(states) - 1, 0, -1):
            row = actions[states[size]]
            if "}" in row and ";" not in row and "," not in row and self._opens(size):
                return size
        return None

    def _opens(self, size: int) -> bool:
        """Whether the value before a position is a brace or a list of statements."""
        value = self._stack.values[size - 1]
        return isinstance(value, list) or (type(value) is int and self.tokens.kinds[value] == "{")

    def _resume(self, here: int, stop: int, point: int) -> int:
        """The token after the dropped statement: after its ``;``, or at the ``}``."""
        kinds = self.tokens.kinds
        dropped = self._stack.values[point:]
        depth = sum(type(v) is int and kinds[v] == "{" for v in dropped)
        braced = self._takes_blocks(point)
        while here < stop:
            kind = kinds[here]
            if kind == "{":
                depth += 1
            elif kind == "}":
                if depth == 0:
                    return here
                depth -= 1
                if braced and depth == 0:
                    return here + 1
            elif kind == ";" and depth == 0:
                return here + 1
            here += 1
        return stop

    def _takes_blocks(self, point: int) -> bool:
        """Whether the statements at a position are blocks, which end with a brace."""
        named = self.tables.after(self._stack.states[point], "NAME")
        return named is not None and set(self.tables.actions[named]) == {"{"}

    def _drop(self, point: int, here: int, resumed: int) -> int:
        """Drop the values from a position on, and record the words up to ``resumed``."""
        firsts = self._stack.firsts
        self._skip(firsts[point] if point < len(firsts) else here, resumed)
        self._stack.cut(point)
        return resumed

    def _skip(self, first: int, stop: int) -> None:
        """Record the words of dropped text, except units."""
        tokens, unit = self.tokens, 0
        for index in range(first, min(stop, len(tokens))):
            text, start = tokens.at(index).strip("'\""), tokens.starts[index]
            if index > first and tokens.kinds[index - 1] in {"NUMBER", ")", "]", "}"}:
                found = UNIT.match(tokens.text, start)
                unit = unit if found is None else found.end()
            if text[:1].isidentifier() and start >= unit:
                self.skipped.add(text)
