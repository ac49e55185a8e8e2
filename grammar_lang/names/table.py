"""The table of names: every place that mentions an entity, and the names that are never used."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.names.clause_names import symbols_of
from grammar_lang.names.declarations import Declarations, Entity, Kind, Occurrences, members, named
from grammar_lang.source import Span, node
from grammar_lang.syntax import Ident

# --- The names of a specification: every place that mentions an entity ----------------------------
#
# The resolver fills the table once, from the syntax alone.  It is read by the checks, by the
# warnings about unused names and by all editor requests (definition, references, rename, hover,
# completion).


@node
class Mention:
    """A name in the text; a word that names several entities has a mention for each.

    ``whole`` is the word in the text; ``span`` is the part of it that is the name: a quoted symbol
    without its quotes, or ``L`` of the numbered occurrence ``L2``.  ``within`` is the entity in
    whose declaration it stands: a production (also in the semantics), a member, a task or a
    mission.  ``position`` belongs to the symbol whose member or attribute is named: its position on
    the right side (``ir.THIS`` for the left side) or in the word of a ``from``.
    """

    entity: Entity
    span: Span
    whole: Span
    declares: bool = field(default=False)
    within: Entity | None = field(default=None, compare=False, repr=False)
    position: int | None = field(default=None, compare=False)

    @property
    def summed_up(self) -> bool:
        """Whether this is an attribute that an objective sums up."""
        attribute = self.entity.kind in {"constant", "parameter"} and self.position is None
        return attribute and self.within is not None and self.within.kind in {"task", "mission"}


class NameTable:
    """The names of a specification in the order of their places.

    ``declared`` are its declarations.  ``words`` maps the span of a production or a ``from`` to the
    names of the occurrences in its right side or word.
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

    # --- By place ------------------------------------------------------------------------------

    @cached_property
    def _by_place(self) -> dict[Span, Mention]:
        return {mention.whole: mention for mention in self.mentions}

    def entity(self, name: Ident) -> Entity | None:
        """The entity that a name in the text refers to, if any."""
        found = self._by_place.get(name.span)
        return None if found is None else found.entity

    def at(self, file: int, offset: int) -> Mention | None:
        """The mention that contains an offset or ends there."""
        index = bisect_right(self._starts, (file, offset)) - 1
        for mention in self.mentions[max(index - 1, 0) : index + 1][::-1]:
            if mention.whole.file == file and mention.whole.start <= offset <= mention.whole.end:
                return mention
        return None

    def together(self, mention: Mention) -> Sequence[Mention]:
        """All mentions by the same word: for ``sum(NAME)``, a member of each module."""
        place = mention.whole.file, mention.whole.start
        first, stop = bisect_left(self._starts, place), bisect_right(self._starts, place)
        return self.mentions[first:stop]

    def inside(self, span: Span) -> Sequence[Mention]:
        """The mentions in a part of the text."""
        first = bisect_left(self._starts, (span.file, span.start))
        return self.mentions[first : bisect_left(self._starts, (span.file, span.end), first)]

    # --- By entity -----------------------------------------------------------------------------

    @cached_property
    def _by_entity(self) -> dict[Entity, list[Mention]]:
        found: dict[Entity, list[Mention]] = {}
        for mention in self.mentions:
            found.setdefault(mention.entity, []).append(mention)
        return found

    def mentions_of(self, entity: Entity) -> Sequence[Mention]:
        """All mentions of an entity."""
        return self._by_entity.get(entity, ())

    def declarations(self, entity: Entity) -> Sequence[Mention]:
        """The declarations of an entity: a nonterminal has one in each of its productions."""
        return [mention for mention in self.mentions_of(entity) if mention.declares]

    def uses(self, entity: Entity) -> Sequence[Mention]:
        """The mentions of an entity that do not declare it."""
        return [mention for mention in self.mentions_of(entity) if not mention.declares]

    def entities(self, *kinds: Kind, scope: tuple[str, ...] | None = None) -> list[Entity]:
        """The declared entities of some kinds, in the order of the places of their names."""
        return [
            entity
            for entity, mentions in self._by_entity.items()
            if entity.kind in kinds
            and scope in {None, entity.scope}
            and any(mention.declares for mention in mentions)
        ]


# --- Names that are declared and never used: the last check of a file without errors --------------
#
# In modules: parameters, constants and frames that neither the semantics nor a body reads, and
# states and inputs on which no torque depends.  In semantics: attributes and local values that
# nothing reads.  In a file with tasks: grammars, workspaces, regions and targets that no task
# names.  The declarations of an included file belong to a library and need not be used.


