"""Semantics (Definition 5): attribute rules and emissions of each production, typed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.attributes import (
    ROOT_ATTRIBUTE,
    Attributes,
    Key,
    PlacedRule,
    check_complete,
    collect_attributes,
    nonterminal_at,
    occurrence_of,
)
from grammar_lang.circularity import cycle
from grammar_lang.emissions import Emissions
from grammar_lang.extent import too_large
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.findings.spelling import did_you_mean, nearest
from grammar_lang.ir.expression_text import occurrence_names
from grammar_lang.mentions import mentioned
from grammar_lang.modules import ModuleInfo, duplicate
from grammar_lang.productions import GrammarInfo, ProductionInfo
from grammar_lang.readings import readings
from grammar_lang.sorts import (
    UNKNOWN,
    ZERO,
    DimensionUse,
    Sort,
    Typed,
    mismatch,
    wrong_sort,
)
from grammar_lang.source import Span
from grammar_lang.typecheck import Checker, plain_name
from grammar_lang.units import ONE

Types: TypeAlias = dict[Key, Typed]

_ENDS = 3
"""So many attributes are named at either end of a long cycle."""


@dataclass(slots=True)
class ProductionScope:
    """What names mean in the block of a production."""

    info: ProductionInfo
    modules: Mapping[str, ModuleInfo]
    attributes: Attributes
    types: Types
    uses: list[DimensionUse] = field(default_factory=list[DimensionUse])
    dofs: dict[ir.DofOf, list[Span]] = field(default_factory=dict[ir.DofOf, list[Span]])

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """``pi``, or an error."""
        return plain_name(ident, tuple(self.info.names), sink)

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """A parameter, a constant or an attribute."""
        occurrence = occurrence_of(member.owner, self.info, sink)
        if occurrence is None:
            return UNKNOWN
        if nonterminal_at(self.info, occurrence) is None:
            return self._of_module(occurrence, member, sink)
        return self._attribute(occurrence, member, sink)

    def dof(self, member: s.Member) -> ir.Dof | None:
        """The degree of freedom that ``owner.name`` is."""
        module = self._module(self.info.names.get(member.owner.text))
        return None if module is None else module.dofs.get(member.name.text)

    def use_dof(self, member: s.Member) -> ir.Expr:
        """Take note of a legitimate use."""
        use = ir.DofOf(self.info.names[member.owner.text], member.name.text)
        self.dofs.setdefault(use, []).append(member.span)
        return use

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """The modules of the production that expressions name."""
        return mentioned(expressions, self.info)

    def _module(self, occurrence: int | None) -> ModuleInfo | None:
        if occurrence is None or occurrence == ir.THIS:
            return None
        return self.modules.get(self.info.production.right[occurrence].name)

    def _of_module(self, occurrence: int, member: s.Member, sink: Sink) -> Typed:
        module, name = self._module(occurrence), member.name.text
        if module is None:
            message = f"`{member.owner.text}` is an edge; it has no parameters"
            sink.error(Code.WRONG_KIND, message, member.span, "name a module or a nonterminal")
            return UNKNOWN
        if name in module.dofs:
            use = ir.DofOf(occurrence, name)
            self.dofs.setdefault(use, []).append(member.span)
            place = "rot" if module.dofs[name].kind == "revolute" else "move"
            message = f"the degree of freedom `{member.owner.text}.{name}` does not stand alone"
            hint = (
                f"write it alone: `{place}({module.dofs[name].axis}, {member.owner.text}.{name})`"
            )
            sink.error(Code.BAD_DOF_USE, message, member.span, hint)
            return UNKNOWN
        if name in module.own:
            called = f"{module.own[name]} `{member.owner.text}.{name}`"
            message = f"the {called} cannot be read in the semantics"
            hint = "frames and bodies depend on parameters and degrees of freedom alone"
            sink.error(Code.WRONG_KIND, message, member.span, hint)
            return UNKNOWN
        if name not in module.members:
            message = f"module `{module.module.name}` has no `{name}`"
            hint = did_you_mean(name, module.names, "parameter or constant", sink)
            sink.error(Code.UNKNOWN_NAME, message, member.name.span, hint)
            return UNKNOWN
        value = module.at(occurrence, name)
        if isinstance(value.expr, ir.Vector) and value.expr.z != ZERO:
            self.uses.append(DimensionUse(3, member.span, "this vector leaves the plane"))
        return value

    def _attribute(self, occurrence: int, member: s.Member, sink: Sink) -> Typed:
        nonterminal = nonterminal_at(self.info, occurrence) or ""
        name = member.name.text
        if name in self.attributes.lost and not self.attributes.has((nonterminal, name)):
            return UNKNOWN
        if not self.attributes.has((nonterminal, name)):
            message = f"nothing defines the attribute `{name}` of `{nonterminal}`"
            known = self.attributes.of(nonterminal)
            hint = did_you_mean(name, known, "attribute", sink)
            sink.error(Code.UNDEFINED_ATTRIBUTE, message, member.name.span, hint)
            return UNKNOWN
        found = self.types.get((nonterminal, name), UNKNOWN)
        return replace(found, expr=ir.AttributeOf(occurrence, name))


# --- inference ---------------------------------------------------------------------------------


@dataclass(slots=True)
class _Rounds:
    """The numbers of rules that are to be looked at: in their order, in a round each only once."""

    now: list[int]
    later: set[int] = field(default_factory=set[int])
    last: int = -1

    def take(self) -> int | None:
        """The next number; the later ones are a new round."""
        while self.now or self.later:
            if not self.now:
                self.now, self.later, self.last = sorted(self.later), set(), -1
            index = heappop(self.now)
            if index != self.last:
                self.last = index
                return index
        return None

    def add(self, indices: Iterable[int]) -> None:
        """Look at these again."""
        for index in indices:
            if index > self.last:
                heappush(self.now, index)
            else:
                self.later.add(index)


@dataclass(slots=True)
class Inference:
    """Sorts and dimensions of attributes, to a fixpoint; bare ones are dimensionless in the end.

    A rule is looked at again only after something that it reads has become known.
    """

    grammar: GrammarInfo
    modules: Mapping[str, ModuleInfo]
    attributes: Attributes
    types: Types = field(default_factory=dict[Key, Typed])
    _bare: dict[int, Typed] = field(default_factory=dict[int, Typed])
    _undecided: list[int] = field(default_factory=list[int])

    def run(self) -> Types:
        """The type of every attribute that can be inferred."""
        root = (self.grammar.grammar.start, ROOT_ATTRIBUTE)
        if root in self.attributes.inherited:
            self.types[root] = Typed(ir.World(), Sort.FRAME, None)
        rules, readers = self.attributes.rules, self._readers()
        rounds = _Rounds(list(range(len(rules))))
        while True:
            index = rounds.take()
            if index is not None:
                found = self._dimensioned(index)
            elif self._undecided:
                index = heappop(self._undecided)
                found = self._dimensionless(index)
            else:
                return self.types
            if found is not None:
                self.types[rules[index].key] = found
                rounds.add(readers.get(rules[index].key, ()))

    def _readers(self) -> dict[Key, list[int]]:
        """For each attribute the numbers of the rules that read it."""
        readers: dict[Key, list[int]] = {}
        for index, placed in enumerate(self.attributes.rules):
            info = self.grammar.productions[placed.label]
            for found in readings([placed.rule.value]):
                if isinstance(found, s.Member):
                    owner = found.owner.text
                    occurrence = ir.THIS if owner == "this" else info.names.get(owner)
                    if occurrence is not None:
                        key = (nonterminal_at(info, occurrence) or "", found.name.text)
                        readers.setdefault(key, []).append(index)
        return readers

    def _dimensioned(self, index: int) -> Typed | None:
        """The type of what a rule defines, if it is new and not bare."""
        placed = self.attributes.rules[index]
        self._bare.pop(index, None)
        if placed.key in self.types:
            return None
        value = self._infer(placed)
        if value.sort is Sort.UNKNOWN:
            return None
        if value.bare:
            self._bare[index] = value
            heappush(self._undecided, index)
            return None
        return replace(value, declared=None, angular=False)

    def _dimensionless(self, index: int) -> Typed | None:
        """The same, where nothing else tells more."""
        value = self._bare.pop(index, None)
        if value is None or self.attributes.rules[index].key in self.types:
            return None
        return replace(value, dimension=ONE)

    def _infer(self, placed: PlacedRule) -> Typed:
        info = self.grammar.productions[placed.label]
        scope = ProductionScope(info, self.modules, self.attributes, self.types)
        return Checker(scope, Sink()).elaborate(placed.rule.value)


# --- lowering ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SemanticsInfo:
    """The blocks of a grammar and what in them depends on plane or space (nothing after errors)."""

    blocks: Mapping[str, ir.SemanticBlock]
    uses: tuple[DimensionUse, ...]


def _fits(value: Typed, due: Typed | None, at: Span, sink: Sink) -> None:
    """Check a rule's value against the type of its attribute."""
    if due is None or Sort.UNKNOWN in {value.sort, due.sort}:
        return
    if value.sort is not due.sort:
        wrong_sort(value, due.sort.value, at, sink)
    elif due.dimension is not None and value.dimension not in {None, due.dimension}:
        mismatch(value, due.dimension, at, sink)


