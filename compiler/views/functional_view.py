"""The FRA as a picture: the SRA with the semantic updates of each production on its moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from compiler.automata.functional_automaton import Fra, fra
from compiler.automata.pushdown_automaton import Transition
from compiler.languages.language import language
from compiler.semantics.attributes import SemanticsError
from compiler.views.picture import Edge, Picture
from compiler.views.sra_view import ARROW, EMPTY, move_text, sra_view
from grammar_lang import ir

UPDATE = "↳ "


def functional_view(
    program: ir.Program, grammar: ir.Grammar, highlight: Sequence[str] | None = None
) -> Picture:
    """The SRA's picture; below a move that applies a production stand its updates.

    Raises:
        HighlightError: the automaton does not accept ``highlight``.
        SemanticsError: the grammar has no semantics.
    """
    if grammar.semantics is None:
        raise SemanticsError(f"grammar `{grammar.name}` has no semantics")
    family = language(grammar, program.terminals, program.modules)
    automaton = fra(family.srg, family.accept, grammar.semantics, program.sources)
    picture = sra_view(automaton.pda, highlight)
    edges = tuple(_with_updates(edge, automaton) for edge in picture.edges)
    return replace(picture, name="fra", edges=edges)


def _with_updates(edge: Edge, automaton: Fra) -> Edge:
    moves = cast("tuple[Transition, ...]", edge.data["moves"])
    lines = tuple(line for transition in moves for line in move_lines(automaton, transition))
    updates = tuple(automaton.updates(transition) for transition in moves)
    return replace(edge, lines=lines, data={**edge.data, "updates": updates})


def move_lines(automaton: Fra, transition: Transition) -> tuple[str, ...]:
    """A move with the production that it applies, and the updates of that, a line each."""
    if transition.label is None:
        return (move_text(automaton.pda, transition),)
    updates = (f"{UPDATE}{update}" for update in automaton.updates(transition))
    return (f"{transition.label}: {_applied(automaton, transition.label)}", *updates)


def _applied(automaton: Fra, label: str) -> str:
    """The move that applies a production, with the names that its updates use: ``left:Arm``."""
    production = automaton.productions[label]
    right = [s.name if s.alias is None else f"{s.alias}:{s.name}" for s in production.right]
    return f"{EMPTY}, {production.left} {ARROW} {' '.join(right) or EMPTY}"
