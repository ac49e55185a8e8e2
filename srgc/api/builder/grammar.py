"""Grammars, from productions with their semantics or from the ports of modules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from grammar_lang import syntax as s
from srgc.api.builder.arguments import ident, read, read_all
from srgc.api.builder.module import Module
from srgc.api.builder.part import Part
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault


class Grammar(Part):
    """A family of robots: ``Grammar("Arms", start="Arm").production("base", "Arm -> Base")``.

    Each method returns a new grammar with one more statement.  ``Grammar.from_ports`` creates a
    grammar whose productions follow from the ports of its modules.

    Args:
        name: the name of the grammar.
        start: the start symbol, a nonterminal.

    Raises:
        SrgcError: one of the arguments is not a name.
    """

    __slots__ = ()

    @spoken
    def __init__(self, name: str, *, start: str) -> None:
        statements = (s.StartSymbol(ident(start, "start")),)
        super().__init__((s.Grammar(ident(name, "name"), statements),))

    @classmethod
    @spoken
    def from_ports(
        cls, name: str, *, start: str | Module, modules: Sequence[str | Module] = ()
    ) -> Self:
        """Create a grammar from ports, whose robots join ports that fit.

        Args:
            name: the name of the grammar.
            start: the module that stands on the world.
            modules: the modules that others may carry.

        Raises:
            SrgcError: an argument is invalid.
        """
        statements: list[s.GrammarItem] = [s.StartSymbol(ident(named(start), "start"))]
        if isinstance(modules, str | Module) or not isinstance(modules, Sequence):
            raise UsageFault("`modules` are modules or their names, in a list")
        if modules:
            statements.append(s.Listed(tuple(ident(named(one), "modules") for one in modules)))
        made = object.__new__(cls)
        item = s.Grammar(ident(name, "name"), tuple(statements), from_ports=True)
        Part.__init__(made, (item,))
        return made

    @property
    def name(self) -> str:
        """The name of the grammar."""
        return self._grammar.name.text

    @property
    def _grammar(self) -> s.Grammar:
        grammar = self._items[0]
        assert isinstance(grammar, s.Grammar)  # noqa: S101 - of no other item it is made
        return grammar

    def _with(self, statement: s.GrammarItem) -> s.Grammar:
        old = self._grammar
        return s.Grammar(old.name, (*old.items, statement), from_ports=old.from_ports)

    @spoken
    def production(self, label: str, rule: str, *statements: str) -> Self:
        """Add a production with its semantics.

        Args:
            label: the name of the production.
            rule: the production, such as "Arm -> Arm eps Link".
            statements: the rules and bodies of its semantic block, such as
                "this.frame = Arm.frame * move(x, Link.length)" and "effector(frame: Arm.frame)".

        Raises:
            SrgcError: an argument is invalid.
        """
        if self._grammar.from_ports:
            raise UsageFault("a grammar from ports has no productions of its own")
        what = 'a production, as "Arm -> Arm eps Link"'
        found = read(f"grammar G {{ {ident(label, 'label').text}: ", rule, ";}", "rule", what)
        if not isinstance(found, s.Production):
            raise UsageFault(f"`rule` is {what}, not {rule!r}")
        block = s.Block(found.label, tuple(map(_statement, statements)))
        return self._copied((self._with(found), *self._semantics(block)))

    def _semantics(self, block: s.Block) -> tuple[s.Semantics, ...]:
        """The blocks of all productions; empty as long as no production has a statement."""
        blocks = (*(each for item in self._items[1:] for each in _blocks(item)), block)
        if len(self._items) == 1 and not block.statements:
            return ()
        known = {each.label for each in blocks}
        earlier = (item for item in self._grammar.items if isinstance(item, s.Production))
        missing = tuple(s.Block(item.label, ()) for item in earlier if item.label not in known)
        return (s.Semantics(self._grammar.name, (*missing, *blocks)),)

    @spoken
    def accept(self, condition: str) -> Self:
        """Add the condition that a word of the family has to satisfy.

        Args:
            condition: such as "matches Base (eps Joint eps Link)+ eps Hand and count(Link) <= 3".

        Raises:
            SrgcError: the text is not a condition.
        """
        what = 'a condition on words, as "count(Link) <= 3"'
        found = read("grammar G { accept ", condition, ";}", "condition", what)
        if not isinstance(found, s.Accept):
            raise UsageFault(f"`condition` is {what}, not {condition!r}")
        return self._copied((self._with(found), *self._items[1:]))


def named(part: object) -> object:
    """The name of a part; other values are returned as they are."""
    return getattr(part, "name", part) if isinstance(part, Part) else part


def _blocks(item: object) -> tuple[s.Block, ...]:
    return item.blocks if isinstance(item, s.Semantics) else ()


def _statement(text: object) -> s.Rule | s.Emission | s.Let:
    what = 'a rule or a body, as "this.frame = world"'
    if isinstance(text, str):
        text = f"{text.rstrip().removesuffix(';')};"
    (block,) = read_all("semantics G { b {", text, "}}", "statements", what)
    if len(block.statements) != 1:
        raise UsageFault(f"`statements`: each is {what}, not {text!r}")
    found: s.Rule | s.Emission | s.Let = block.statements[0]
    return found
