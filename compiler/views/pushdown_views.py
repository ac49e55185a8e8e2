"""The SRA and the FRA as pictures: states, and what each move reads, pops, pushes and updates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import cast

from compiler.robots.attributes import SemanticsError
from compiler.views.workspace_view import Arrow, Edge, Node, Picture, run_of
from compiler.words.functional_automaton import Fra, fra
from compiler.words.language import language
from compiler.words.pushdown_automaton import Pda, Transition
from grammar_lang import ir

# --- The SRA as a picture: states, and what each move reads, pops and pushes (Definition 4) -------
#
# The empty word is written with the Greek letter, because ``eps`` is an ordinary edge symbol
# (Gamma).


EMPTY = "ε"
ARROW = "→"


LABEL_WIDTH = 30
"""The most characters of a line of a label, if it can be broken."""


def sra_view(pda: Pda, highlight: Sequence[str] | None = None) -> Picture:
    """A pushdown automaton; each line of an edge says ``read, top of stack → what replaces it``.

    Moves between the same states share an edge, on which the productions of a nonterminal are one
    line. The moves of an accepting run of ``highlight`` have an edge of their own, whose data give
    their ``steps`` in the run, counted from 0. States without a path to the final one are left out,
    as no word is accepted from them; the caption names them.

    Raises:
        HighlightError: the automaton does not accept ``highlight``.
    """
    run = () if highlight is None else run_of(pda, highlight)
    steps: dict[Transition, list[int]] = {}
    for step, transition in enumerate(run):
        steps.setdefault(transition, []).append(step)
    visited = {transition.target for transition in run} | ({pda.initial} if run else set())
    moves: dict[tuple[int, int, bool], list[Transition]] = {}
    live = _live(pda)
    for transition in pda.transitions:
        if not {transition.state, transition.target} <= live:
            continue
        key = (transition.state, transition.target, transition not in steps)
        moves.setdefault(key, []).append(transition)
    nodes = tuple(
        Node(
            f"s{state}",
            name,
            double=state == pda.final,
            highlighted=state in visited,
            data={"state": state},
        )
        for state, name in enumerate(pda.states)
        if state in live or state == pda.initial
    )
    edges = tuple(
        Edge(
            f"s{tail}",
            f"s{head}",
            grouped_lines(pda, shared),
            highlighted=not plain,
            data={
                "moves": tuple(shared),
                "steps": tuple(tuple(steps.get(transition, ())) for transition in shared),
            },
        )
        for (tail, head, plain), shared in sorted(moves.items(), key=lambda item: item[0])
    )
    start = Arrow(f"s{pda.initial}", stack_text(pda, pda.initial_stack), highlighted=bool(run))
    sinks = [name for state, name in enumerate(pda.states) if state not in live]
    caption = (f"left out: {', '.join(sinks)}; no word is accepted from there",) if sinks else ()
    return Picture("sra", "circle", nodes, edges, (start,), caption=caption)


def _live(pda: Pda) -> set[int]:
    """The states from which transitions lead to the final one, whatever is on the stack."""
    before: dict[int, set[int]] = {}
    for transition in pda.transitions:
        before.setdefault(transition.target, set()).add(transition.state)
    live, fresh = {pda.final}, [pda.final]
    while fresh:
        new = before.get(fresh.pop(), set()) - live
        live |= new
        fresh += new
    return live


def grouped_lines(pda: Pda, moves: Sequence[Transition]) -> tuple[str, ...]:
    """The lines of a label: productions by the nonterminal that they replace, then symbols read.

    Reading a symbol takes it off the stack; several such moves are one line, too.
    """
    sides: dict[int, list[str]] = {}
    for move in moves:
        if move.label is not None:
            sides.setdefault(move.pop, []).append(stack_text(pda, move.push))
    lines = list[str]()
    for left, rights in sides.items():
        first = f"{EMPTY}, {symbol_text(pda.stack_alphabet[left])} {ARROW} "
        lines += wrapped(first, rights, " | ")
    read = [move for move in moves if _takes(move)]
    if len(read) > 1:
        names = [symbol_text(pda.alphabet[move.pop]) for move in read]
        any_ = "x"
        while any_ in pda.stack_alphabet:
            any_ += "'"
        lines += wrapped(f"{any_}, {any_} {ARROW} {EMPTY} for {any_} = ", names, ", ")
    other = [move for move in moves if move.label is None and (len(read) < 2 or not _takes(move))]
    return (*lines, *(move_text(pda, move) for move in other))


def _takes(move: Transition) -> bool:
    """Whether a move reads the symbol that is on the stack, and takes it off."""
    return move.label is None and move.read == move.pop and not move.push


def wrapped(first: str, parts: Sequence[str], between: str) -> list[str]:
    """Parts in a row after the first text, broken between them if a line would be too long."""
    lines = [first + parts[0]]
    for part in parts[1:]:
        if len(lines[-1]) + len(between) + len(part) <= LABEL_WIDTH:
            lines[-1] += between + part
        else:
            lines[-1] += between.rstrip()
            lines.append(f"    {part}")
    return lines


def move_text(pda: Pda, transition: Transition) -> str:
    """The symbol that a move reads, the top of the stack, and its replacement."""
    read = EMPTY if transition.read is None else symbol_text(pda.alphabet[transition.read])
    top = symbol_text(pda.stack_alphabet[transition.pop])
    return f"{read}, {top} {ARROW} {stack_text(pda, transition.push)}"


def symbol_text(name: str) -> str:
    """A symbol's name, quoted if it could be taken for a sign of the notation."""
    return f"'{name}'" if name in (EMPTY, ARROW, ",", "|") or " " in name else name