def _rule(placed: PlacedRule, scope: ProductionScope, sink: Sink) -> ir.AttributeRule:
    value = Checker(scope, sink).elaborate(placed.rule.value)
    _fits(value, scope.types.get(placed.key), placed.rule.value.span, sink)
    if too_large(value.expr):
        sink.error(
            Code.TOO_DEEP, "this expression is too large", placed.rule.span, "use more attributes"
        )
        return ir.AttributeRule(placed.target, ZERO, placed.rule.span)
    mentions = scope.mentions([placed.rule.value])
    return ir.AttributeRule(placed.target, value.expr, placed.rule.span, mentions)


def _check_dofs(scope: ProductionScope, block: s.Block, sink: Sink) -> None:
    """Each degree of freedom of each module occurrence is used exactly once."""
    production = scope.info.production
    called_by = {place: name for name, place in scope.info.names.items()}
    for position, symbol in enumerate(production.right):
        module = scope.modules.get(symbol.name)
        for name in () if module is None else module.dofs:
            places = scope.dofs.get(ir.DofOf(position, name), [])
            called = f"`{symbol.alias or called_by.get(position, symbol.name)}.{name}`"
            if not places:
                message = f"production `{production.label}` does not use {called}"
                hint = f"use {called} once, in a `rot` or `move`"
                sink.error(Code.BAD_DOF_USE, message, block.label.span, hint)
            for place in places[1:]:
                message = f"{called} is used more than once"
                notes = [(places[0], "first here")]
                hint = "give the moved frame to an attribute, and use that"
                sink.error(Code.BAD_DOF_USE, message, place, hint, notes)


