"""Findings about ambiguous words: several derivations, of one robot or of different ones."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING, Literal, TypeAlias

from compiler.words.ambiguity import Ambiguity
from compiler.words.derivation import Derivation
from compiler.words.language import Language
from compiler.words.structures import derivations_of
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink

if TYPE_CHECKING:
    from compiler.robots.robot import RobotModel

SYMBOL_LIMIT = 600
DERIVATIONS_PER_WORD = 4
SHOWN_SYMBOLS = 24

Pair: TypeAlias = tuple[Derivation, Derivation]


def ambiguity_diagnostics(
    program: ir.Program,
    grammar: ir.Grammar,
    language: Language,
    found: Ambiguity,
    tasks: Sequence[ir.Task],
    sink: Sink,
) -> None:
    """Report that a grammar is ambiguous, or that a word of it stands for different robots.

    For every ambiguous word found, the robots of the first ``DERIVATIONS_PER_WORD`` derivations are
    compared, until robots with ``SYMBOL_LIMIT`` symbols in total have been built.

    Args:
        program: the program of the grammar.
        grammar: the grammar, not cyclic.
        language: its language.
        found: its ambiguous words.
        tasks: the tasks of the program that use the grammar.
        sink: where to report.
    """
    if not found.words:
        return
    different = _different_robots(program, grammar, language, found, tasks)
    if different is not None:
        code, said = Code.DIFFERENT_ROBOTS, "stands for different robots"
        advice = "make their semantics agree, or keep one of the two ways"
        pair = different
    else:
        first, second = islice(derivations_of(language, found.words[0]), 2)
        code, said = Code.AMBIGUOUS_GRAMMAR, "has several derivations"
        advice, pair = "each derivation counts as a structure of its own", (first, second)
    _report(grammar, code, pair, said, advice, sink)


def _report(
    grammar: ir.Grammar, code: Code, pair: Pair, said: str, advice: str, sink: Sink
) -> None:
    one, other = pair
    step = next(
        i for i, ab in enumerate(zip(one.labels, other.labels, strict=False)) if ab[0] != ab[1]
    )
    sink.warning(
        code,
        f"grammar `{grammar.name}` is ambiguous: {_shown(one.word)} {said}",
        other.nodes[step].production.span,
        hint=f"they differ at step {step + 1}: `{one.labels[step]}` or `{other.labels[step]}`; "
        f"{advice}",
        notes=((one.nodes[step].production.span, "the other derivation continues with this"),),
    )


def _shown(word: tuple[str, ...]) -> str:
    if len(word) <= SHOWN_SYMBOLS:
        return f"`{' '.join(word)}`"
    return f"`{' '.join(word[:SHOWN_SYMBOLS])} …` ({len(word)} symbols)"


def _different_robots(
    program: ir.Program,
    grammar: ir.Grammar,
    language: Language,
    found: Ambiguity,
    tasks: Sequence[ir.Task],
) -> Pair | None:
    """Two derivations of one word that give different robots; None if none were found.

    They are compared in the plane or in space, as the tasks require; without tasks, in the first of
    these that gives a robot.
    """
    if grammar.semantics is None or any(
        production.label not in grammar.semantics for production in grammar.productions
    ):
        return None
    used = {
        program.workspaces[task.workspace].dimension
        for task in tasks
        if task.workspace in program.workspaces
    }
    both: tuple[Literal[2, 3], ...] = (2, 3)
    dimensions = tuple(d for d in both if not used or d in used)
    symbols = 0
    for word in found.words:
        if symbols > SYMBOL_LIMIT:
            break
        derivations = tuple(islice(derivations_of(language, word), DERIVATIONS_PER_WORD))
        symbols += len(word) * len(derivations)
        for dimension in dimensions:
            robots = _robots(program, grammar, dimension, derivations)
            pair = _different(robots)
            if pair is not None:
                return pair
            if robots and not used:
                break
    return None


def _robots(
    program: ir.Program,
    grammar: ir.Grammar,
    dimension: Literal[2, 3],
    derivations: Sequence[Derivation],
) -> list[tuple[Derivation, RobotModel]]:
    """The robots of those derivations for which the semantics define one."""
    # Few grammars are ambiguous, so the robot part of the compiler is loaded only for them.
    from compiler.robots.attributes import SemanticsError
    from compiler.robots.normal_form import RobotFamily

    family = RobotFamily(program, grammar, dimension)
    found: list[tuple[Derivation, RobotModel]] = []
    for derivation in derivations:
        try:
            found.append((derivation, family.robot(derivation)))
        except SemanticsError:
            continue
    return found


def _different(robots: Sequence[tuple[Derivation, RobotModel]]) -> Pair | None:
    """The first derivation, and the first one whose robot differs from its robot."""
    from compiler.robots.robot_key import robot_key

    for derivation, robot in robots[1:]:
        if robot_key(robot) == robot_key(robots[0][1]):
            continue
        from compiler.robots.robot_key import provably_different

        if provably_different(robots[0][1], robot):
            return robots[0][0], derivation
    return None
