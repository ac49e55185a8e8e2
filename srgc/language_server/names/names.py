"""What a name of a program stands for, and where its names stand."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from grammar_lang.source import Span

Kind: TypeAlias = Literal[
    "terminal",
    "nonterminal",
    "label",
    "occurrence",
    "member",
    "attribute",
    "grammar",
    "workspace",
    "region",
    "map",
    "task",
]


@dataclass(frozen=True, slots=True)
class Key:
    """One thing with a name.

    ``scope`` is where the name holds: nothing for modules, edges and items; the grammar of a
    nonterminal or label; grammar and label of a named occurrence; grammar and nonterminal of an
    attribute; the module of a parameter, constant, degree of freedom, state or input; the
    workspace of a region or map.
    """

    kind: Kind
    scope: tuple[str, ...]
    name: str


@dataclass(frozen=True, slots=True)
class Mark:
    """A name in the text.

    ``whole`` is the word that stands there; ``span`` is the part of it that is the name: a quoted
    symbol without its quotes, ``L`` of the numbered occurrence ``L2``.
    """

    key: Key
    span: Span
    whole: Span
    defines: bool = False


class NameIndex:
    """The names of a program in the order of their places."""

    def __init__(self, marks: Iterable[Mark]) -> None:
        ordered = sorted(marks, key=lambda mark: (mark.whole.file, mark.whole, not mark.defines))
        self.marks: Sequence[Mark] = ordered
        self._starts = [(mark.whole.file, mark.whole.start) for mark in ordered]
        self._by_key: dict[Key, list[Mark]] = {}
        for mark in ordered:
            self._by_key.setdefault(mark.key, []).append(mark)

    def at(self, file: int, offset: int) -> Mark | None:
        """The name in which, or right after which, an offset is."""
        index = bisect_right(self._starts, (file, offset)) - 1
        for mark in self.marks[max(index - 1, 0) : index + 1][::-1]:
            if mark.whole.file == file and mark.whole.start <= offset <= mark.whole.end:
                return mark
        return None

    def of(self, key: Key) -> Sequence[Mark]:
        """Where a thing is named."""
        return self._by_key.get(key, ())

    def definitions(self, key: Key) -> Sequence[Mark]:
        """Where a thing is declared: a nonterminal at the left of each of its productions."""
        return [mark for mark in self.of(key) if mark.defines]

    def keys(self, kind: Kind, scope: tuple[str, ...] | None = None) -> list[Key]:
        """The things of a kind that are declared, in the order of their names' places."""
        return [
            key
            for key, marks in self._by_key.items()
            if key.kind == kind
            and scope in {None, key.scope}
            and any(mark.defines for mark in marks)
        ]
