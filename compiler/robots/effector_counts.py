"""Whether a robot of a family has at most one effector or may have several.

An upper bound over all derivations is the least fixpoint of a linear system (Knuth, *A
generalization of Dijkstra's algorithm*, 1977, with a largest instead of a smallest derivation, cut
off at two). If the bound allows several, the accept condition is taken into account: every
production writes one mark for each effector it emits, and a word with two marks is searched for in
the product with an automaton (:mod:`compiler.words.intersection`).
"""

from __future__ import annotations

from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import AutomatonTooLargeError, Dfa
from compiler.words.grammar import Cfg, Rule, srg
from compiler.words.intersection import (
    CHECKED_RULES,
    IntersectionTooLargeError,
    binary_normal_form,
    intersect,
)
from grammar_lang import ir

SEVERAL = 2
_MARK = ""  # no symbol of a grammar is empty


def several_effectors(program: ir.Program, grammar: ir.Grammar) -> bool | None:
    """Whether some accepted derivation emits two effectors or more.

    None if unknown: the grammar has no semantics, or its accept condition is too large.
    """
    if grammar.semantics is None:
        return None
    emitted = tuple(_emitted(grammar.semantics.get(p.label)) for p in grammar.productions)
    cfg = srg(grammar, program.terminals, program.modules).cfg
    return some_word_has_several(cfg, emitted, grammar.accept, program.terminals)


def some_word_has_several(
    cfg: Cfg, emitted: tuple[int, ...], accept: ir.Accept, terminals: tuple[str, ...]
) -> bool | None:
    """Whether some accepted derivation emits two effectors or more.

    None if the automaton of ``accept`` is too large.

    Args:
        cfg: the grammar.
        emitted: how many effectors each of its rules emits, at most ``SEVERAL``.
        accept: the accept condition.
        terminals: the names of the terminals.
    """
    if _most(cfg, emitted) < SEVERAL:
        return False
    try:
        accepted = accept_dfa(accept, terminals)
    except AutomatonTooLargeError:
        return None
    marked = binary_normal_form(_marked(cfg, emitted))
    try:
        return not intersect(marked, _with_marks(accepted), CHECKED_RULES).is_empty()
    except IntersectionTooLargeError:
        return None


def _emitted(block: ir.SemanticBlock | None) -> int:
    emissions = () if block is None else block.emissions
    return min(SEVERAL, sum(isinstance(emission, ir.Effector) for emission in emissions))


def _most(cfg: Cfg, emitted: tuple[int, ...]) -> int:
    """The most effectors of a derivation from the start symbol, at most ``SEVERAL``; linear."""
    first = cfg.terminals
    uses: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    missing = [0] * len(cfg.rules)
    total = list(emitted)
    for number, rule in enumerate(cfg.rules):
        for symbol in rule.right:
            if symbol >= first:
                uses[symbol - first].append(number)
                missing[number] += 1
    most = [-1] * cfg.nonterminals
    todo = [number for number, count in enumerate(missing) if count == 0]
    while todo:
        number = todo.pop()
        left = cfg.rules[number].left - first
        value = min(SEVERAL, total[number])
        before, most[left] = most[left], max(most[left], value)
        if most[left] == before:
            continue
        for user in uses[left]:
            total[user] += most[left] - max(before, 0)
            missing[user] -= before < 0
            if missing[user] == 0:
                todo.append(user)
    return most[cfg.start - first]


def _marked(cfg: Cfg, emitted: tuple[int, ...]) -> Cfg:
    """The grammar with one more terminal, the last, which stands for an emitted effector."""
    mark = cfg.terminals
    rules = tuple(
        Rule(left + 1, (mark,) * count + tuple(s if s < mark else s + 1 for s in right))
        for (left, right), count in zip(cfg.rules, emitted, strict=True)
    )
    return Cfg(mark + 1, cfg.nonterminals, rules, cfg.start + 1)


def _with_marks(accept: Dfa) -> Dfa:
    """The words with several marks that are non-empty and accepted once the marks are removed.

    State ``6 s + 2 m + e`` means: state s, m marks so far (2: or more), and whether a symbol came.
    """
    table: list[int] = []
    for state in range(accept.size):
        for marks in range(SEVERAL + 1):
            after = [
                6 * accept.step(state, symbol) + 2 * marks + 1
                for symbol in range(len(accept.alphabet))
            ]
            for seen in (0, 1):
                table += [*after, 6 * state + 2 * min(SEVERAL, marks + 1) + seen]
    accepting = tuple(
        good and marks == SEVERAL and seen == 1
        for good in accept.accepting
        for marks in range(SEVERAL + 1)
        for seen in (0, 1)
    )
    return Dfa((*accept.alphabet, _MARK), tuple(table), accepting)
