"""Whether the first objective of a task leaves finitely many robots of each value."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

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

    Nothing is said of tasks with ``modules <= n``, of objectives that are not made of what each
    module adds, and of languages that are too large to be looked at.
    """
    order = {name: i for i, name in enumerate(program.terminals)}
    for task in program.tasks.values():
        if not task.minimize or task.modules is not None:
            continue
        grammar = program.grammars[task.grammar]
        alphabet = alphabet_of(grammar, order)
        weights = _least_weights(program, task.minimize[0], alphabet)
        if weights is None:
            continue
        rules = srg(grammar, alphabet, program.modules)
        try:
            language = restrict(rules, accept_dfa(grammar.accept, alphabet), CHECKED_RULES)
        except (AutomatonTooLargeError, IntersectionTooLargeError):
            continue
        free = free_terminals(language.product, weights)
        if free:
            _report(program, task, [alphabet[number] for number in sorted(free)], sink)


def _least_weights(
    program: ir.Program, objective: ir.Objective, alphabet: Sequence[str]
) -> list[Fraction] | None:
    """The least that each symbol adds to an objective; None where it is no such sum."""
    match objective.kind:
        case "modules":
            return [Fraction(name in program.modules) for name in alphabet]
        case "sum":
            amounts = dict(objective.amounts)
            return [
                Fraction(0)
                if name not in amounts
                else amounts[name] or _least(program.modules[name], objective.attribute)
                for name in alphabet
            ]
        case "mass" | "time" | "energy" | "effort":
            return None


def _least(module: ir.Module, name: str | None) -> Fraction:
    """The least value of a parameter, rounded where it is irrational; zero where it is none."""
    for parameter in module.parameters:
        if parameter.name == name:
            domain = parameter.domain
            values = (domain.lower,) if isinstance(domain, ir.Interval) else domain.values
            return min(map(_value, values))
    return Fraction(0)


def _value(expr: ir.Expr) -> Fraction:
    found = constants.rational(expr)
    return Fraction(constants.to_float(expr)) if found is None else found


def _report(program: ir.Program, task: ir.Task, free: Sequence[str], sink: Sink) -> None:
    objective = task.minimize[0]
    name = objective.attribute
    what = "number of modules" if name is None else f"sum of `{name}`"
    modules = [f"`{each}`" for each in free if program.is_module(each)]
    hint = "let every cycle of the grammar have a module: edges alone add nothing"
    if modules:
        more = ", …" if len(modules) > _SHOWN else ""
        which = ", ".join(modules[:_SHOWN]) + more
        hint = f"write `modules <= n;`, or give `{name}` of {which} a value above zero"
    sink.error(
        Code.ENDLESS_OBJECTIVE,
        f"infinitely many words of grammar `{task.grammar}` have the same {what}",
        objective.span,
        hint,
    )
