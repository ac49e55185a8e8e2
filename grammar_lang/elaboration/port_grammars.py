"""Grammars from ports: productions that say which modules fit where, with their semantics.

An output can carry the listed modules whose `in` has the same type and the opposite gender (or no
gender, if the output has none).  For each type and gender of outputs there is one nonterminal.
Each module is one production, with its outputs filled in declaration order:

    Fork: Flange -> Fork left:Flange right:Flange

with ``Fork.in = this.frame``, ``left.frame = Fork.left`` and ``right.frame = Fork.right``.  Any two
productions of a nonterminal begin with different modules, so every word has one derivation.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.elaboration.attributes import ROOT_ATTRIBUTE
from grammar_lang.elaboration.modules import INPUT, ModuleInfo, frame_of
from grammar_lang.elaboration.ports import OTHER, Checks, Clauses, Fit, Part, fit_of
from grammar_lang.elaboration.productions import GrammarInfo, grammar_of
from grammar_lang.elaboration.semantics import SemanticsInfo
from grammar_lang.names.table import NameTable


def _fresh(name: str, taken: Collection[str]) -> str:
    while name in taken:
        name += "_"
    return name


@dataclass(slots=True)
class _Productions:
    """Builds the productions of the modules that occur in robots."""

    terminals: Collection[str]
    nonterminals: dict[Fit, str] = field(default_factory=dict[Fit, str])

    def name(self, parts: Iterable[Part]) -> str:
        """Give each type and gender of outputs a nonterminal; return the start symbol."""
        taken = set(self.terminals)
        for part in parts:
            for port in part.outputs:
                kind, gender = fit = fit_of(port)
                if fit not in self.nonterminals:
                    plain = kind if gender is None else f"{kind}_{OTHER[gender]}"
                    self.nonterminals[fit] = _fresh(plain, taken)
                    taken.add(self.nonterminals[fit])
        return _fresh("Robot", taken)

    def production(self, label: str, left: str, part: Part) -> ir.Production:
        """The production of a module; outputs of the same type get aliases."""
        names = [self.nonterminals[fit_of(port)] for port in part.outputs]
        total = Counter(names)
        taken = {*self.terminals, *self.nonterminals.values()}
        right = [ir.Symbol(part.name, "module", None, part.place)]
        for name, port in zip(names, part.outputs, strict=True):
            alias = _fresh(port.name.text, taken) if total[name] > 1 else None
            taken.add(alias or name)
            right.append(ir.Symbol(name, "nonterminal", alias, port.type.span))
        return ir.Production(label, left, tuple(right), part.place)


def _block(part: Part) -> ir.SemanticBlock:
    """The semantic block that mounts the module at its frame and passes on its outputs.

    These rules have no place in the text.
    """
    body = part.info.body
    if body is None:
        return ir.SemanticBlock((), (), part.place)
    mount = frame_of(part.name, INPUT)
    here = ir.AttributeOf(ir.THIS, ROOT_ATTRIBUTE)
    frames, emissions = body.mounted(0, part.name)
    carried = (
        ir.AttributeRule(
            ir.AttributeOf(number, ROOT_ATTRIBUTE),
            frame_of(part.name, port.name.text),
            mentions=(0,),
        )
        for number, port in enumerate(part.outputs, 1)
    )
    rules = (ir.AttributeRule(mount, here), *frames, *carried)
    return ir.semantic_block(rules, emissions, part.place)


def lower_port_grammar(
    grammar: s.Grammar,
    modules: Mapping[str, ModuleInfo],
    broken: Collection[str],
    names: NameTable,
    sink: Sink,
) -> tuple[GrammarInfo, SemanticsInfo]:
    """A grammar from ports, and its semantics; errors in it are reported.

    ``broken`` are the modules with statements that could not be parsed.
    """
    clauses = Clauses(grammar, modules, names, sink, broken)
    clauses.read()
    if clauses.start is None:
        return GrammarInfo(grammar_of(grammar, "", (), clauses.accepts), {}), SemanticsInfo({}, ())
    first = clauses.start
    listed = Checks(clauses, first).run()
    made = _Productions(names.declared.terminals)
    start = made.name((first, *listed))
    label = _fresh(first.name, {part.name for part in listed})
    productions = [made.production(label, start, first)]
    blocks = {label: _block(first)}
    for part in listed:
        if part.stands_at in made.nonterminals:
            left = made.nonterminals[part.stands_at]
            productions.append(made.production(part.name, left, part))
            blocks[part.name] = _block(part)
    uses = (use for part in (first, *listed) if part.info.body for use in part.info.body.uses)
    found = grammar_of(grammar, start, productions, clauses.accepts)
    found = replace(found, listed=frozenset({first.name, *clauses.listed}))
    return GrammarInfo(found, {}), SemanticsInfo(blocks, tuple(dict.fromkeys(uses)))
