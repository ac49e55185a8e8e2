"""The names of a specification: every place that mentions an entity.

The resolver fills the table once, from the syntax alone.  The checks, the findings about unused
names and all that an editor asks (definition, references, rename, hover, completion) read it.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from functools import cached_property

from grammar_lang.names.declarations import Declarations
from grammar_lang.names.entities import Entity, Kind, Occurrences
from grammar_lang.node import node
from grammar_lang.source import Span
from grammar_lang.syntax import Ident


@node
class Mention:
    """A name in the text.

    ``whole`` is the word that stands there; ``span`` is the part of it that is the name: a quoted
    symbol without its quotes, ``L`` of the numbered occurrence ``L2``.  ``within`` is the entity in
    whose declaration it stands: a production (also in the semantics), a member, a task.
    ``position`` is that on the right side (``ir.THIS`` for the left one), or in the word of a
    ``from``, of the symbol whose member or attribute is named.
    """

    entity: Entity
    span: Span
    whole: Span
    declares: bool = field(default=False)
    within: Entity | None = field(default=None, compare=False, repr=False)
    position: int | None = field(default=None, compare=False)


class NameTable:
    """The names of a specification in the order of their places.

    ``declared`` are its items.  ``words`` gives what the right side of a production, or the word of
    a ``from``, calls its symbols, by the place of the statement.
    """

    def __init__(
        self,
        mentions: Iterable[Mention],
        declared: Declarations,
        words: Mapping[Span, Occurrences],
    ) -> None:
        self.declared = declared
        self.words = words
        self.mentions: Sequence[Mention] = sorted(
            mentions, key=lambda m: (m.whole.file, m.whole, not m.declares)
        )
        self._starts = [(m.whole.file, m.whole.start) for m in self.mentions]

    # --- by place ------------------------------------------------------------------------------

    @cached_property
    def _by_place(self) -> dict[Span, Mention]:
        return {mention.whole: mention for mention in self.mentions}

    def entity(self, name: Ident) -> Entity | None:
        """What a name in the text stands for; None if it stands for nothing."""
        found = self._by_place.get(name.span)
        return None if found is None else found.entity

    def at(self, file: int, offset: int) -> Mention | None:
        """The name in which, or right after which, an offset is."""
        index = bisect_right(self._starts, (file, offset)) - 1
        for mention in self.mentions[max(index - 1, 0) : index + 1][::-1]:
            if mention.whole.file == file and mention.whole.start <= offset <= mention.whole.end:
                return mention
        return None

    def inside(self, span: Span) -> Sequence[Mention]:
        """The names that stand in a part of the text."""
        first = bisect_left(self._starts, (span.file, span.start))
        return self.mentions[first : bisect_left(self._starts, (span.file, span.end), first)]

    # --- by entity -----------------------------------------------------------------------------

    @cached_property
    def _by_entity(self) -> dict[Entity, list[Mention]]:
        found: dict[Entity, list[Mention]] = {}
        for mention in self.mentions:
            found.setdefault(mention.entity, []).append(mention)
        return found

    def mentions_of(self, entity: Entity) -> Sequence[Mention]:
        """Where an entity is named."""
        return self._by_entity.get(entity, ())

    def declarations(self, entity: Entity) -> Sequence[Mention]:
        """Where it is declared: a nonterminal at the left of each of its productions."""
        return [mention for mention in self.mentions_of(entity) if mention.declares]

    def uses(self, entity: Entity) -> Sequence[Mention]:
        """Where it is named and not declared."""
        return [mention for mention in self.mentions_of(entity) if not mention.declares]

    def entities(self, *kinds: Kind, scope: tuple[str, ...] | None = None) -> list[Entity]:
        """The entities of some kinds that are declared, in the order of their names' places."""
        return [
            entity
            for entity, mentions in self._by_entity.items()
            if entity.kind in kinds
            and scope in {None, entity.scope}
            and any(mention.declares for mention in mentions)
        ]
