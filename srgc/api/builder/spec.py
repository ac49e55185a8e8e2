"""Whole specifications, from parts and texts."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Self

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.parsing.parse import parse
from grammar_lang.syntax import tasks as t
from srgc.api.builder.arguments import is_quotable, shown, symbols
from srgc.api.builder.part import Part
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault


class Spec(Part):
    """A specification: ``Spec(base, link, hand).edges("eps").add(arms, bench, lift)``.

    It can be used instead of the path of a file: ``srgc.check(spec)``, ``srgc.synthesize(spec)``.

    Args:
        parts: modules, grammars, workspaces, tasks, other specifications, and texts of the
            language.

    Raises:
        SrgcError: an argument is not a part or a text, or a text has a syntax error.
    """

    __slots__ = ()

    @spoken
    def __init__(self, *parts: Part | str) -> None:
        super().__init__(tuple(item for part in parts for item in _items(part)))

    @spoken
    def add(self, *parts: Part | str) -> Self:
        """Add parts.

        Args:
            parts: as for the class.

        Raises:
            SrgcError: an argument is not a part or a text, or a text has a syntax error.
        """
        return self._copied((*self._items, *(item for part in parts for item in _items(part))))

    @spoken
    def edges(self, *names: str) -> Self:
        """Declare edges, the symbols that connect modules.

        Args:
            names: the symbols, such as "eps" or "[".

        Raises:
            SrgcError: an argument is not a symbol.
        """
        return self._copied((*self._items, s.Edges(symbols(names, "names"))))

    @spoken
    def include(self, path: str, *, std: bool = False) -> Self:
        """Include another file.

        Args:
            path: the path of the file, relative to the ``folder`` of ``load`` or ``check``.
            std: whether it is a file of the library, such as "serial.srg".

        Raises:
            SrgcError: the argument is not a path.
        """
        if not is_quotable(path):
            raise UsageFault(f"`path` is the path of a file, not {shown(path)}")
        return self._copied((*self._items, t.Include(s.Ident(path), std=std)))

    @spoken
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the specification to a file.

        Args:
            path: the path of the file; an existing file is replaced.

        Returns:
            The path.

        Raises:
            SrgcError: the file cannot be written.
        """
        from srgc.paths import write_output

        write_output(Path(path), self.to_srg())
        return Path(path)


def _items(part: object) -> tuple[t.Item, ...]:
    if isinstance(part, Part):
        return part.items
    if not isinstance(part, str):
        raise UsageFault(f"`parts` are parts of a specification and texts, not {shown(part)}")
    sink = Sink()
    items = parse(part, sink).items
    if sink.found:
        first = sink.sorted()[0]
        raise UsageFault(f"`parts`: {first.message}, in {shown(part)}", hint=first.hint)
    return items
