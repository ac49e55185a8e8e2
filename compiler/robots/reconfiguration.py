"""The steps that turn an existing robot into another one (Example 2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations, islice, pairwise
from typing import Any, TypeAlias

from compiler.robots.alignment import Alignment, alignment
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Rule, Srg
from compiler.words.language import Language, restrict
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Reconfiguration:
    """The sequence of words from an existing robot to another one, both included."""

    aligned: Alignment
    configurations: tuple[tuple[str, ...], ...]

    def describe(self) -> dict[str, Any]:
        """Plain data for ``design.json``; indices count from 0, in the old and the new word."""
        return {
            "from": list(self.configurations[0]),
            "added": len(self.aligned.added),
            "removed": len(self.aligned.removed),
            "kept": [list(pair) for pair in self.aligned.kept],
            "configurations": [list(word) for word in self.configurations],
        }


def reconfiguration(srg: Srg, old: tuple[str, ...], new: tuple[str, ...]) -> Reconfiguration:
    """How to reconfigure one robot into another.

    Args:
        srg: the grammar of both.
        old: the word of the existing robot.
        new: the word of the other robot.
    """
    aligned = alignment(old, new, srg.modules)
    return Reconfiguration(aligned, configurations(srg, old, new, aligned))


# --- The configurations between an existing robot and another one (Example 2) ---------------------
#
# A configuration is a word of the SRG, whatever the accept condition: a robot that productions
# build. Throughout, every kept module stays, each other module is removed once or added once, and
# each step changes as few modules at a time as the grammar allows: the largest step is as small as
# possible.


Word: TypeAlias = tuple[str, ...]
State: TypeAlias = tuple[int, ...]
"""The modules present, in order, by number: a module of the old word has its index there.

