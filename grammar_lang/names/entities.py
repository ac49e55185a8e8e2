"""The entities that names stand for, as the items of a specification declare them."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Container, Mapping, Sequence
from dataclasses import field
from typing import Literal, TypeAlias

from grammar_lang import syntax as s
from grammar_lang.node import node
from grammar_lang.parsing.tables import RESERVED
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t

Kind: TypeAlias = Literal[
    "module",
    "edge",
    "parameter",
    "constant",
    "degree of freedom",
    "state",
    "input",
    "grammar",
    "nonterminal",
    "production",
    "occurrence",
    "attribute",
    "workspace",
    "region",
    "obstacle",
    "target",
    "map",
    "task",
]
TERMINALS: tuple[Kind, ...] = ("module", "edge")
MEMBERS: tuple[Kind, ...] = ("parameter", "constant", "degree of freedom", "state", "input")
REGIONS: tuple[Kind, ...] = ("region", "obstacle", "target")

_MEMBER_KINDS: dict[type, Kind] = {
    s.Param: "parameter",
    s.Const: "constant",
    s.Dof: "degree of freedom",
    s.State: "state",
    s.Input: "input",
}


@node
class Entity:
    """What a name stands for.

    ``scope`` is where the name holds: nothing for modules, edges and items; the module of a
    parameter, constant, degree of freedom, state or input; the grammar of a nonterminal or
    production; grammar and production of an occurrence with a name of its own; grammar and
    nonterminal of an attribute; the workspace of a region or map.  ``span`` is the name where it is
    first declared, ``statement`` that declaration; an attribute has neither.
    """

    kind: Kind
    scope: tuple[str, ...]
    name: str
    span: Span = field(default=s.NOWHERE, compare=False, repr=False)
    statement: Span = field(default=s.NOWHERE, compare=False, repr=False)


def entity(kind: Kind, scope: tuple[str, ...], name: s.Ident, statement: Span) -> Entity:
    """The entity that a name in a declaration declares."""
    return Entity(kind, scope, name.text, name.span, statement)


def members(module: s.Module) -> dict[str, Entity]:
    """The parameters, constants, degrees of freedom, states and inputs of a module, by name."""
    found: dict[str, Entity] = {}
    for item in module.items:
        if isinstance(item, s.Param | s.Const | s.Dof | s.State | s.Input):
            kind, scope = _MEMBER_KINDS[type(item)], (module.name.text,)
            found.setdefault(item.name.text, entity(kind, scope, item.name, item.span))
    return found


def productions(grammar: s.Grammar) -> dict[str, s.Production]:
    """The productions of a grammar, by label."""
    found: dict[str, s.Production] = {}
    for item in grammar.items:
        if isinstance(item, s.Production):
            found.setdefault(item.label.text, item)
    return found


def nonterminals(grammar: s.Grammar) -> dict[str, Entity]:
    """The left sides of the productions of a grammar, by name."""
    found: dict[str, Entity] = {}
    for item in grammar.items:
        if isinstance(item, s.Production) and item.left.text not in found:
            scope = (grammar.name.text,)
            found[item.left.text] = entity("nonterminal", scope, item.left, item.span)
    return found


def places(workspace: t.Workspace) -> dict[str, Entity]:
    """The regions and then the maps of a workspace, by name."""
    scope = (workspace.name.text,)
    found: dict[str, Entity] = {}
    maps: dict[str, Entity] = {}
    for item in workspace.items:
        if isinstance(item, t.Region) and item.name is not None and item.kind != "bounds":
            found.setdefault(item.name.text, entity(item.kind, scope, item.name, item.span))
        elif isinstance(item, t.ObstaclesFrom):
            name = map_name(item.path.text)
            maps.setdefault(name, Entity("map", scope, name, item.path.span, item.span))
    return found | {name: each for name, each in maps.items() if name not in found}


# --- occurrences -------------------------------------------------------------------------------


@node
class Occurrences:
    """What a word calls its symbols (section "Names" of the language).

    ``places`` gives the position that a name means: X where it occurs once, X1 to Xn where it
    occurs n times, and the names given in the production.  ``repeated`` gives the names that tell
    the occurrences of a symbol apart.  ``clashes`` are the occurrences whose name is that of
    another symbol already, each with that name.
    """

    places: Mapping[str, int]
    repeated: Mapping[str, tuple[str, ...]]
    clashes: tuple[tuple[s.Ident, str], ...]


def occurrences(
    word: Sequence[s.Occurrence], taken: Container[str], unnumbered: Container[str] = ()
) -> Occurrences:
    """How the symbols of a word are called.

    Args:
        word: the symbols with the names given to them.
        taken: the names of symbols, which no occurrence of another one can have.
        unnumbered: symbols whose occurrences are not told apart by numbers.
    """
    positions: dict[str, list[int]] = {}
    for position, each in enumerate(word):
        positions.setdefault(each.symbol.text, []).append(position)
    found = {name: own[0] for name, own in positions.items() if len(own) == 1}
    repeated: dict[str, tuple[str, ...]] = {}
    clashes: list[tuple[s.Ident, str]] = []
    for name, own in positions.items():
        if len(own) == 1:
            continue
        numbered = {f"{name}{number}": word[at] for number, at in enumerate(own, 1)}
        repeated[name] = tuple(
            number if each.alias is None else each.alias.text for number, each in numbered.items()
        )
        if name not in unnumbered:
            found |= {n: at for n, at in zip(numbered, own, strict=True) if n not in taken}
            clashes += [
                (each.symbol, number)
                for number, each in numbered.items()
                if number in taken and each.alias is None
            ]
    for position, each in enumerate(word):
        alias = each.alias
        if alias is None:
            continue
        free = found.get(alias.text, position) == position and alias.text not in repeated
        if free and alias.text not in taken:
            found[alias.text] = position
        else:
            clashes.append((alias, alias.text))
    return Occurrences(found, repeated, tuple(clashes))


_NO_LETTER = re.compile(r"[^A-Za-z0-9_]")


def map_name(path: str) -> str:
    """The name of a file without its end, as a NAME: ``maps/yard 2.yaml`` is ``yard_2``.

    What no NAME holds becomes ``_``; a first digit and a reserved word get one in front.
    """
    stem = posixpath.splitext(posixpath.basename(path))[0]
    name = _NO_LETTER.sub("_", stem)
    return f"_{name}" if not name or name[0].isdigit() or name in RESERVED else name
