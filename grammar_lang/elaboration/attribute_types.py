"""Infer the sort and dimension of every attribute from the rules that define it.

Sorts and dimensions propagate from what is known (numbers, parameters, ``world``) through the rules
to a fixpoint.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.attributes import (
    ROOT_ATTRIBUTE,
    Attributes,
    Key,
    PlacedRule,
    local_key,
    nonterminal_at,
    occurrence_of,
)
from grammar_lang.elaboration.modules import INPUT, ModuleInfo, frame_of
from grammar_lang.elaboration.productions import GrammarInfo, ProductionInfo
from grammar_lang.elaboration.sorts import UNKNOWN, ZERO, DimensionUse, Sort, Typed
from grammar_lang.elaboration.typecheck import Checker, plain_name
from grammar_lang.ir.constants import is_closed
from grammar_lang.ir.expression_text import occurrence_names
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.units import ONE

Types: TypeAlias = dict[Key, Typed]


@dataclass(slots=True)
class ProductionScope:
    """The meaning of names in the block of a production."""

    info: ProductionInfo
    modules: Mapping[str, ModuleInfo]
    attributes: Attributes
    types: Types
    names: NameTable
    uses: list[DimensionUse] = field(default_factory=list[DimensionUse])
    dofs: dict[ir.DofOf, list[Span]] = field(default_factory=dict[ir.DofOf, list[Span]])

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """A local value, ``pi``, or an error."""
        label = self.info.production.label
        key = local_key(label, ident.text)
        if key not in self.attributes.local:
            local = [name for owner, name in self.attributes.local if owner == key[0]]
            known = (*(name for name in local if "." not in name), *self.info.names)
            return plain_name(ident, known, sink)
        found = self.types.get(key, UNKNOWN)
        if found.sort in {Sort.SCALAR, Sort.VECTOR} and is_closed(found.expr):
            return found
        return replace(found, expr=ir.AttributeOf(ir.LOCAL, ident.text))

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """A parameter, a constant or an attribute."""
        occurrence = occurrence_of(member.owner, self.info, sink)
        if occurrence is None:
            return UNKNOWN
        if nonterminal_at(self.info, occurrence) is None:
            return self._of_module(occurrence, member, sink)
        return self._attribute(occurrence, member, sink)

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        """The degree of freedom that ``owner.name`` refers to, if any."""
        if isinstance(name, s.Name):
            return None
        module = self._module(self.info.names.get(name.owner.text))
        return None if module is None else module.dofs.get(name.name.text)

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        """Record a correct use of a degree of freedom.

        Raises:
            LookupError: the name is not a degree of freedom of a symbol of the production.
        """
        match name:
            case s.Member(owner=owner):
                use = ir.DofOf(self.info.names[owner.text], name.name.text)
                self.dofs.setdefault(use, []).append(name.span)
                return use
            case s.Name(ident=ident):
                raise LookupError(ident.text)

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """The modules of the production that expressions name, in order of first mention.

        This uses the names in the text, because the intermediate representation folds constants
        away.
        """
        if self.info.broken:
            return ()
        right = self.info.production.right
        found: dict[int, None] = {}
        for mention in (m for expr in expressions for m in self.names.inside(expr.span)):
            position = mention.position
            if position is not None and position >= 0 and right[position].kind == "module":
                found[position] = None
        return tuple(found)

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
        if module.body is not None and (name == INPUT or name in module.body.frames):
            return self._frame(occurrence, member, sink)
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

    def _frame(self, occurrence: int, member: s.Member, sink: Sink) -> Typed:
        """A frame of a mounted module."""
        production = self.info.production
        called = occurrence_names(production)[occurrence]
        target = frame_of(called, member.name.text)
        if (production.label, occurrence) not in self.attributes.mounted:
            if production.label not in self.attributes.failed:
                message = f"`{member.owner.text}` is not mounted in production `{production.label}`"
                hint = f"add `{called}.in = …;`: where the module stands"
                sink.error(Code.NOT_MOUNTED, message, member.span, hint)
            return UNKNOWN
        return Typed(target, Sort.FRAME, None)

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


# --- Inference ---------------------------------------------------------------------------------


@dataclass(slots=True)
class _Rounds:
    """A queue of rule numbers, in rounds: ascending in each round, and each number once."""

    now: list[int]
    later: set[int] = field(default_factory=set[int])
    last: int = -1

    def take(self) -> int | None:
        """The next number; starts a new round if this one is finished; None if nothing is left."""
        while self.now or self.later:
            if not self.now:
                self.now, self.later, self.last = sorted(self.later), set(), -1
            index = heappop(self.now)
            if index != self.last:
                self.last = index
                return index
        return None

    def add(self, indices: Iterable[int]) -> None:
        """Queue these numbers again."""
        for index in indices:
            if index > self.last:
                heappush(self.now, index)
            else:
                self.later.add(index)


@dataclass(slots=True)
class Inference:
    """Infers sorts and dimensions of attributes to a fixpoint; bare ones become dimensionless.

    A rule is inferred again only after something that it reads has become known.
    """

    grammar: GrammarInfo
    modules: Mapping[str, ModuleInfo]
    attributes: Attributes
    names: NameTable
    types: Types = field(default_factory=dict[Key, Typed])
    _bare: dict[int, Typed] = field(default_factory=dict[int, Typed])
    _undecided: list[int] = field(default_factory=list[int])

    def run(self) -> Types:
        """The type of every attribute that can be inferred."""
        for placed in self.attributes.rules:
            if placed.mounts is not None:
                self.types[placed.key] = Typed(placed.target, Sort.FRAME, None)
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
        """For each attribute, the numbers of the rules that read it."""
        readers: dict[Key, list[int]] = {}
        for index, placed in enumerate(self.attributes.rules):
            for mention in self.names.inside(placed.value.span):
                read = mention.entity
                if read.kind == "attribute":
                    readers.setdefault((read.scope[1], read.name), []).append(index)
                elif read.kind == "local value":
                    readers.setdefault(local_key(placed.label, read.name), []).append(index)
        return readers

    def _dimensioned(self, index: int) -> Typed | None:
        """The type of the target of a rule, if it is new and not bare."""
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
        local = placed.target.occurrence == ir.LOCAL
        return replace(value, declared=None, angular=local and value.angular)

    def _dimensionless(self, index: int) -> Typed | None:
        """The type of the target of a bare rule, once nothing else determines its dimension."""
        value = self._bare.pop(index, None)
        if value is None or self.attributes.rules[index].key in self.types:
            return None
        return replace(value, dimension=ONE)

    def _infer(self, placed: PlacedRule) -> Typed:
        info = self.grammar.productions[placed.label]
        scope = ProductionScope(info, self.modules, self.attributes, self.types, self.names)
        return Checker(scope, Sink()).elaborate(placed.value)
