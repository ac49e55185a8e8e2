"""Checks of tasks that need the language of the robot family."""

from __future__ import annotations

from collections.abc import Iterator

from compiler.robots.effector_counts import several_effectors
from compiler.tasks.formula_parts import subformulas
from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import srg
from compiler.words.language import Language, restrict
from compiler.words.word_reader import viable_prefix
from grammar_lang import ir
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink


def task_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report regions without the number of an effector, and robots that the family has not."""
    several: dict[str, bool | None] = {}
    for task in program.tasks.values():
        plain = list(_plain_atoms(task))
        if plain and task.grammar not in several:
            several[task.grammar] = several_effectors(program, program.grammars[task.grammar])
        if plain and several[task.grammar]:
            for atom in plain:
                sink.error(
                    Code.BAD_VALUE,
                    f"which effector is in `{atom.region}`? "
                    f"a robot of `{task.grammar}` may have several",
                    atom.span,
                    f"write `{atom.region} by effector 1`",
                )
        if task.origin is not None:
            _origin(program, task, task.origin, sink)


def _plain_atoms(task: ir.Task) -> Iterator[ir.Atom]:
    for clause in task.satisfy:
        for node in subformulas(clause.formula):
            if isinstance(node, ir.Atom) and not node.numbered:
                yield node


def _origin(program: ir.Program, task: ir.Task, origin: ir.Origin, sink: Sink) -> None:
    """The existing robot is one of the family, its accept condition aside."""
    rules = srg(program.grammars[task.grammar], program.terminals, program.modules)
    language = restrict(rules, accept_dfa(ir.AllOf(()), rules.terminals))
    if not language.accepts(origin.word):
        sink.error(
            Code.BAD_VALUE,
            f"the robot to start from is no word of grammar `{task.grammar}`",
            origin.span,
            _where_it_fails(language, origin.word),
        )


def _where_it_fails(language: Language, word: tuple[str, ...]) -> str:
    length = viable_prefix(language.normal, language.srg.terminals, word)
    if length < len(word):
        return f"no word of the grammar begins with `{' '.join(word[: length + 1])}`"
    return "the word is only the beginning of one: go on with more modules"
