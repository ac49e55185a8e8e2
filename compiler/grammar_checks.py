"""Findings about grammars: useless symbols, empty, cyclic, toolless and ambiguous languages.

Reachability and productivity as in Hopcroft, Motwani, Ullman, section 7.1.  Ambiguity of a
context-free grammar is undecidable: short words are searched for two derivations, and nothing is
said where none is found.
"""

from __future__ import annotations

from itertools import islice

from compiler.acceptance import accept_dfa
from compiler.derivation import Derivation, structures
from compiler.finite_automaton import AutomatonTooLargeError, intersection
from compiler.grammar import Srg, cyclic, productive, reachable, srg, trimmed
from compiler.language import Language, restrict
from grammar_lang import ir
from grammar_lang.codes import Code
from grammar_lang.diagnostics import Sink
from grammar_lang.source import Span

WITNESS_DERIVATIONS = 64
WITNESS_SYMBOLS = 600
WITNESS_MODULES = 6


def grammar_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report what is wrong with, or suspicious in, the grammars of a program."""
    if program.grammars:
        _unused_symbols(program, sink)
    for grammar in program.grammars.values():
        _grammar(program, grammar, sink)


def _unused_symbols(program: ir.Program, sink: Sink) -> None:
    used = {
        symbol.name
        for grammar in program.grammars.values()
        for production in grammar.productions
        for symbol in production.right
        if symbol.kind != "nonterminal"
    }
    for name in program.terminals:
        if name not in used:
            module = program.modules.get(name)
            sink.warning(
                Code.UNUSED_SYMBOL,
                f"{'edge' if module is None else 'module'} {name} is used in no production",
                ir.NOWHERE if module is None else module.span,
                hint=f"use {name} on a right side or remove its declaration",
            )


def _grammar(program: ir.Program, grammar: ir.Grammar, sink: Sink) -> None:
    rules = srg(grammar, program.terminals, program.modules)
    _useless(grammar, rules, sink)
    loops = rules.names(cyclic(trimmed(rules.cfg)))
    for name in loops:
        sink.warning(
            Code.CYCLIC_GRAMMAR,
            f"{name} derives itself, so a robot has infinitely many derivations",
            _place(grammar, name),
            hint=f"remove the productions that lead from {name} back to {name} alone; "
            "synth refuses such a grammar",
        )
    try:
        language = restrict(rules, accept_dfa(grammar.accept, program.terminals))
    except AutomatonTooLargeError as error:
        sink.error(
            Code.NOT_SUPPORTED, str(error), grammar.span, hint="use smaller bounds in accept"
        )
        return
    if not _has_robot(language):
        _empty_language(grammar, rules, sink)
        return
    _effector(program, grammar, language, sink)
    if not loops:
        _ambiguity(grammar, language, sink)


def _useless(grammar: ir.Grammar, rules: Srg, sink: Sink) -> None:
    good, seen = productive(rules.cfg), reachable(rules.cfg)
    for k, name in enumerate(rules.nonterminals):
        if rules.cfg.terminals + k not in seen:
            sink.warning(
                Code.UNREACHABLE,
                f"nonterminal {name} is never reached from {grammar.start}",
                _place(grammar, name),
                hint=f"use {name} on the right side of a reachable production or remove it",
            )
        elif rules.cfg.terminals + k not in good:
            sink.warning(
                Code.UNPRODUCTIVE,
                f"nonterminal {name} derives no word of modules and edges",
                _place(grammar, name),
                hint=f"add a production of {name} that ends in modules, such as `label: {name} -> "
                "MODULE;`",
            )


def _place(grammar: ir.Grammar, name: str) -> Span:
    """The first production of a nonterminal, else its first occurrence, else the grammar."""
    for production in grammar.productions:
        if production.left == name:
            return production.span
    for production in grammar.productions:
        for symbol in production.right:
            if symbol.kind == "nonterminal" and symbol.name == name:
                return symbol.span
    return grammar.span


def _has_robot(language: Language) -> bool:
    """Whether there is a word other than the empty one, which is no robot."""
    return bool(language.product.starts)


def _empty_language(grammar: ir.Grammar, rules: Srg, sink: Sink) -> None:
    everything = restrict(rules, accept_dfa(ir.AllOf(()), rules.terminals))
    example = next((word for word in everything.words() if word), None)
    if example is None:
        message = f"grammar {grammar.name} derives no robot"
        hint = f"give {grammar.start} a production whose right side ends in modules"
    else:
        message = f"no word of grammar {grammar.name} satisfies its accept condition"
        hint = f"the grammar derives `{' '.join(example)}`, for instance, which is not accepted"
    sink.error(Code.EMPTY_LANGUAGE, message, grammar.span, hint=hint)


def _effector(program: ir.Program, grammar: ir.Grammar, language: Language, sink: Sink) -> None:
    tools = [m.name for m in program.modules.values() if m.role == "effector"]
    with_tool = accept_dfa(
        ir.AnyOf(tuple(ir.Contains((tool,)) for tool in tools)), program.terminals
    )
    if not _has_robot(restrict(language.srg, intersection(language.accept, with_tool))):
        sink.warning(
            Code.NO_EFFECTOR,
            f"no accepted word of grammar {grammar.name} contains an effector module",
            grammar.span,
            hint=f"derive a module of role effector ({', '.join(tools)})"
            if tools
            else "declare a module with `role effector;` and derive it",
        )


def _ambiguity(grammar: ir.Grammar, language: Language, sink: Sink) -> None:
    witness = ambiguity_witness(language)
    if witness is None:
        return
    first, second = witness
    step = next(
        i
        for i, pair in enumerate(zip(first.labels, second.labels, strict=False))
        if pair[0] != pair[1]
    )
    sink.warning(
        Code.AMBIGUOUS_GRAMMAR,
        f"grammar {grammar.name} is ambiguous: `{' '.join(first.word)}` has several derivations",
        second.nodes[step].production.span,
        hint=f"they part at step {step + 1}: {first.labels[step]} or {second.labels[step]}; "
        "each derivation counts as a structure of its own",
    )


def ambiguity_witness(language: Language) -> tuple[Derivation, Derivation] | None:
    """The first two derivations of the first ambiguous word, among the shortest words only.

    The language's grammar must not be cyclic.  None says that no witness was found, not that the
    grammar is unambiguous.
    """
    symbols = 0
    last: Derivation | None = None
    for derivation in islice(structures(language, WITNESS_MODULES), WITNESS_DERIVATIONS):
        if last is not None and last.word == derivation.word:
            return last, derivation
        last = derivation
        symbols += len(derivation.word)
        if symbols > WITNESS_SYMBOLS:
            return None
    return None
