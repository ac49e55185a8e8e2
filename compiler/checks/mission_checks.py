"""Whether the changes that a mission allows leave any robot of its grammar.

If the first task names the existing robot by ``from``, this is a question about words: the least
cost of turning one word into another. A chain of words costs at least as much as the direct way to
each word in it, so the task with the least bound on modules decides.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from fractions import Fraction
from heapq import heappop, heappush
from math import lcm

from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import AutomatonTooLargeError, Dfa
from compiler.words.grammar import alphabet_of, srg
from compiler.words.intersection import CHECKED_RULES, IntersectionTooLargeError
from compiler.words.language import restrict
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.ir.expression_text import number_text


def mission_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Warn of missions whose ``changes <= n`` is below the cost of every robot.

    A language that is too large to compute is skipped.
    """
    for mission in program.missions.values():
        tasks = [program.tasks[name] for name in mission.tasks]
        origin, prices, most = tasks[0].origin, mission.prices, mission.most
        if origin is None or prices is None or most is None:
            continue
        bounds = [task.modules for task in tasks if task.modules is not None]
        bound = min(bounds, default=None)
        least = _least(program, program.grammars[tasks[0].grammar], origin, prices, bound)
        if least is None or least <= most:
            continue
        which = f"every robot of `{tasks[0].grammar}`"
        if bound is not None:
            which += f" with at most {bound} modules"
        sink.warning(
            Code.CONTRADICTORY_MISSION,
            f"{which} costs more than {number_text(most)} to build from the existing robot",
            mission.clauses.get("changes", mission.span),
            f"write `changes <= {number_text(least)};` or more; no robot is within this bound",
            [(origin.span, "the existing robot")],
        )


def _least(
    program: ir.Program,
    grammar: ir.Grammar,
    origin: ir.Origin,
    prices: ir.Prices,
    modules: int | None,
) -> Fraction | None:
    """The least cost of any word of a grammar; None if it is unknown, or there is no word.

    It is also None if the existing robot is not a word of the grammar: that is reported elsewhere.
    """
    order = {name: i for i, name in enumerate(program.terminals)}
    rules = srg(grammar, alphabet_of(grammar, order), program.modules)
    try:
        whole = restrict(rules, accept_dfa(ir.AllOf(()), rules.terminals))
        words = restrict(rules, accept_dfa(grammar.accept, rules.terminals), CHECKED_RULES)
        if not whole.accepts(origin.word) or not words.product.starts:
            return None
        condition = words.condition(modules)
    except (AutomatonTooLargeError, IntersectionTooLargeError):
        return None
    return least_cost(condition, rules.modules, origin.word, prices)


def least_cost(
    words: Dfa, modules: Container[str], origin: Sequence[str], prices: ir.Prices
) -> Fraction | None:
    """The least cost of turning a word into an accepted one; None if no word is accepted.

    Shortest paths (Dijkstra 1959) through the states of the automaton and the positions in the word
    (Wagner 1974, *Order-n correction for regular languages*, with deletions and insertions only).
    Edges cost nothing.

    Args:
        words: the words that it may become.
        modules: which of the symbols are modules.
        origin: the existing word.
        prices: the prices of adding and of removing a module.
    """
    unit = lcm(prices.add.denominator, prices.remove.denominator)
    add, remove = int(prices.add * unit), int(prices.remove * unit)
    aim = [symbol for symbol in origin if symbol in modules]
    todo, done = [(0, 0, 0)], set[tuple[int, int]]()
    while todo:
        cost, state, place = heappop(todo)
        if (state, place) in done:
            continue
        done.add((state, place))
        following = aim[place] if place < len(aim) else None
        if following is None and words.accepting[state]:
            return Fraction(cost, unit)
        if following is not None:
            heappush(todo, (cost + remove, state, place + 1))
        for number, symbol in enumerate(words.alphabet):
            after = words.step(state, number)
            heappush(todo, (cost + add * (symbol in modules), after, place))
            if symbol == following:
                heappush(todo, (cost, after, place + 1))
    return None
