"""Findings about grammars: useless symbols, empty, finite, cyclic, toolless, ambiguous languages.

Reachability and productivity are as in Hopcroft, Motwani, Ullman, section 7.1. Every grammar is
checked over its own symbols only, so the time is linear in the number of grammars of a file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from compiler.checks.ambiguity_checks import ambiguity_diagnostics
from compiler.words.acceptance import accept_dfa
from compiler.words.ambiguity import ProductionCycle, ambiguity, production_cycles
from compiler.words.finite_automaton import AutomatonTooLargeError, intersection
from compiler.words.grammar import Srg, alphabet_of, productive, reachable, srg
from compiler.words.intersection import CHECKED_RULES, IntersectionTooLargeError
from compiler.words.language import Language, longest_word, number_of_words, restrict
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.source import Span

EXACT_BELOW = 10**9
LISTED_TOOLS = 5


@dataclass(frozen=True, slots=True)
class _Context:
    """Data shared by the checks of all grammars of a program."""

    program: ir.Program
    order: Mapping[str, int]
    tools: tuple[str, ...]
    tasks: Mapping[str, Sequence[ir.Task]]
    complete: bool


def grammar_diagnostics(program: ir.Program, sink: Sink, *, complete: bool = True) -> None:
    """Report errors and suspicious points in the grammars of a program.

    Args:
        program: the program.
        sink: where to report.
        complete: False if items with errors were left out of the program; then nothing is
            reported that they might refute, and there are no notes in addition to the errors.
    """
    if program.grammars and complete:
        _unused_symbols(program, sink)
    tasks: dict[str, list[ir.Task]] = {}
    for task in program.tasks.values():
        tasks.setdefault(task.grammar, []).append(task)
    context = _Context(
        program,
        {name: i for i, name in enumerate(program.terminals)},
        tuple(m.name for m in program.modules.values() if m.role == "effector"),
        tasks,
        complete,
    )
    for grammar in program.grammars.values():
        _grammar(context, grammar, sink)


def cycle_diagnostics(program: ir.Program, grammar: ir.Grammar, sink: Sink) -> None:
    """Report the derivations A =>+ A of a grammar."""
    for cycle in production_cycles(srg(grammar, program.terminals, program.modules)):
        _cycle(cycle, sink)


def _unused_symbols(program: ir.Program, sink: Sink) -> None:
    used = {
        symbol.name
        for grammar in program.grammars.values()
        for production in grammar.productions
        for symbol in production.right
        if symbol.kind != "nonterminal"
    }
    used |= {name for grammar in program.grammars.values() for name in grammar.listed}
    for name in program.terminals:
        # An included file is a library, and programs rarely use all of it.
        if name not in used and program.terminal_spans.get(name, ir.NOWHERE).file == 0:
            sink.warning(
                Code.UNUSED_SYMBOL,
                f"{'module' if program.is_module(name) else 'edge'} `{name}` is used in no "
                "production",
                program.terminal_spans.get(name, ir.NOWHERE),
                hint=f"use `{name}` on a right side, or in `with`, or remove its declaration",
            )


def _grammar(context: _Context, grammar: ir.Grammar, sink: Sink) -> None:
    rules = srg(grammar, alphabet_of(grammar, context.order), context.program.modules)
    _useless(grammar, rules, sink)
    cycles = production_cycles(rules)
    for cycle in cycles:
        _cycle(cycle, sink)
    language = _language(grammar, rules, sink)
    if language is None:
        return
    if not _has_robot(language):
        _empty_language(grammar, rules, sink)
        return
    _effector(context, grammar, language, sink)
    if context.complete:
        _module_bounds(context.tasks.get(grammar.name, ()), language, sink)
    unambiguous, longest = False, longest_word(language)
    if not cycles:
        found = ambiguity(language, longest)
        unambiguous = found.decided and not found.words
        tasks = context.tasks.get(grammar.name, ())
        ambiguity_diagnostics(context.program, grammar, language, found, tasks, sink)
    if longest is not None and context.complete:
        words = number_of_words(language, longest, unambiguous=unambiguous)
        _finite(grammar, words, longest, sink)


def _language(grammar: ir.Grammar, rules: Srg, sink: Sink) -> Language | None:
    """The accepted words; None, with a finding, if they cannot be computed."""
    try:
        return restrict(rules, accept_dfa(grammar.accept, rules.terminals), CHECKED_RULES)
    except AutomatonTooLargeError as error:
        hint = "use smaller bounds in accept"
        sink.error(Code.NOT_SUPPORTED, str(error), grammar.span, hint=hint)
    except IntersectionTooLargeError:
        sink.note(
            Code.NOT_SUPPORTED,
            f"the words of grammar `{grammar.name}` are not checked: with its accept condition it "
            f"has over {CHECKED_RULES:,} rules",
            grammar.span,
            hint="smaller bounds in `accept` make them fewer",
        )
    return None


def _cycle(cycle: ProductionCycle, sink: Sink) -> None:
    first, *others = cycle.productions
    labels = ", ".join(f"`{production.label}`" for production in cycle.productions)
    vanishing = ", ".join(f"`{name}`" for name in cycle.vanishing)
    instead = f", or let {vanishing} not derive the empty word" if vanishing else ""
    sink.warning(
        Code.CYCLIC_GRAMMAR,
        f"`{first.left}` derives itself, so a robot has infinitely many derivations: "
        f"`{' -> '.join(cycle.nonterminals)}`",
        first.span,
        hint=f"remove {'one of the productions' if others else 'the production'} {labels}"
        f"{instead}; `synth` refuses such a grammar",
        notes=[
            (production.span, f"`{left} -> {right}` by this production")
            for production, (left, right) in zip(
                others, pairwise(cycle.nonterminals[1:]), strict=True
            )
        ],
    )


def _useless(grammar: ir.Grammar, rules: Srg, sink: Sink) -> None:
    good, seen = productive(rules.cfg), reachable(rules.cfg)
    useless = [
        name
        for k, name in enumerate(rules.nonterminals, start=rules.cfg.terminals)
        if k not in seen or k not in good
    ]
    places = _places(grammar) if useless else {}
    reached = set(rules.names(seen))
    for name in useless:
        if name not in reached:
            sink.warning(
                Code.UNREACHABLE,
                f"nonterminal `{name}` is never reached from `{grammar.start}`",
                places.get(name, grammar.span),
                hint=f"use `{name}` on the right side of a reachable production or remove it",
            )
        else:
            sink.warning(
                Code.UNPRODUCTIVE,
                f"nonterminal `{name}` derives no word of modules and edges",
                places.get(name, grammar.span),
                hint=f"add a production of `{name}` that ends in modules, such as "
                f"`label: {name} -> MODULE;`",
            )


def _places(grammar: ir.Grammar) -> dict[str, Span]:
    """The first production of every nonterminal, or its first occurrence if it has none."""
    places: dict[str, Span] = {}
    for production in grammar.productions:
        places.setdefault(production.left, production.span)
    for production in grammar.productions:
        for symbol in production.right:
            if symbol.kind == "nonterminal":
                places.setdefault(symbol.name, symbol.span)
    return places


def _has_robot(language: Language) -> bool:
    """Whether there is a non-empty word; the empty word is not a robot."""
    return bool(language.product.starts)


def _empty_language(grammar: ir.Grammar, rules: Srg, sink: Sink) -> None:
    everything = restrict(rules, accept_dfa(ir.AllOf(()), rules.terminals))
    example = next((word for word in everything.words() if word), None)
    if example is None:
        message = f"grammar `{grammar.name}` derives no robot"
        hint = f"give `{grammar.start}` a production whose right side ends in modules"
    else:
        message = f"no word of grammar `{grammar.name}` satisfies its accept condition"
        hint = f"the grammar derives `{' '.join(example)}`, for instance, which is not accepted"
    sink.error(Code.EMPTY_LANGUAGE, message, grammar.span, hint=hint)


def _effector(context: _Context, grammar: ir.Grammar, language: Language, sink: Sink) -> None:
    """Warn if no accepted word has a tool, unless an effector may be among what was left out.

    A tool is a module of role effector. Nothing is reported if a production emits an effector but
    places no tool.
    """
    if grammar.semantics is not None and not _emitters(grammar):
        message = f"the semantics of grammar `{grammar.name}` emits no effector"
        hint = "add `effector(frame: …);` to the block that places the tool"
        if grammar.listed:
            message = f"no module of grammar `{grammar.name}` has an effector"
            hint = "add `effector(frame: in);` to the module that is the tool"
        sink.warning(Code.NO_EFFECTOR, message, grammar.span, hint=hint)
        return
    tools_of = set(context.tools)
    if any(not tools_of & {x.name for x in p.right} for p in _emitters(grammar)):
        return
    used = (x.name for p in grammar.productions for x in p.right if x.kind == "module")
    known = all(map(context.program.is_module, used))
    if not context.complete and not (context.tools and known):
        return
    alphabet = language.srg.terminals
    tools = [name for name in context.tools if name in alphabet]
    with_tool = accept_dfa(ir.AnyOf(tuple(ir.Contains((tool,)) for tool in tools)), alphabet)
    try:
        equipped = restrict(language.srg, intersection(language.accept, with_tool), CHECKED_RULES)
    except IntersectionTooLargeError:
        return
    if not _has_robot(equipped):
        listed = ", ".join(context.tools[:LISTED_TOOLS])
        more = ", …" if len(context.tools) > LISTED_TOOLS else ""
        sink.warning(
            Code.NO_EFFECTOR,
            f"no accepted word of grammar `{grammar.name}` contains an effector module",
            grammar.span,
            hint=f"derive a module of role effector ({listed}{more})"
            if listed
            else "declare a module with `role effector;` and derive it",
        )


def _module_bounds(tasks: Sequence[ir.Task], language: Language, sink: Sink) -> None:
    """Report tasks that allow fewer modules than any word has."""
    for task in tasks:
        fewest = None if task.modules is None else language.fewest_modules()
        if task.modules is None or fewest is None or task.modules >= fewest:
            continue
        sink.warning(
            Code.TOO_FEW_MODULES,
            f"no robot of `{task.grammar}` has so few modules",
            task.clauses.get("modules", task.span),
            hint=f"the smallest robots have {fewest} modules: write `modules <= {fewest}` or more; "
            "with this bound `synth` answers impossible",
        )


def _emitters(grammar: ir.Grammar) -> list[ir.Production]:
    """The productions whose semantics emit an effector."""
    blocks = grammar.semantics or {}
    return [
        production
        for production in grammar.productions
        if production.label in blocks
        and any(isinstance(e, ir.Effector) for e in blocks[production.label].emissions)
    ]


def _finite(grammar: ir.Grammar, words: int | None, longest: int, sink: Sink) -> None:
    if grammar.span.file:
        return  # an included file is a library, which its users do not change
    if words is None:
        number = "finitely many words"
    elif words < EXACT_BELOW:
        number = "1 word" if words == 1 else f"{words} words"
    else:
        # 2^10 is over 10^3; the number itself may have more digits than Python prints.
        number = f"over 10^{(words.bit_length() - 1) * 3 // 10} words"
    symbols = "1 symbol" if longest == 1 else f"{longest} symbols"
    sink.note(
        Code.FINITE_LANGUAGE,
        f"grammar `{grammar.name}` has {number}, of {symbols}{'' if words == 1 else ' at most'}",
        grammar.span,
        hint="`impossible` can be proved for all of them: a task then needs no `modules <= n`",
    )
