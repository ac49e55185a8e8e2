"""The deterministic pushdown automaton of an LR(1) grammar with its accept condition.

Knuth 1965: a language is deterministic if and only if it has an LR(1) grammar.  The stack holds the
states of the LR automaton.  The finite control holds the state of the accept automaton, the
lookahead symbol and, while a right side is popped, how much of it is left.

The automaton looks one symbol ahead to choose a reduction, and after the last symbol there is
nothing to look at.  Accepting with an empty stack and without an end marker, it could not accept
both a word and a proper prefix of it.  So its input is the word and an end marker, which is not a
terminal.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Srg, useful_rules
from compiler.words.lr_automaton import LrAutomaton, LrTooLarge
from compiler.words.pushdown_automaton import Pda, Transition

END = "#"
TRANSITION_LIMIT = 500_000
NOTHING = -1


def deterministic_pushdown(
    srg: Srg, automaton: LrAutomaton, accept: Dfa, limit: int = TRANSITION_LIMIT
) -> Pda | LrTooLarge:
    """The deterministic automaton of L(SRG) intersected with L(accept), for words with end markers.

    ``alphabet`` is Z and the end marker; ``stack_alphabet`` are the states of ``automaton``, the
    LR(1) automaton of ``srg.cfg``.  Parts that no run can use are left out: controls that the LR
    automaton does not lead to, and symbols after which the accept condition cannot hold.  The
    construction gives up after ``limit`` transitions.

    Raises:
        ValueError: ``accept`` has another alphabet, or ``automaton`` belongs to another grammar.
    """
    if accept.alphabet != srg.terminals:
        raise ValueError("the accept condition and the grammar have different alphabets")
    if automaton.end != srg.cfg.terminals:
        raise ValueError("the LR automaton is not of this grammar")
    found = _Exploration(srg, automaton, accept)
    if not found.run(limit):
        return LrTooLarge(limit)
    return Pda(
        found.alphabet,
        tuple(map(str, range(len(automaton.actions)))),
        tuple(map(found.name, found.number)),
        tuple(found.transitions),
        0,
        (0,),
        found.number[FINAL],
    )


def is_deterministic(pda: Pda) -> bool:
    """Whether no two transitions apply to one configuration.

    A transition applies by the state, the top of the stack and the next symbol; one that reads
    nothing applies whatever comes next.
    """
    reads: dict[tuple[int, int], set[int | None]] = {}
    for transition in pda.transitions:
        known = reads.setdefault((transition.state, transition.pop), set())
        if transition.read in known or None in known or (transition.read is None and known):
            return False
        known.add(transition.read)
    return True


@dataclass(frozen=True, slots=True)
class _Control:
    """A state of the finite control.

    ``state``: the state of the accept automaton after reading ``ahead``; ``ahead``: the lookahead
    symbol; ``left``: the nonterminal to push once ``pops`` more symbols have been popped.
    """

    state: int
    ahead: int = NOTHING
    left: int = NOTHING
    pops: int = 0


CLOSING = _Control(NOTHING)
FINAL = _Control(NOTHING, pops=NOTHING)


class _Exploration:
    """Finds the transitions, by controls together with the tops of stack they may meet."""

    def __init__(self, srg: Srg, automaton: LrAutomaton, accept: Dfa) -> None:
        self.automaton = automaton
        self.accept = accept
        self.live = accept.live()
        marker = END
        while marker in srg.terminals:
            marker += END
        self.alphabet = (*srg.terminals, marker)
        self.nonterminals = srg.nonterminals
        self.labels = tuple(srg.productions[r].label for r in useful_rules(srg.cfg))
        self.below: list[list[int]] = [[] for _ in automaton.actions]
        for state, tables in enumerate(zip(automaton.actions, automaton.gotos, strict=True)):
            for target in (target for table in tables for target in table.values()):
                if target >= 0:
                    self.below[target].append(state)
        start = _Control(0)
        self.number: dict[_Control, int] = {start: 0, FINAL: 1}
        self.transitions: list[Transition] = []
        self.todo = [(start, 0)]
        self.seen = set(self.todo)

    def run(self, limit: int) -> bool:
        """Find all transitions; False if there are more than ``limit``."""
        for control, top in self.todo:
            if control == CLOSING:
                self._add(control, None, top, (), FINAL)
            elif control.left != NOTHING:
                self._replace(control, top)
            elif control.ahead != NOTHING:
                self._act(control, None, top, control)
            else:
                for symbol in self.automaton.actions[top]:
                    for seeing in self._seeing(control, symbol):
                        self._act(control, symbol, top, seeing)
            if len(self.transitions) > limit:
                return False
        return True

    def _seeing(self, control: _Control, symbol: int) -> Iterator[_Control]:
        """The control that has read ``symbol``, if the word can then still be accepted."""
        if symbol == self.automaton.end:
            if self.accept.accepting[control.state]:
                yield _Control(NOTHING, symbol)
        elif self.live[self.accept.step(control.state, symbol)]:
            yield _Control(self.accept.step(control.state, symbol), symbol)

    def _act(self, control: _Control, read: int | None, top: int, seeing: _Control) -> None:
        """Add the LR automaton's action on the lookahead symbol."""
        action = self.automaton.actions[top].get(seeing.ahead)
        if action is None:
            return
        if action == self.automaton.accept_action:
            self._add(control, read, top, (), CLOSING)
        elif action >= 0:
            self._add(control, read, top, (action, top), _Control(seeing.state))
        else:
            left, right = self.automaton.rules[~action]
            label = self.labels[~action]
            if right:
                popping = _Control(seeing.state, seeing.ahead, left, len(right) - 1)
                self._add(control, read, top, (), popping, label)
            else:
                target = self.automaton.gotos[top][left]
                self._add(control, read, top, (target, top), seeing, label)

    def _replace(self, control: _Control, top: int) -> None:
        """Continue to pop a right side; when it is gone, push the goto state of its left side."""
        if control.pops:
            less = _Control(control.state, control.ahead, control.left, control.pops - 1)
            self._add(control, None, top, (), less)
        elif control.left in self.automaton.gotos[top]:
            target = self.automaton.gotos[top][control.left]
            self._add(control, None, top, (target, top), _Control(control.state, control.ahead))

    def _add(
        self,
        control: _Control,
        read: int | None,
        top: int,
        push: tuple[int, ...],
        target: _Control,
        label: str | None = None,
    ) -> None:
        number = self.number.setdefault(target, len(self.number))
        self.transitions.append(Transition(self.number[control], read, top, push, number, label))
        if target == FINAL:
            return
        for exposed in push[:1] or self.below[top]:
            if (target, exposed) not in self.seen:
                self.seen.add((target, exposed))
                self.todo.append((target, exposed))

    def name(self, control: _Control) -> str:
        """A name that identifies a control."""
        if control == FINAL:
            return "f"
        if control == CLOSING:
            return "closing"
        parts = [] if control.state == NOTHING else [f"q{control.state}"]
        if control.ahead != NOTHING:
            parts.append(f"sees {self.alphabet[control.ahead]}")
        if control.left != NOTHING:
            left = self.nonterminals[control.left - self.automaton.end]
            parts.append(f"pops {control.pops} for {left}" if control.pops else f"pushes {left}")
        return ", ".join(parts)