_HINTS: dict[str, str] = {
    "parameter": "read `{module}.{name}` in the semantics, or remove it",
    "constant": "read `{module}.{name}` in the semantics, or remove it",
    "state": "read it in a `torque`, or remove it with its `der`",
    "input": "read it in a `der` or a `torque`, or remove it",
    "frame": "use it in the module or as `{module}.{name}`, make it a `port`, or remove it",
}


def _warn(unused: Entity, at: Span, why: str, hint: str, sink: Sink) -> None:
    if at.file == 0:
        message = f"the {unused.kind} `{unused.name}` {why}"
        sink.warning(Code.UNUSED_NAME, message, at, hint)


def _check_attributes(names: NameTable, sink: Sink) -> None:
    """Warn of attributes and local values that are never read, where they are first defined."""
    for local in names.entities("local value"):
        if not names.uses(local):
            _warn(local, local.span, "is never read", "read it in a rule, or remove it", sink)
    hint = "read it in a rule or an emission, or remove its definitions"
    for attribute in names.entities("attribute"):
        if not names.uses(attribute):
            at = names.declarations(attribute)[0].span
            _warn(attribute, at, f"of `{attribute.scope[1]}` is never read", hint, sink)


# --- Modules --------------------------------------------------------------------------------------


def _described(names: NameTable) -> Iterator[str]:
    """The modules in grammars that have a semantics or are made from ports."""
    for name, grammar in names.declared.grammars.items():
        if grammar.from_ports or name in names.declared.semantics:
            yield from symbols_of(grammar)


def _made_of(names: NameTable, members: Iterable[Entity]) -> dict[Entity, set[Entity]]:
    """For each member of a module, the members that its value depends on."""
    made: dict[Entity, set[Entity]] = {member: set() for member in members}
    for member in made:
        for mention in names.uses(member):
            if mention.within in made and mention.within is not None:
                made[mention.within].add(member)
    return made


def _live(made: Mapping[Entity, set[Entity]], roots: Iterable[Entity]) -> set[Entity]:
    """The roots and all members that they depend on, directly or not."""
    found: set[Entity] = set()
    stack = list(roots)
    while stack:
        member = stack.pop()
        if member not in found:
            found.add(member)
            stack.extend(made[member])
    return found


def _used_in(kind: Kind, entity: Entity, names: NameTable) -> bool:
    """Whether an entity is used in the declaration of an entity of this kind."""
    users = (use.within for use in names.uses(entity))
    return any(user is not None and user.kind == kind for user in users)


def _check_module(module: str, names: NameTable, sink: Sink) -> None:
    """Warn of members that no semantics, body, degree of freedom or objective depends on."""
    owns = s.owns_body(names.declared.modules[module])
    made = _made_of(names, members(names.declared.modules[module]).values())
    users: tuple[Kind, ...] = ("production", "module")
    read = (m for m in made if any(_used_in(kind, m, names) for kind in users))
    moving = (m for m in made if m.kind == "degree of freedom")
    summed = (m for m in made if any(use.summed_up for use in names.uses(m)))
    live = _live(made, [*read, *moving, *summed])
    for member in made:
        if member in live:
            continue
        hint = _HINTS[member.kind].format(module=module, name=member.name)
        if owns and member.kind in {"parameter", "constant"}:
            hint = "use it in a frame or a body of the module, or remove it"
        readers = [reader for reader, parts in made.items() if member in parts and reader != member]
        if readers:
            hint = f"only `{readers[-1].name}` reads it, which is not used either"
        _warn(member, member.span, f"of module `{module}` is never used", hint, sink)


# --- Tasks ----------------------------------------------------------------------------------------


def _check_tasks(names: NameTable, sink: Sink) -> None:
    def check(entity: Entity) -> bool:
        """Whether a task names an entity; warn if not."""
        used = _used_in("task", entity, names)
        if not used:
            hint = "name it in a task, or remove it"
            _warn(entity, entity.span, "is not named in any task", hint, sink)
        return used

    for grammar in names.entities("grammar"):
        check(grammar)
    for workspace in names.declared.workspaces.values():
        if check(named(workspace)):
            for place in names.declared.places[workspace.name.text].values():
                if place.kind in {"region", "target"}:
                    check(place)


def report_unused(names: NameTable, sink: Sink) -> None:
    """Warn of the names that a file declares but never uses, unless there are errors.

    Args:
        names: the names of the file with all its includes.
        sink: collects the warnings; after an error in it, a use of a name may have been lost.
    """
    if sink.has_errors:
        return
    _check_attributes(names, sink)
    for module in dict.fromkeys(_described(names)):
        if module in names.declared.modules:
            _check_module(module, names, sink)
    if names.declared.tasks:
        _check_tasks(names, sink)
