"""The structural reconfiguration automaton (SRA, Definition 4 as corrected): a pushdown automaton.

The paper's SRA has Q = (N + Z)*, an infinite set of states without a stack.  Here the states are
those of the accept condition's automaton and one final state.  The stack alphabet is N + Z and a
bottom marker.  A word is accepted in the final state after it has been read completely (Hopcroft,
Motwani, Ullman, section 6.3.1).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Srg

BOTTOM = "$"


@dataclass(frozen=True, slots=True)
class Transition:
    """In ``state``, reading ``read`` (None: nothing), replace the top ``pop`` by ``push``.

    Stack symbols are numbers; ``push[0]`` becomes the top.  ``label`` is the production applied.
    """

    state: int
    read: int | None
    pop: int
    push: tuple[int, ...]
    target: int
    label: str | None = None


@dataclass(frozen=True, slots=True)
class Pda:
    """A pushdown automaton over Z; it accepts in ``final`` when the word has been read.

    Stack symbols are indices into ``stack_alphabet``.  That of the SRA lists Z, then N, then the
    bottom marker, so numbers below ``len(alphabet)`` are the input symbols.  ``initial_stack`` has
    the top first.
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

    States q0 ... are those of ``accept``.  A production replaces its left side on the stack; a
    terminal on top is read while the accept automaton moves; and in an accepting state the bottom
    marker is popped, leading to the final state.

    Raises:
        ValueError: ``accept`` has another alphabet than the grammar.
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
    """The configurations of a run, starting with the initial one, lazily.

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
    """The run of the SRA that applies these productions of a leftmost derivation, in order.

    Raises:
        ValueError: there is no accepting run.
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


# --- Runs of a pushdown automaton: membership, and an accepting run -------------------------------
#
# The automaton runs on all its stacks at once.  Calls and returns are tabulated on a
# graph-structured stack (Tomita 1985; Scott and Johnstone 2010), position by position.  So left
# recursion and empty cycles terminate, and the time is polynomial.


def accepts(pda: Pda, word: Sequence[str]) -> bool:
    """Whether some run accepts the word; a word with a token that is not in Z is not accepted."""
    codes = _codes(pda, word)
    return codes is not None and _Simulation(pda, codes).run() is not None


def accepting_run(pda: Pda, word: Sequence[str]) -> tuple[Transition, ...] | None:
    """The transitions of an accepting run; None if there is none."""
    codes = _codes(pda, word)
    last = None if codes is None else _Simulation(pda, codes).run()
    if last is None:
        return None
    backwards: list[Transition] = []
    todo: list[_Pop | _Edge] = [last[1], last[0]]
    while todo:
        step = todo.pop()
        if isinstance(step, _Edge) and step.outer is not None:
            todo.append(step.outer)
        match step.cause:
            case Transition() as transition:
                backwards.append(transition)
            case (pop, edge):
                todo += [edge, pop]
            case None:
                pass
    return tuple(reversed(backwards))


def _codes(pda: Pda, word: Sequence[str]) -> tuple[int, ...] | None:
    number = {name: i for i, name in enumerate(pda.alphabet)}
    codes = tuple(number.get(token, -1) for token in word)
    return None if -1 in codes else codes


# --- Simulation -----------------------------------------------------------------------------------


@dataclass(slots=True, eq=False)
class _Node:
    """A symbol on top of the stack, in a state at a position, for all stacks with that top.

    ``edges`` are what lies below; they are complete once the position has passed.  ``pops`` are the
    pops at this position, for edges that are added later.
    """

    identity: int
    symbol: int
    state: int
    position: int
    edges: dict[tuple[tuple[int, ...], int], _Edge] = field(default_factory=dict)
    pops: list[_Pop] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class _Edge:
    """What lies below a node: the symbols ``rest``, then what lies below ``parent``.

    ``cause``: what put the node there.  ``outer``: the parent's own edge, if this edge replaces it.
    """

    rest: tuple[int, ...]
    parent: _Node | None
    cause: Cause
    outer: _Edge | None = None


