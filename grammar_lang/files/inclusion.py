"""A file with all it includes: the items of every file, in the order in which includes stand.

Includes are followed with a stack of our own, however deep they go.  A file is known by its real
path: the second time it adds nothing, and where it is still open it is a cycle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang.diagnostics.codes import Code
from grammar_lang.files.file_set import FileSet
from grammar_lang.files.file_tree import visible
from grammar_lang.node import node
from grammar_lang.parsing.parse import parse
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t

_ENDS = 3
"""So many files are named at either end of a long chain."""


@node
class Inclusion:
    """The items of all files as those of one; ``maps`` by the span of the path that names each.

    ``complete`` is False where a file could not be read: nobody knows what it declares.
    """

    file: t.File
    maps: Mapping[Span, ir.ObstacleMap]
    complete: bool


@node
class _Open:
    """A file that is being gone through."""

    number: int
    real: str
    items: Iterator[t.Item]


@dataclass(slots=True)
class _Traversal:
    files: FileSet
    items: list[t.Item] = field(default_factory=list[t.Item])
    broken: list[Span] = field(default_factory=list[Span])
    skipped: set[str] = field(default_factory=set[str])
    maps: dict[Span, ir.ObstacleMap] = field(default_factory=dict[Span, ir.ObstacleMap])
    chain: list[_Open] = field(default_factory=list[_Open])
    depths: dict[str, int] = field(default_factory=dict[str, int])
    numbers: dict[str, int] = field(default_factory=dict[str, int])
    complete: bool = True

    def follow(self, real: str) -> None:
        """Go through the main file and all it includes."""
        self._open(0, real)
        while self.chain:
            item = next(self.chain[-1].items, None)
            if item is None:
                del self.depths[self.chain.pop().real]
                continue
            self.items.append(item)
            if isinstance(item, t.Include):
                self._include(item, self.chain[-1].number)
            elif isinstance(item, t.Workspace):
                self._maps(item, self.chain[-1].number)

    def _open(self, number: int, real: str) -> None:
        self.numbers[real] = number
        if number in self.files.unsound:
            self.complete = False
            return
        file = parse(self.files.sources[number].text, self.files.sink, number)
        self.broken += file.broken
        self.skipped |= file.skipped
        self.depths[real] = len(self.chain)
        self.chain.append(_Open(number, real, iter(file.items)))

    def _include(self, item: t.Include, base: int) -> None:
        place = self.files.place(item.path, base)
        if place is None:
            self.complete = False
        elif place.real in self.depths:
            self._cycle(item, self.depths[place.real], place.path)
        elif place.real in self.numbers:
            self.files.twin(place, self.numbers[place.real])
        else:
            number = self.files.text(place, item.path, (".srg",))
            if number is None:
                self.complete = False
            else:
                self._open(number, place.real)

    def _cycle(self, item: t.Include, first: int, path: str) -> None:
        """Report an include that closes a cycle, at that include; ``first`` is its target."""
        names = [self.files.sources[o.number].path for o in self.chain[first:]]
        if len(names) > 2 * _ENDS + 1:
            left_out = len(names) - 2 * _ENDS
            names[_ENDS:-_ENDS] = [f"… {left_out:,} more …"]
        chain = " -> ".join(map(visible, [*names, path]))
        hint = "remove this include, or move what both files need into a third one"
        message = f"a file includes itself: {chain}"
        self.files.sink.error(Code.INCLUDE_CYCLE, message, item.path.span, hint)

    def _maps(self, workspace: t.Workspace, base: int) -> None:
        for item in workspace.items:
            if isinstance(item, t.ObstaclesFrom):
                from grammar_lang.files.obstacle_maps import read_map

                found = read_map(item.path, base, self.files)
                if found is not None:
                    self.maps[item.path.span] = found


def include_all(files: FileSet, real: str) -> Inclusion:
    """Follow the includes of the first of ``files``, the main file, whose real path is ``real``."""
    traversal = _Traversal(files)
    traversal.follow(real)
    file = t.File(tuple(traversal.items), tuple(traversal.broken), frozenset(traversal.skipped))
    return Inclusion(file, traversal.maps, traversal.complete)
