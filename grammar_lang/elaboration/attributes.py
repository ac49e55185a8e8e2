"""The attributes that a semantics defines: synthesized or inherited, each exactly once.

Source: D. E. Knuth, "Semantics of Context-Free Languages", *Mathematical Systems Theory* 2 (1968).
``this.a = …`` defines a synthesized attribute of the left side, and ``A.a = …`` an inherited one of
an occurrence.  The start symbol inherits only ``frame``, which is ``world``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.modules import INPUT, ModuleInfo, frame_of
from grammar_lang.elaboration.productions import GrammarInfo, ProductionInfo
from grammar_lang.ir.expression_text import occurrence_names
from grammar_lang.names.declarations import Entity
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span

Key = tuple[str, str]
ROOT_ATTRIBUTE = "frame"


@dataclass(frozen=True, slots=True)
class PlacedRule:
    """A rule or ``let`` of a block, with its target resolved.

    ``key`` is (nonterminal, attribute), ``at`` is the target in the text, and ``span`` is the
    statement.  ``mounts`` is the position of the module whose frame ``in`` the rule defines.
    """

    label: str
    target: ir.AttributeOf
    key: Key
    value: s.Expr
    at: Span
    span: Span
    mounts: int | None = None


@dataclass(slots=True)
class Attributes:
    """The attributes of a grammar, with the places of their first definitions.

    ``local`` are the values of ``let`` and the frames ``in``; their owners are productions.
    ``mounted`` are the modules with such a frame, by production and position.  ``failed`` are the
    labels of blocks with a wrong target, which was reported, and ``lost`` are the names of the
    attributes that such rules meant to define.
    """

    synthesized: dict[Key, Span] = field(default_factory=dict[Key, Span])
    inherited: dict[Key, Span] = field(default_factory=dict[Key, Span])
    local: dict[Key, Span] = field(default_factory=dict[Key, Span])
    mounted: set[tuple[str, int]] = field(default_factory=set[tuple[str, int]])
    rules: list[PlacedRule] = field(default_factory=list[PlacedRule])
    failed: set[str] = field(default_factory=set[str])
    lost: set[str] = field(default_factory=set[str])

    def has(self, key: Key) -> bool:
        """Whether the attribute exists."""
        return key in self.synthesized or key in self.inherited

    def of(self, nonterminal: str) -> tuple[str, ...]:
        """The attributes of a nonterminal."""
        keys = (*self.synthesized, *self.inherited)
        return tuple(dict.fromkeys(name for owner, name in keys if owner == nonterminal))


def occurrence_of(owner: s.Ident, info: ProductionInfo, sink: Sink) -> int | None:
    """The occurrence that an owner names (``ir.THIS`` for ``this``); reported if there is none.

    Nothing is reported in a broken production, whose unknown symbol was reported already.
    """
    if owner.text == "this":
        return ir.THIS
    if owner.text in info.names:
        return info.names[owner.text]
    if info.broken:
        return None
    label = info.production.label
    if owner.text in info.word.repeated:
        names = [f"`{n}`" for n in info.word.repeated[owner.text] if n in info.names]
        message = f"`{owner.text}` occurs more than once in production `{label}`"
        hint = f"write {', '.join(names)}" if names else "an edge has no attributes"
        sink.error(Code.AMBIGUOUS_OCCURRENCE, message, owner.span, hint)
        return None
    message = f"no symbol is called `{owner.text}` on the right side of production `{label}`"
    if owner.text in {info.production.left, "self"}:
        hint = "the left side is called `this`"
    else:
        hint = did_you_mean(owner.text, ("this", *info.names), "symbol", sink)
    sink.error(Code.UNKNOWN_NAME, message, owner.span, hint)
    return None


def nonterminal_at(info: ProductionInfo, occurrence: int) -> str | None:
    """The nonterminal at an occurrence; None for a module or an edge."""
    if occurrence == ir.THIS:
        return info.production.left
    symbol = info.production.right[occurrence]
    return symbol.name if symbol.kind == "nonterminal" else None


def local_key(label: str, name: str) -> Key:
    """The key of a local value; its owner contains a space, so it cannot be a nonterminal."""
    return f"production {label}", name


@dataclass(frozen=True, slots=True)
class _Placing:
    """Resolves the targets of statements in the block of a production."""

    info: ProductionInfo
    modules: Mapping[str, ModuleInfo]
    sink: Sink

    @property
    def label(self) -> str:
        return self.info.production.label

    def let(self, item: s.Let) -> PlacedRule:
        """The local value of a ``let``."""
        name = item.name.text
        target = ir.AttributeOf(ir.LOCAL, name)
        key = local_key(self.label, name)
        return PlacedRule(self.label, target, key, item.value, item.name.span, item.span)

    def rule(self, rule: s.Rule) -> PlacedRule | None:
        """An attribute rule, or a rule that mounts a module; None if an error was reported."""
        occurrence = occurrence_of(rule.target.owner, self.info, self.sink)
        if occurrence is None:
            return None
        nonterminal = nonterminal_at(self.info, occurrence)
        if nonterminal is None:
            return self._mount(rule, occurrence)
        name = rule.target.name.text
        target, key = ir.AttributeOf(occurrence, name), (nonterminal, name)
        return PlacedRule(self.label, target, key, rule.value, rule.target.span, rule.span)

    def _mount(self, rule: s.Rule, occurrence: int) -> PlacedRule | None:
        owner, name, at = rule.target.owner.text, rule.target.name.text, rule.target.span
        module = self.modules.get(self.info.production.right[occurrence].name)
        body = None if module is None else module.body
        if body is None:
            message = f"`{owner}` has no attributes: it is a module or an edge"
            hint = "only nonterminals have attributes"
            if module is not None and name == INPUT:
                message = f"`{owner}` cannot be mounted: the module has no frames and no bodies"
                hint = "write its frames and bodies here, or into the module"
            self.sink.error(Code.WRONG_KIND, message, at, hint)
            return None
        if name != INPUT:
            message = f"`{owner}.{name}` is defined in the module; only `{owner}.in` is given here"
            hint = f"write `{owner}.in = …;`, and read the module's frames"
            self.sink.error(Code.WRONG_KIND, message, at, hint)
            return None
        called = occurrence_names(self.info.production)[occurrence]
        target = frame_of(called, INPUT)
        key = local_key(self.label, target.name)
        return PlacedRule(self.label, target, key, rule.value, at, rule.span, occurrence)


def _collect(
    grammar: GrammarInfo,
    blocks: Mapping[str, s.Block],
    modules: Mapping[str, ModuleInfo],
    found: Attributes,
    sink: Sink,
) -> Iterator[PlacedRule]:
    for label, block in blocks.items():
        first: dict[ir.AttributeOf, Span] = {}
        placing = _Placing(grammar.productions[label], modules, sink)
        for statement in block.statements:
            placed: PlacedRule | None
            if isinstance(statement, s.Rule):
                placed, target = placing.rule(statement), statement.target
                called = f"{target.owner.text}.{target.name.text}"
            elif isinstance(statement, s.Let):
                placed, called = placing.let(statement), statement.name.text
            else:
                continue
            if placed is None:
                found.failed.add(label)
                found.lost.add(called.partition(".")[2])
                continue
            if placed.target in first:
                message = f"`{called}` is defined twice"
                notes = [(first[placed.target], "first here")]
                hint = "remove one definition"
                sink.error(Code.DOUBLE_ATTRIBUTE, message, placed.at, hint, notes)
                found.failed.add(label)
                continue
            first[placed.target] = placed.at
            yield placed


def _reads_root(grammar: GrammarInfo, blocks: Iterable[s.Block], names: NameTable) -> bool:
    """Whether a production of the start symbol reads ``this.frame``."""
    root = Entity("attribute", (grammar.grammar.name, grammar.grammar.start), ROOT_ATTRIBUTE)
    return any(
        mention.entity == root and mention.position == ir.THIS and not mention.declares
        for block in blocks
        for mention in names.inside(block.span)
    )


def _classify(found: Attributes, start: str, sink: Sink) -> None:
    for placed in found.rules:
        span = placed.at
        if placed.target.occurrence == ir.LOCAL:
            found.local[placed.key] = span
            if placed.mounts is not None:
                found.mounted.add((placed.label, placed.mounts))
            continue
        mine, other = found.inherited, found.synthesized
        if placed.target.occurrence == ir.THIS:
            mine, other = other, mine
        if placed.key in other:
            name = ".".join(placed.key)
            message = f"`{name}` is both synthesized and inherited"
            hint = "define it either as `this.…` or for the occurrences, not both"
            notes = [(other[placed.key], "defined the other way here")]
            sink.error(Code.DOUBLE_ATTRIBUTE, message, span, hint, notes)
            continue
        mine.setdefault(placed.key, span)
        if mine is found.inherited and placed.key[0] == start and placed.key[1] != ROOT_ATTRIBUTE:
            message = f"the start symbol `{start}` cannot inherit `{placed.key[1]}`"
            hint = "nothing defines it at the root; the start symbol inherits only `frame`"
            sink.error(Code.UNDEFINED_ATTRIBUTE, message, span, hint)


def collect_attributes(
    grammar: GrammarInfo,
    blocks: Mapping[str, s.Block],
    modules: Mapping[str, ModuleInfo],
    names: NameTable,
    sink: Sink,
) -> Attributes:
    """The attributes that the blocks define; repeated and impossible definitions are reported."""
    found = Attributes()
    found.rules.extend(_collect(grammar, blocks, modules, found, sink))
    _classify(found, grammar.grammar.start, sink)
    root = (grammar.grammar.start, ROOT_ATTRIBUTE)
    if root not in found.synthesized and _reads_root(grammar, blocks.values(), names):
        found.inherited.setdefault(root, grammar.grammar.span)
    return found


def _by_nonterminal(keys: Iterable[Key]) -> dict[str, list[str]]:
    names: dict[str, list[str]] = {}
    for nonterminal, name in keys:
        names.setdefault(nonterminal, []).append(name)
    return names


def _reads(
    grammar: GrammarInfo,
    blocks: Mapping[str, s.Block],
    names: NameTable,
    key: tuple[str | None, str],
) -> set[tuple[str, ir.AttributeOf]]:
    """Where an attribute of a nonterminal is read: the productions and the occurrences there."""
    nonterminal, name = key
    entity = Entity("attribute", (grammar.grammar.name, nonterminal or ""), name)
    return {
        (label, ir.AttributeOf(mention.position, name))
        for label, block in blocks.items()
        for mention in names.inside(block.span)
        if mention.entity == entity and not mention.declares and mention.position is not None
    }


def check_complete(
    grammar: GrammarInfo,
    blocks: Mapping[str, s.Block],
    found: Attributes,
    names: NameTable,
    sink: Sink,
) -> None:
    """Report the attributes that a production leaves undefined."""
    given = {(placed.label, placed.target) for placed in found.rules}
    synthesized, inherited = _by_nonterminal(found.synthesized), _by_nonterminal(found.inherited)
    for label, block in blocks.items():
        info = grammar.productions[label]
        if info.broken or label in found.failed:
            continue
        due = [(ir.THIS, "this", name) for name in synthesized.get(info.production.left, ())]
        called_by: dict[int, str] = {}
        for name, place in info.names.items():
            called_by.setdefault(place, name)
        for position, symbol in enumerate(info.production.right):
            if symbol.kind == "nonterminal" and symbol.name in inherited:
                called = symbol.alias or called_by.get(position, symbol.name)
                due += [(position, called, name) for name in inherited[symbol.name]]
        for occurrence, called, name in due:
            if (label, ir.AttributeOf(occurrence, name)) not in given:
                message = f"production `{label}` does not define `{called}.{name}`"
                hint = f"add `{called}.{name} = …;`"
                key = nonterminal_at(info, occurrence), name
                reads = _reads(grammar, blocks, names, key)
                if reads and reads <= given:
                    hint += f"; or write `let {name} = …;` where only that production reads it"
                sink.error(Code.UNDEFINED_ATTRIBUTE, message, block.label.span, hint)