An added module has the length of the old word plus its index in the new one.
"""

MOST_TRIALS = 5_000
"""The number of configurations tried; beyond it, the remaining change is one step."""
MOST_WORDS = 100
"""The number of words with the same modules that are compared by their edges."""


def configurations(srg: Srg, old: Word, new: Word, aligned: Alignment) -> tuple[Word, ...]:
    """The configurations from one word of an SRG to another, both included.

    Of several steps of the same size, removals come before additions; the last module is removed
    first, and the first one is added first.

    Args:
        srg: the grammar.
        old: the word of the existing robot.
        new: the word of the other robot.
        aligned: which modules are kept.
    """
    if old == new:
        return (old,)
    way = _Way(srg, old, new, aligned)
    words = [old]
    states = way.states()
    for before, state in pairwise(states[:-1]):
        words.append(way.word(words[-1], before, state))
    return (*words, new)


@dataclass
class _Way:
    """The search for the states between two words."""

    srg: Srg
    old: Word
    new: Word
    aligned: Alignment
    trials: int = 0
    known: dict[Word, bool] = field(default_factory=dict[Word, bool])

    @cached_property
    def everything(self) -> Language:
        """L(SRG)."""
        return restrict(self.srg, accept_dfa(ir.AllOf(()), self.srg.terminals))

    @cached_property
    def assembled(self) -> Language:
        """The words of L(SRG) without their edges."""
        cfg = self.srg.cfg
        edges = {
            code for code, name in enumerate(self.srg.terminals) if name not in self.srg.modules
        }
        rules = tuple(
            Rule(rule.left, tuple(s for s in rule.right if s not in edges)) for rule in cfg.rules
        )
        bare = replace(self.srg, cfg=replace(cfg, rules=rules))
        return restrict(bare, self.everything.accept)

    @cached_property
    def places(self) -> dict[int, int]:
        """The index in the new word of every module that occurs in it."""
        added = {len(self.old) + j: j for j in self.aligned.added}
        return dict(self.aligned.kept) | added

    @property
    def first(self) -> State:
        return tuple(sorted([i for i, _ in self.aligned.kept] + [*self.aligned.removed]))

    @property
    def last(self) -> State:
        return tuple(sorted(self.places, key=self.places.__getitem__))

    def modules(self, state: State) -> Word:
        """The names of the modules of a state."""
        both = (*self.old, *self.new)
        return tuple(both[module] for module in state)

    def states(self) -> list[State]:
        """The states of a sequence whose largest step is as small as possible."""
        self.trials = 0
        for most in range(1, self.aligned.distance):
            found = self._within(most)
            if found is not None:
                return found
            if self.trials > MOST_TRIALS:
                break
        return [self.first, self.last]

    def _within(self, most: int) -> list[State] | None:
        """A sequence with no step of more than ``most`` modules, by depth-first search."""
        path = [self.first]
        choices = [self._steps(self.first, most)]
        met = {self.first}
        while choices:
            state = next((s for s in choices[-1] if s not in met), None)
            if state is None:
                path.pop()
                choices.pop()
                continue
            met.add(state)
            path.append(state)
            if state == self.last:
                return path
            choices.append(self._steps(state, most))
        return None

    def _steps(self, state: State, most: int) -> Iterator[State]:
        """The configurations reachable from a state in one step, smaller steps first."""
        present = set(state)
        removable = [i for i in reversed(self.aligned.removed) if i in present]
        missing = [len(self.old) + j for j in self.aligned.added]
        changes = [*removable, *(slot for slot in missing if slot not in present)]
        for size in range(1, most + 1):
            for chosen in combinations(changes, size):
                gone = {slot for slot in chosen if slot in present}
                rest = tuple(slot for slot in state if slot not in gone)
                come = [slot for slot in chosen if slot not in present]
                for target in self._with(rest, come):
                    if self.trials > MOST_TRIALS:
                        return
                    if self._is_configuration(target):
                        yield target

    def _with(self, state: State, come: Sequence[int]) -> list[State]:
        """A state with modules inserted; on either side of old modules that must be passed."""
        found = [state]
        for slot in come:
            found = [(*s[:at], slot, *s[at:]) for s in found for at in self._room(s, slot)]
        return found

    def _room(self, state: State, slot: int) -> range:
        place, places = self.places[slot], self.places
        before = [at for at, s in enumerate(state) if s in places and places[s] < place]
        after = [at for at, s in enumerate(state) if s in places and places[s] > place]
        return range(before[-1] + 1 if before else 0, (after[0] if after else len(state)) + 1)

    def _is_configuration(self, state: State) -> bool:
        if state == self.last:
            return True
        modules = self.modules(state)
        if modules not in self.known:
            self.trials += 1
            self.known[modules] = bool(modules) and self.assembled.accepts(modules)
        return self.known[modules]

    def word(self, before: Word, known: State, state: State) -> Word:
        """The word of a state with the fewest edges that differ from the configuration before."""
        pattern = _pattern(self.srg.terminals, self.srg.modules, self.modules(state))
        words = islice(restrict(self.srg, pattern).words(), MOST_WORDS)
        slots = set(known) | set(state)
        old = self._slotted(before, known)

        def edges(word: Word) -> int:
            return alignment(old, self._slotted(word, state), slots).edges

        return min(words, key=edges)

    def _slotted(self, word: Word, state: State) -> list[str | int]:
        """A word with each module replaced by its number."""
        numbers = iter(state)
        return [next(numbers) if symbol in self.srg.modules else symbol for symbol in word]


def _pattern(terminals: Word, modules: frozenset[str], word: Word) -> Dfa:
    """The words with these modules and any edges; state k: the first k modules were read."""
    dead = len(word) + 1
    table = [
        state if symbol not in modules or state == dead
        else state + 1 if state < len(word) and word[state] == symbol
        else dead
        for state in range(dead + 1)
        for symbol in terminals
    ]  # fmt: skip
    return Dfa(terminals, tuple(table), tuple(state == len(word) for state in range(dead + 1)))
