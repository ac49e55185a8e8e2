"""Whether it is clear whose the bodies of a family are, where a task asks for a module's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.source import Span


def check_ownership(task: ir.Task, grammars: Mapping[str, ir.Grammar], sink: Sink) -> None:
    """Report ``robust mass p % of M`` where bodies may be those of M, or none is.

    Args:
        task: the task.
        grammars: those of the file, by name.
        sink: where errors go.
    """
    grammar = grammars.get(task.grammar)
    if grammar is None or not grammar.semantics or task.robust is None:
        return
    for clause in task.robust.masses:
        bodies = list(_bodies_of(grammar, clause.module))
        mixed = next((each for each in bodies if len(each[1]) > 1), None)
        if mixed is not None:
            at, names = mixed
            message = f"it is not clear whose body this is, that of {' or '.join(names)}"
            hint = "emit it in a production of one module, or name one module in its quantities"
            notes = [(clause.span, "the task asks for it here")]
            sink.error(Code.MIXED_OWNERS, message, at, hint, notes)
        elif not bodies:
            message = f"no body of a robot of `{grammar.name}` is that of module `{clause.module}`"
            hint = "name a module that has a body"
            sink.error(Code.BAD_VALUE, message, clause.span, hint)


def _bodies_of(grammar: ir.Grammar, module: str) -> Iterator[tuple[Span, tuple[str, ...]]]:
    """The bodies that may be those of a module: where they stand, and whose they may be."""
    for production in grammar.productions:
        block = (grammar.semantics or {}).get(production.label)
        for emission in () if block is None else block.emissions:
            if isinstance(emission, ir.Effector):
                continue
            names = [production.right[i].name for i in ir.owners(production, emission)]
            if module in names:
                yield emission.span, tuple(f"`{name}`" for name in names)