def _block(
    block: s.Block, rules: list[PlacedRule], scope: ProductionScope, sink: Sink
) -> ir.SemanticBlock:
    lowered = tuple(_rule(placed, scope, sink) for placed in rules)
    symbols = scope.info.production.right
    emissions = Emissions(scope, sink, [scope.modules.get(symbol.name) for symbol in symbols])
    emitted = [emissions.lower(e) for e in block.statements if isinstance(e, s.Emission)]
    failed = scope.info.broken or None in emitted
    if not failed and scope.info.production.label not in scope.attributes.failed:
        _check_dofs(scope, block, sink)
    return ir.SemanticBlock(lowered, tuple(e for e in emitted if e is not None), block.span)


def _blocks(grammar: GrammarInfo, semantics: s.Semantics, sink: Sink) -> dict[str, s.Block]:
    """The blocks by label; unknown, repeated and missing ones are reported."""
    found: dict[str, s.Block] = {}
    meant: set[str | None] = set()
    for block in semantics.blocks:
        label = block.label
        if label.text not in grammar.productions:
            meant.add(nearest(label.text, grammar.productions, sink))
            message = f"grammar `{grammar.grammar.name}` has no production `{label.text}`"
            hint = did_you_mean(label.text, grammar.productions, "production", sink)
            sink.error(Code.UNKNOWN_NAME, message, label.span, hint)
        elif label.text in found:
            duplicate(label, found[label.text].label.span, sink)
        else:
            found[label.text] = block
    for label_text, info in grammar.productions.items():
        if label_text not in found and label_text not in meant:
            message = f"production `{label_text}` has no block in the semantics"
            notes = [(info.production.span, "the production")]
            hint = f"add `{label_text} {{ }}`, at least"
            sink.error(Code.MISSING_BLOCK, message, semantics.grammar.span, hint, notes)
    return found


