"""Semantics (Definition 5): the typed attribute rules and emissions of each production."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean, nearest
from grammar_lang.elaboration.attribute_types import Inference, ProductionScope, Types
from grammar_lang.elaboration.attributes import (
    Attributes,
    PlacedRule,
    check_complete,
    collect_attributes,
)
from grammar_lang.elaboration.circularity import cycle
from grammar_lang.elaboration.emissions import Emissions
from grammar_lang.elaboration.frames import report_reuse
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.productions import GrammarInfo
from grammar_lang.elaboration.sorts import (
    ZERO,
    DimensionUse,
    Sort,
    Typed,
    mismatch,
    wrong_sort,
)
from grammar_lang.elaboration.typecheck import Checker
from grammar_lang.ir.expression_text import attribute_text, called_in, occurrence_names
from grammar_lang.ir.expressions import too_large
from grammar_lang.names.declarations import duplicate
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span

_ENDS = 3
"""The number of attributes named at either end of a long cycle."""


# --- Lowering ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SemanticsInfo:
    """The blocks of a grammar, and the uses that depend on plane or space (empty after errors)."""

    blocks: Mapping[str, ir.SemanticBlock]
    uses: tuple[DimensionUse, ...]


def _fits(value: Typed, due: Typed | None, at: Span, sink: Sink) -> None:
    """Check the value of a rule against the type of its attribute."""
    if due is None or Sort.UNKNOWN in {value.sort, due.sort}:
        return
    if value.sort is not due.sort:
        wrong_sort(value, due.sort.value, at, sink)
    elif due.dimension is not None and value.dimension not in {None, due.dimension}:
        mismatch(value, due.dimension, at, sink)


def _rule(placed: PlacedRule, scope: ProductionScope, sink: Sink) -> ir.AttributeRule:
    value = Checker(scope, sink).elaborate(placed.value)
    _fits(value, scope.types.get(placed.key), placed.value.span, sink)
    if too_large(value.expr):
        message, hint = "this expression is too large", "use more attributes"
        sink.error(Code.TOO_DEEP, message, placed.span, hint)
        return ir.AttributeRule(placed.target, ZERO, placed.span)
    mentions = scope.mentions([placed.value])
    return ir.AttributeRule(placed.target, value.expr, placed.span, mentions)


def _uses(scope: ProductionScope, position: int, dof: str) -> list[Span]:
    """The places where a degree of freedom is used: in the block, and in the module if mounted."""
    places = list(scope.dofs.get(ir.DofOf(position, dof), ()))
    info = scope.info
    if (info.production.label, position) in scope.attributes.mounted:
        module = scope.modules.get(info.production.right[position].name)
        if module is not None and module.body is not None and dof in module.body.used:
            places.append(module.body.used[dof])
    return places


def _check_mounted(scope: ProductionScope, block: s.Block, sink: Sink) -> None:
    """Report the modules that have frames or bodies but are not mounted by a production."""
    production = scope.info.production
    for position, symbol in enumerate(production.right):
        module = scope.modules.get(symbol.name)
        body = None if module is None else module.body
        if body is None or (production.label, position) in scope.attributes.mounted:
            continue
        if body.frames or body.emissions:
            called = occurrence_names(production)[position]
            message = f"production `{production.label}` does not mount `{called}`"
            hint = f"add `{called}.in = …;`: the module has frames or bodies of its own"
            sink.error(Code.NOT_MOUNTED, message, block.label.span, hint)


def _check_dofs(scope: ProductionScope, block: s.Block, sink: Sink) -> None:
    """Check that each degree of freedom of each module occurrence is used exactly once."""
    production = scope.info.production
    called_by = {place: name for name, place in scope.info.names.items()}
    for position, symbol in enumerate(production.right):
        module = scope.modules.get(symbol.name)
        body = None if module is None else module.body
        mounted = (production.label, position) in scope.attributes.mounted
        for name in () if module is None else module.dofs:
            if body is not None and name in body.used and not mounted:
                continue
            places = _uses(scope, position, name)
            called = f"{symbol.alias or called_by.get(position, symbol.name)}.{name}"
            if not places:
                message = f"production `{production.label}` does not use `{called}`"
                hint = f"use `{called}` once, in a `rot` or `move`"
                sink.error(Code.BAD_DOF_USE, message, block.label.span, hint)
            report_reuse(called, places, "assign the moved frame to an attribute", sink)


def _block(
    block: s.Block,
    rules: list[PlacedRule],
    scope: ProductionScope,
    meshes: Mapping[Span, ir.Mesh | ir.VisualFile],
    sink: Sink,
) -> ir.SemanticBlock:
    production, before = scope.info.production, len(sink.found)
    modules = [scope.modules.get(symbol.name) for symbol in production.right]
    emissions = Emissions(scope, sink, modules, meshes)
    by_place = {placed.span: placed for placed in rules}
    lowered: list[ir.AttributeRule] = []
    emitted: list[ir.Emitted | None] = []
    for statement in block.statements:
        if isinstance(statement, s.Emission):
            emitted.append(emissions.lower(statement))
        elif statement.span in by_place:
            placed = by_place[statement.span]
            lowered.append(_rule(placed, scope, sink))
            if placed.mounts is not None:
                frames, bodies = _mounted(placed.mounts, scope)
                lowered += frames
                emitted += bodies
    if not scope.info.broken and production.label not in scope.attributes.failed:
        if None not in emitted and not Sink(sink.found[before:]).has_errors:
            _check_dofs(scope, block, sink)
        _check_mounted(scope, block, sink)
    return ir.semantic_block(lowered, (e for e in emitted if e is not None), block.span)


def _mounted(
    position: int, scope: ProductionScope
) -> tuple[tuple[ir.AttributeRule, ...], tuple[ir.Emitted, ...]]:
    """The frames and emissions of the module at a position."""
    production = scope.info.production
    module = scope.modules[production.right[position].name]
    if module.body is None:
        return (), ()
    scope.uses.extend(use for use in module.body.uses if use not in scope.uses)
    return module.body.mounted(position, occurrence_names(production)[position])


def _blocks(
    grammar: GrammarInfo, semantics: s.Semantics, names: NameTable, sink: Sink
) -> dict[str, s.Block]:
    """The blocks by label; unknown, repeated and missing ones are reported."""
    found: dict[str, s.Block] = {}
    meant: set[str | None] = set()
    for block in semantics.blocks:
        label = block.label
        if names.entity(label) is None:
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
            hint = f"add at least `{label_text} {{ }}`"
            sink.error(Code.MISSING_BLOCK, message, semantics.grammar.span, hint, notes)
    return found


def _check_inferred(attributes: Attributes, types: Types, sink: Sink) -> None:
    """Report attributes whose type is undetermined because all their definitions are recursive."""
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
    names = [attribute_text(node, lambda where: called_in(where, called)) for node in nodes]
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
    grammar: GrammarInfo,
    semantics: s.Semantics,
    modules: Mapping[str, ModuleInfo],
    names: NameTable,
    meshes: Mapping[Span, ir.Mesh | ir.VisualFile],
    sink: Sink,
) -> SemanticsInfo:
    """The semantics of a grammar; errors in it are reported.

    ``meshes`` are keyed by the span of the path that names each.
    """
    before = len(sink.found)
    blocks = _blocks(grammar, semantics, names, sink)
    attributes = collect_attributes(grammar, blocks, modules, names, sink)
    check_complete(grammar, blocks, attributes, names, sink)
    types = Inference(grammar, modules, attributes, names).run()
    rules: dict[str, list[PlacedRule]] = {}
    for placed in attributes.rules:
        rules.setdefault(placed.label, []).append(placed)
    lowered: dict[str, ir.SemanticBlock] = {}
    uses: list[DimensionUse] = []
    for label, info in grammar.productions.items():
        if label in blocks:
            scope = ProductionScope(info, modules, attributes, types, names)
            lowered[label] = _block(blocks[label], rules.get(label, []), scope, meshes, sink)
            uses.extend(scope.uses)
    if Sink(sink.found[before:]).has_errors:
        return SemanticsInfo(lowered, ())
    _check_cycle(grammar, lowered, sink)
    if not Sink(sink.found[before:]).has_errors:
        _check_inferred(attributes, types, sink)
    return SemanticsInfo(lowered, tuple(uses))
