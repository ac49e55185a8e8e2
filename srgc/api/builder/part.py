"""The base of all parts of a specification: immutable values that print as the language."""

from __future__ import annotations

from typing import Self

from grammar_lang.syntax.tasks import Item


class Part:
    """An immutable part of a specification; each method returns a new one.

    Its text is the language in the form of ``srgc fmt``.
    """

    __slots__ = ("_items",)

    def __init__(self, items: tuple[Item, ...]) -> None:
        self._items = items

    def _copied(self, items: tuple[Item, ...]) -> Self:
        made = object.__new__(type(self))
        Part.__init__(made, items)
        return made

    @property
    def items(self) -> tuple[Item, ...]:
        """Its syntax tree, as the parser builds it; not a stable interface."""
        return self._items

    def to_srg(self) -> str:
        """The text of the part in the language, in the form of ``srgc fmt``, as ``str``."""
        from grammar_lang.formatting.syntax_text import syntax_text

        return syntax_text(self._items)

    def __str__(self) -> str:
        return self.to_srg()

    def __repr__(self) -> str:
        first = self.to_srg().partition("{")[0].partition("\n")[0].strip()
        return f"<{type(self).__name__}: {first or 'nothing'}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Part) and self._items == other.items

    def __hash__(self) -> int:
        return hash(self._items)

    def _repr_html_(self) -> str:
        from srgc.api.displays import coloured_source

        return coloured_source(self.to_srg())
