"""Names that are declared and never used: the last check of a file that has no errors.

Of modules: parameters and constants that no semantics reads, states and inputs on which no torque
depends.  Of semantics: attributes that no rule and no emission reads.  Beside the tasks of a file:
grammars, workspaces, regions and targets that none of them names.  What an included file declares
is a library's and need not be used.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.names.declarations import named
from grammar_lang.names.entities import Entity, Kind, members
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span

_HINTS: dict[str, str] = {
    "parameter": "read `{module}.{name}` in the semantics, or remove it",
    "constant": "read `{module}.{name}` in the semantics, or remove it",
    "state": "read it in a `torque`, or remove it with its `der`",
    "input": "read it in a `der` or a `torque`, or remove it",
}


def _warn(unused: Entity, at: Span, why: str, hint: str, sink: Sink) -> None:
    if at.file == 0:
        message = f"the {unused.kind} `{unused.name}` {why}"
        sink.warning(Code.UNUSED_NAME, message, at, hint)


def _check_attributes(names: NameTable, sink: Sink) -> None:
    """Warn of the attributes that nothing reads, where they are first defined."""
    hint = "read it in a rule or an emission, or remove its definitions"
    for attribute in names.entities("attribute"):
        if not names.uses(attribute):
            at = names.declarations(attribute)[0].span
            _warn(attribute, at, f"of `{attribute.scope[1]}` is never read", hint, sink)


# --- modules -----------------------------------------------------------------------------------


def _described(names: NameTable) -> Iterator[str]:
    """The modules in the productions to which a semantics gives a meaning."""
    for semantics in names.declared.semantics.values():
        grammar = names.declared.grammars[semantics.grammar.text]
        for item in grammar.items:
            if isinstance(item, s.Production):
                yield from (each.symbol.text for each in item.right)


def _made_of(names: NameTable, members: Iterable[Entity]) -> dict[Entity, set[Entity]]:
    """What the value of each member of a module is made of."""
    made: dict[Entity, set[Entity]] = {member: set() for member in members}
    for member in made:
        for mention in names.uses(member):
            if mention.within in made and mention.within is not None:
                made[mention.within].add(member)
    return made


def _live(made: Mapping[Entity, set[Entity]], roots: Iterable[Entity]) -> set[Entity]:
    """The roots, and whatever they are made of, directly or not."""
    found: set[Entity] = set()
    stack = list(roots)
    while stack:
        member = stack.pop()
        if member not in found:
            found.add(member)
            stack.extend(made[member])
    return found


def _used_in(kind: Kind, entity: Entity, names: NameTable) -> bool:
    """Whether an entity is used in the declaration of something of a kind."""
    users = (use.within for use in names.uses(entity))
    return any(user is not None and user.kind == kind for user in users)


def _check_module(module: str, names: NameTable, sink: Sink) -> None:
    """Warn of what neither the semantics nor a degree of freedom depends on."""
    made = _made_of(names, members(names.declared.modules[module]).values())
    read = (member for member in made if _used_in("production", member, names))
    moving = (m for m in made if m.kind == "degree of freedom")
    live = _live(made, [*read, *moving])
    for member in made:
        if member in live:
            continue
        hint = _HINTS[member.kind].format(module=module, name=member.name)
        readers = [reader for reader, parts in made.items() if member in parts and reader != member]
        if readers:
            hint = f"only `{readers[-1].name}` reads it, which is not used either"
        _warn(member, member.span, f"of module `{module}` is never used", hint, sink)


# --- tasks -------------------------------------------------------------------------------------


def _check_tasks(names: NameTable, sink: Sink) -> None:
    def check(entity: Entity) -> bool:
        """Whether a task names an entity; else that is warned of."""
        used = _used_in("task", entity, names)
        if not used:
            hint = "name it in a task, or remove it"
            _warn(entity, entity.span, "is named by no task", hint, sink)
        return used

    for grammar in names.entities("grammar"):
        check(grammar)
    for workspace in names.declared.workspaces.values():
        if check(named(workspace)):
            for place in names.declared.places[workspace.name.text].values():
                if place.kind in {"region", "target"}:
                    check(place)


def report_unused(names: NameTable, sink: Sink) -> None:
    """Warn of the names that a file declares and never uses; silent after errors.

    Args:
        names: those of the file with all it includes.
        sink: takes the warnings; an error in it may stand where a name was to be read.
    """
    if sink.has_errors:
        return
    _check_attributes(names, sink)
    for module in dict.fromkeys(_described(names)):
        if module in names.declared.modules:
            _check_module(module, names, sink)
    if names.declared.tasks:
        _check_tasks(names, sink)