def _check_inferred(attributes: Attributes, types: Types, sink: Sink) -> None:
    """Report the attributes whose every definition refers to itself in another derivation."""
    for (nonterminal, name), span in (
        *attributes.synthesized.items(),
        *attributes.inherited.items(),
    ):
        if (nonterminal, name) not in types:
            message = f"nothing determines what the attribute `{name}` of `{nonterminal}` is"
            hint = "no production defines it without reading it; add one that does"
            sink.error(Code.UNDEFINED_ATTRIBUTE, message, span, hint)


def _check_cycle(grammar: GrammarInfo, blocks: Mapping[str, ir.SemanticBlock], sink: Sink) -> None:
    found = cycle(grammar.grammar.productions, blocks)
    if found is None:
        return
    production, nodes = found
    called = occurrence_names(production)
    names = [
        f"{'this' if n.occurrence == ir.THIS else called[n.occurrence]}.{n.name}" for n in nodes
    ]
    if len(names) > 2 * _ENDS + 1:
        names[_ENDS:-_ENDS] = [f"… {len(names) - 2 * _ENDS} more …"]
    around = frozenset(nodes)
    here = [rule.span for rule in blocks[production.label].rules if rule.target in around]
    message = f"circular attributes in production `{production.label}`: "
    hint = "an attribute cannot depend on itself"
    sink.error(
        Code.CIRCULAR_ATTRIBUTES,
        message + " -> ".join([*names, names[0]]),
        here[0] if here else production.span,
        hint,
    )


def lower_semantics(
    grammar: GrammarInfo, semantics: s.Semantics, modules: Mapping[str, ModuleInfo], sink: Sink
) -> SemanticsInfo:
    """The semantics of a grammar; whatever is wrong with it is reported."""
    before = len(sink.found)
    blocks = _blocks(grammar, semantics, sink)
    attributes = collect_attributes(grammar, blocks, sink)
    check_complete(grammar, blocks, attributes, sink)
    types = Inference(grammar, modules, attributes).run()
    rules: dict[str, list[PlacedRule]] = {}
    for placed in attributes.rules:
        rules.setdefault(placed.label, []).append(placed)
    lowered: dict[str, ir.SemanticBlock] = {}
    uses: list[DimensionUse] = []
    for label, info in grammar.productions.items():
        if label in blocks:
            scope = ProductionScope(info, modules, attributes, types)
            lowered[label] = _block(blocks[label], rules.get(label, []), scope, sink)
            uses.extend(scope.uses)
    if Sink(sink.found[before:]).has_errors:
        return SemanticsInfo(lowered, ())
    _check_cycle(grammar, lowered, sink)
    if not Sink(sink.found[before:]).has_errors:
        _check_inferred(attributes, types, sink)
    return SemanticsInfo(lowered, tuple(uses))
