"""The structural reconfiguration automaton (SRA, Definition 4 as corrected): a pushdown automaton.

The paper's SRA has Q = (N + Z)*, an infinite state set without a stack.  Here the states are those
of the accept condition's automaton and one final state, the stack alphabet is N + Z and a bottom
marker, and the word is accepted in the final state with the whole word read (Hopcroft, Motwani,
Ullman, section 6.3.1).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Srg

BOTTOM = "$"


@dataclass(frozen=True, slots=True)
class Transition:
    """In ``state``, reading ``read`` (None: nothing), replace the top ``pop`` by ``push``.

    Stack symbols by number; ``push[0]`` becomes the top.  ``label`` is the production applied.
    """

    state: int
    read: int | None
    pop: int
    push: tuple[int, ...]
    target: int
    label: str | None = None


@dataclass(frozen=True, slots=True)
class Pda:
    """A pushdown automaton over Z; it accepts in ``final`` when the word is read.

    Stack symbols are numbers into ``stack_alphabet``; the SRA's lists Z, then N, then the bottom
    marker, so that below ``len(alphabet)`` they are the input symbols.  ``initial_stack`` has the
    top first.
    """

    alphabet: tuple[str, ...]
    stack_alphabet: tuple[str, ...]
    states: tuple[str, ...]
    transitions: tuple[Transition, ...]
    initial: int
    initial_stack: tuple[int, ...]
    final: int


@dataclass(frozen=True, slots=True)
class Configuration:
    """A configuration of a run; ``stack`` has the top first."""

    state: str
    remaining: tuple[str, ...]
    stack: tuple[str, ...]


def sra(srg: Srg, accept: Dfa) -> Pda:
    """The SRA of a grammar with its accept condition: L(SRA) = L(SRG) intersected with L(accept).

    States q0 ... are those of ``accept``; a production replaces its left side on the stack, a
    terminal on top is read while the accept automaton moves, and the bottom marker is popped to
    the final state from accepting states.
    """
    if accept.alphabet != srg.terminals:
        raise ValueError("the accept condition and the grammar have different alphabets")
    bottom = srg.cfg.terminals + srg.cfg.nonterminals
    marker = BOTTOM
    while marker in srg.terminals:
        marker += BOTTOM
    final = accept.size
    transitions: list[Transition] = []
    for state in range(accept.size):
        transitions += [
            Transition(state, None, rule.left, rule.right, state, production.label)
            for production, rule in zip(srg.productions, srg.cfg.rules, strict=True)
        ]
        transitions += [
            Transition(state, symbol, symbol, (), accept.step(state, symbol))
            for symbol in range(srg.cfg.terminals)
        ]
        if accept.accepting[state]:
            transitions.append(Transition(state, None, bottom, (), final))
    return Pda(
        srg.terminals,
        (*srg.terminals, *srg.nonterminals, marker),
        (*(f"q{state}" for state in range(accept.size)), "f"),
        tuple(transitions),
        0,
        (srg.cfg.start, bottom),
        final,
    )


def configurations(
    pda: Pda, word: Sequence[str], transitions: Sequence[Transition]
) -> Iterator[Configuration]:
    """The configurations of a run, the initial one first, lazily.

    Raises:
        ValueError: a transition does not apply.
    """
    state, remaining, stack = pda.initial, tuple(word), pda.initial_stack
    for transition in (*transitions, None):
        yield Configuration(
            pda.states[state], remaining, tuple(pda.stack_alphabet[s] for s in stack)
        )
        if transition is None:
            return
        reads = transition.read is not None
        if (
            transition.state != state
            or stack[:1] != (transition.pop,)
            or (reads and remaining[:1] != (pda.alphabet[transition.read or 0],))
        ):
            raise ValueError(f"{transition} does not apply in state {pda.states[state]}")
        state, stack = transition.target, transition.push + stack[1:]
        remaining = remaining[1:] if reads else remaining


def run_along(pda: Pda, labels: Sequence[str]) -> tuple[Transition, ...]:
    """The run of the SRA that applies these productions, those of a leftmost derivation, in order.

    Raises:
        ValueError: there is no accepting one.
    """
    moves: dict[tuple[int, int, str | None], Transition] = {}
    for transition in pda.transitions:
        moves[transition.state, transition.pop, transition.label] = transition
    replaced = {transition.pop for transition in pda.transitions if transition.label is not None}
    state, stack, rest = pda.initial, list(reversed(pda.initial_stack)), iter(labels)
    run: list[Transition] = []
    while stack:
        top = stack.pop()
        label = next(rest, None) if top in replaced else None
        step = moves.get((state, top, label))
        if step is None:
            raise ValueError("no run applies these productions")
        run.append(step)
        stack += reversed(step.push)
        state = step.target
    if state != pda.final or next(rest, None) is not None:
        raise ValueError("no run applies these productions")
    return tuple(run)
