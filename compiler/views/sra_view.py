"""The SRA as a picture: states, and what each move reads, pops and pushes (Definition 4).

The empty word is written with the Greek letter, because ``eps`` is an ordinary edge symbol (Gamma).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from compiler.automata.pushdown_automaton import Pda, Transition
from compiler.views.highlighted_run import run_of
from compiler.views.picture import Arrow, Edge, Node, Picture

EMPTY = "ε"
ARROW = "→"


def sra_view(pda: Pda, highlight: Sequence[str] | None = None) -> Picture:
    """A pushdown automaton; a line of an edge says ``read, top of stack → what replaces it``.

    Moves between the same states share an edge; those of an accepting run of ``highlight`` have
    an edge of their own, whose data gives their ``steps`` in the run, counted from 0.

    Raises:
        HighlightError: the automaton does not accept ``highlight``.
    """
    run = () if highlight is None else run_of(pda, highlight)
    steps: dict[Transition, list[int]] = {}
    for step, transition in enumerate(run):
        steps.setdefault(transition, []).append(step)
    visited = {transition.target for transition in run} | ({pda.initial} if run else set())
    moves: dict[tuple[int, int, bool], list[Transition]] = {}
    for transition in pda.transitions:
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
    )
    edges = tuple(
        Edge(
            f"s{tail}",
            f"s{head}",
            tuple(move_text(pda, transition) for transition in shared),
            highlighted=not plain,
            data={
                "moves": tuple(shared),
                "steps": tuple(tuple(steps.get(transition, ())) for transition in shared),
            },
        )
        for (tail, head, plain), shared in sorted(moves.items(), key=lambda item: item[0])
    )
    start = Arrow(f"s{pda.initial}", stack_text(pda, pda.initial_stack), highlighted=bool(run))
    return Picture("sra", "circle", nodes, edges, (start,))


def move_text(pda: Pda, transition: Transition) -> str:
    """What a move reads, the top of the stack, and what replaces it."""
    read = EMPTY if transition.read is None else symbol_text(pda.alphabet[transition.read])
    top = symbol_text(pda.stack_alphabet[transition.pop])
    return f"{read}, {top} {ARROW} {stack_text(pda, transition.push)}"


def symbol_text(name: str) -> str:
    """A symbol's name, in quotes where it could be taken for a sign of the notation."""
    return f"'{name}'" if name in (EMPTY, ARROW, ",") or " " in name else name


def stack_text(pda: Pda, symbols: Iterable[int]) -> str:
    """Symbols of the stack, the top first."""
    return " ".join(symbol_text(pda.stack_alphabet[s]) for s in symbols) or EMPTY
