"""Whether the first objective of a task or mission leaves finitely many robots for each value."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from compiler.objectives.word_weights import weights_of_modules
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import AutomatonTooLargeError
from compiler.words.free_cycles import free_terminals
from compiler.words.grammar import alphabet_of, srg
from compiler.words.intersection import CHECKED_RULES, IntersectionTooLargeError
from compiler.words.language import restrict
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.ir import constants

_SHOWN = 6


def objective_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report the tasks whose first objective has the same value for infinitely many words.

    Missions with one robot are treated in the same way. Not checked are tasks with
    ``modules <= n``, missions that have such a task, objectives that are not sums over modules, and
    languages that are too large to compute.
    """
    for task in program.tasks.values():
        if task.minimize and task.modules is None:
            _check(program, program.grammars[task.grammar], task.minimize[0], "", sink)
    for mission in program.missions.values():
        tasks = [program.tasks[name] for name in mission.tasks]
        if mission.minimize and all(task.modules is None for task in tasks):
            grammar = program.grammars[tasks[0].grammar]
            _check(program, grammar, mission.minimize[0], " in a task", sink)


def _check(
    program: ir.Program, grammar: ir.Grammar, objective: ir.Objective, where: str, sink: Sink
) -> None:
    order = {name: i for i, name in enumerate(program.terminals)}
    alphabet = alphabet_of(grammar, order)
    weights = weights_of_modules(program, objective, _least)
    if weights is None:
        return
    rules = srg(grammar, alphabet, program.modules)
    try:
        language = restrict(rules, accept_dfa(grammar.accept, alphabet), CHECKED_RULES)
    except (AutomatonTooLargeError, IntersectionTooLargeError):
        return
    free = free_terminals(language.product, [weights.get(name, Fraction(0)) for name in alphabet])
    if free:
        named = [alphabet[number] for number in sorted(free)]
        _report(program, grammar.name, objective, named, where, sink)


def _least(domain: ir.Interval | ir.Choices) -> Fraction:
    """The least value of a parameter, rounded if it is irrational."""
    values = (domain.lower,) if isinstance(domain, ir.Interval) else domain.values
    return min(map(_value, values))


def _value(expr: ir.Expr) -> Fraction:
    found = constants.rational(expr)
    return Fraction(constants.to_float(expr)) if found is None else found


def _report(
    program: ir.Program,
    grammar: str,
    objective: ir.Objective,
    free: Sequence[str],
    where: str,
    sink: Sink,
) -> None:
    name = objective.attribute
    what = "number of modules" if name is None else f"sum of `{name}`"
    modules = [f"`{each}`" for each in free if program.is_module(each)]
    hint = "let every cycle of the grammar have a module: edges alone add nothing"
    if modules:
        more = ", …" if len(modules) > _SHOWN else ""
        which = ", ".join(modules[:_SHOWN]) + more
        hint = f"write `modules <= n;`{where}, or give `{name}` of {which} a value above zero"
    sink.error(
        Code.ENDLESS_OBJECTIVE,
        f"infinitely many words of grammar `{grammar}` have the same {what}",
        objective.span,
        hint,
    )