@dataclass(slots=True, eq=False)
class _Pop:
    """The symbol of ``node``, with all that replaced it, was popped; the state is now ``state``."""

    node: _Node
    state: int
    cause: Cause


# A transition; or the pop of the symbol above, and the edge below that symbol.
Cause: TypeAlias = "Transition | tuple[_Pop, _Edge] | None"


class _Simulation:
    """All runs on one word at once; only the first cause of each node, edge and pop is recorded."""

    def __init__(self, pda: Pda, word: tuple[int, ...]) -> None:
        self.pda = pda
        self.word = word
        self.position = 0
        self.moves: dict[tuple[int, int], list[Transition]] = {}
        for transition in pda.transitions:
            self.moves.setdefault((transition.state, transition.pop), []).append(transition)
        self.created = 0
        self.nodes: dict[tuple[int, int], _Node] = {}
        self.popped: set[tuple[int, int]] = set()
        self.todo: list[_Node | tuple[_Pop, _Edge]] = []
        self.reading: list[tuple[_Node, Transition]] = []
        self.accepted: tuple[_Pop, _Edge] | None = None

    def run(self) -> tuple[_Pop, _Edge] | None:
        """The last pop of an accepting run with its edge; None if no run accepts."""
        self._push(self.pda.initial, self.pda.initial_stack, None, None)
        self._exhaust()
        while self.position < len(self.word):
            self.position += 1
            arrived, self.reading = self.reading, []
            self.nodes.clear()
            self.popped.clear()
            for node, transition in arrived:
                self._replace(node, transition)
            self._exhaust()
        return self.accepted

    def _exhaust(self) -> None:
        while self.todo:
            task = self.todo.pop()
            if isinstance(task, _Node):
                self._expand(task)
            else:
                self._return(*task)

    def _push(
        self, state: int, symbols: tuple[int, ...], parent: _Node | None, cause: Cause
    ) -> None:
        """Replace ``parent`` by ``symbols``, the first of them on top."""
        node = self.nodes.get((symbols[0], state))
        if node is None:
            self.created += 1
            node = _Node(self.created, symbols[0], state, self.position)
            self.nodes[symbols[0], state] = node
            self.todo.append(node)
        edge = _Edge(symbols[1:], parent, cause)
        # A last symbol takes over its parent's only edge: otherwise right recursion would leave a
        # chain of parents to be popped one by one at every position.
        if not edge.rest and parent is not None and parent.position < self.position:
            outer = next(iter(parent.edges.values())) if len(parent.edges) == 1 else None
            if outer is not None:
                edge = _Edge(outer.rest, outer.parent, cause, outer)
        key = (edge.rest, 0 if edge.parent is None else edge.parent.identity)
        if key not in node.edges:
            node.edges[key] = edge
            self.todo += [(pop, edge) for pop in node.pops]

    def _expand(self, node: _Node) -> None:
        """Apply all transitions of the node."""
        for transition in self.moves.get((node.state, node.symbol), ()):
            if transition.read is not None:
                if self.word[self.position : self.position + 1] == (transition.read,):
                    self.reading.append((node, transition))
            else:
                self._replace(node, transition)

    def _replace(self, node: _Node, transition: Transition) -> None:
        """Remove the node and push what the transition pushes."""
        if transition.push:
            self._push(transition.target, transition.push, node, transition)
        else:
            self._pop(node, transition.target, transition)

    def _pop(self, node: _Node, state: int, cause: Cause) -> None:
        """Pop the node at this position, once for each resulting state."""
        if (node.identity, state) in self.popped:
            return
        self.popped.add((node.identity, state))
        pop = _Pop(node, state, cause)
        if node.position == self.position:
            node.pops.append(pop)
        self.todo += [(pop, edge) for edge in node.edges.values()]

    def _return(self, pop: _Pop, edge: _Edge) -> None:
        """Continue with what lies below a popped node."""
        if edge.rest:
            self._push(pop.state, edge.rest, edge.parent, (pop, edge))
        elif edge.parent is not None:
            self._pop(edge.parent, pop.state, (pop, edge))
        elif pop.state == self.pda.final and self.position == len(self.word):
            self.accepted = self.accepted or (pop, edge)
