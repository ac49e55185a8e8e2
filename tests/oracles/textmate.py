"""A TextMate tokeniser: the part of the format that `srg.tmLanguage.json` uses.

Line by line, a stack of open rules; in each, the leftmost match of its ``end`` and its patterns
wins, and of several at one place the first, the ``end`` before all.  The semantics, including what
is done about rules that match nothing, is that of vscode-textmate (MIT, Microsoft), function
``_tokenizeString`` of ``src/grammar/tokenizeString.ts``; the regular expressions run in Oniguruma
as they do there.  What is not read here (``while``, ``\\G``, back references, other grammars,
patterns in captures) is refused, not ignored.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import onigurumacffi

KEYS = {
    frozenset({"include"}),
    frozenset({"patterns"}),
    frozenset({"name", "match"}),
    frozenset({"match", "captures"}),
    *(
        frozenset({"begin", "end", *more})
        for more in (
            ["name"],
            ["patterns", "endCaptures"],
            ["patterns", "beginCaptures"],
            ["patterns", "beginCaptures", "endCaptures"],
            ["patterns", "beginCaptures", "endCaptures", "name"],
        )
    ),
}
_UNKNOWN = re.compile(r"\\[Gkg1-9]")
Rule = Mapping[str, Any]


@dataclass(frozen=True)
class Scoped:
    """Characters of one line and their scopes, outermost first."""

    line: int
    start: int
    end: int
    scopes: tuple[str, ...]


@dataclass(frozen=True)
class _Frame:
    rule: Rule
    scopes: tuple[str, ...]
    entered: int


class Grammar:
    """A grammar whose every rule has been looked at: keys, includes, regular expressions."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.scope: str = content["scopeName"]
        self.repository: Mapping[str, Rule] = content["repository"]
        self.root: Rule = {"patterns": content["patterns"]}
        self.included: set[str] = set()
        self._choices: dict[int, tuple[list[Rule | None], Any]] = {}
        for rule in self.rules():
            self._examine(rule)

    def rules(self) -> Iterator[Rule]:
        """Every rule of the grammar, the nested ones too."""
        waiting = [self.root, *self.repository.values()]
        while waiting:
            rule = waiting.pop()
            yield rule
            waiting += rule.get("patterns", ())

    def _examine(self, rule: Rule) -> None:
        assert frozenset(rule) in KEYS, f"unknown combination of keys: {sorted(rule)}"
        for key in ("match", "begin", "end"):
            if key in rule:
                onigurumacffi.compile(rule[key])
                assert not _UNKNOWN.search(rule[key]), rule[key]
        for key in ("captures", "beginCaptures", "endCaptures"):
            for number, capture in rule.get(key, {}).items():
                assert number.isdecimal()
                assert set(capture) == {"name"}
        if "include" in rule:
            assert rule["include"].startswith("#")
            self.included.add(rule["include"][1:])
            assert rule["include"][1:] in self.repository, rule["include"]

    def _flat(self, patterns: Sequence[Rule], seen: frozenset[str]) -> Iterator[Rule]:
        for rule in patterns:
            if "include" in rule:
                name = rule["include"][1:]
                if name not in seen:
                    yield from self._flat([self.repository[name]], seen | {name})
            elif set(rule) == {"patterns"}:
                yield from self._flat(rule["patterns"], seen)
            else:
                yield rule

    def _choice(self, rule: Rule) -> tuple[list[Rule | None], Any]:
        """What may match inside a rule, None for its end, and their regular expressions."""
        if id(rule) not in self._choices:
            rules: list[Rule | None] = [None] if "end" in rule else []
            rules += self._flat(rule.get("patterns", ()), frozenset())
            texts = [
                rule["end"] if inner is None else inner.get("match", inner.get("begin"))
                for inner in rules
            ]
            self._choices[id(rule)] = rules, onigurumacffi.compile_regset(*texts)
        return self._choices[id(rule)]

    def tokenise(self, text: str) -> list[Scoped]:
        """The scopes of every character but the line ends."""
        found: list[Scoped] = []
        stack = [_Frame(self.root, (self.scope,), -1)]
        for number, line in enumerate(text.split("\n")):
            stack = [_Frame(frame.rule, frame.scopes, -1) for frame in stack]
            found += (
                Scoped(number, start, min(end, len(line)), scopes)
                for start, end, scopes in self._line(f"{line}\n", stack)
                if start < min(end, len(line))
            )
        return found

    def _line(self, line: str, stack: list[_Frame]) -> Iterator[tuple[int, int, tuple[str, ...]]]:
        at = 0
        while at < len(line):
            rules, choices = self._choice(stack[-1].rule)
            index, match = choices.search(line, at)
            if match is None:
                break
            rule, top = rules[index], stack[-1]
            start, end = match.span()
            yield at, start, top.scopes
            if rule is None:
                yield from _captured(match, top.rule.get("endCaptures", {}), top.scopes)
                stack.pop()
                if end == at == top.entered:
                    stack.append(top)
                    break
            else:
                named = (rule["name"],) if "name" in rule else ()
                inside = top.scopes + named
                key = "captures" if "match" in rule else "beginCaptures"
                yield from _captured(match, rule.get(key, {}), inside)
                if "begin" in rule:
                    stack.append(_Frame(rule, inside, at))
                    if end == at and _is_open_here(rule, stack[:-1], at):
                        stack.pop()
                        break
                elif end == at:
                    if len(stack) > 1:
                        stack.pop()
                    break
            at = end
        yield at, len(line), stack[-1].scopes


def _is_open_here(rule: Rule, stack: Sequence[_Frame], at: int) -> bool:
    """Whether the rule was opened at this very place before: it would be so for ever."""
    for frame in reversed(stack):
        if frame.entered != at:
            return False
        if frame.rule is rule:
            return True
    return False


def _captured(
    match: Any, captures: Mapping[str, Mapping[str, str]], scopes: tuple[str, ...]
) -> Iterator[tuple[int, int, tuple[str, ...]]]:
    """A match cut at the borders of its captures."""
    spans = [
        (*match.span(int(number)), capture["name"])
        for number, capture in sorted(captures.items())
        if match[int(number)]
    ]
    borders = sorted({*match.span(), *(p for start, end, _ in spans for p in (start, end))})
    for start, end in pairwise(borders):
        names = tuple(name for a, b, name in spans if a <= start and end <= b)
        yield start, end, scopes + names