def stack_text(pda: Pda, symbols: Iterable[int]) -> str:
    """Symbols of the stack, the top first."""
    return " ".join(symbol_text(pda.stack_alphabet[s]) for s in symbols) or EMPTY


# --- The FRA as a picture: the SRA with the semantic updates of each production on its moves ------


UPDATE = "↳ "


def functional_view(
    program: ir.Program, grammar: ir.Grammar, highlight: Sequence[str] | None = None
) -> Picture:
    """The picture of the SRA, whose edges name the productions; the caption has their updates.

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
    applied = {
        move.label: move
        for edge in edges
        for move in cast("tuple[Transition, ...]", edge.data["moves"])
        if move.label is not None
    }
    said = [
        line
        for production in grammar.productions
        if production.label in applied
        for line in production_lines(automaton, applied[production.label])
    ]
    return replace(picture, name="fra", edges=edges, caption=(*said, *picture.caption))


def _with_updates(edge: Edge, automaton: Fra) -> Edge:
    moves = cast("tuple[Transition, ...]", edge.data["moves"])
    labels = [move.label for move in moves if move.label is not None]
    rest = [move for move in moves if move.label is None]
    lines = wrapped("apply ", labels, ", ") if labels else []
    updates = tuple(automaton.updates(transition) for transition in moves)
    return replace(
        edge,
        lines=(*lines, *grouped_lines(automaton.pda, rest)),
        data={**edge.data, "updates": updates},
    )


def production_lines(automaton: Fra, transition: Transition) -> tuple[str, ...]:
    """The production that a move applies, and its updates, one line each."""
    label = transition.label or ""
    updates = (f"{UPDATE}{update}" for update in automaton.updates(transition))
    return (f"{label}: {_applied(automaton, label)}", *updates)


def _applied(automaton: Fra, label: str) -> str:
    """The move that applies a production, with the names that its updates use: ``left:Arm``."""
    production = automaton.productions[label]
    right = [s.name if s.alias is None else f"{s.alias}:{s.name}" for s in production.right]
    return f"{EMPTY}, {production.left} {ARROW} {' '.join(right) or EMPTY}"
