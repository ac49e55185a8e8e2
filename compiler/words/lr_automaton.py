"""The canonical LR(1) automaton of a grammar, and recognition with it.

Knuth 1965; Aho, Lam, Sethi, Ullman, *Compilers*, section 4.7.  Lookahead sets are integers used as
bit sets.  The closure of a nonterminal after a dot is computed once per nonterminal, with one bit
for the inherited lookahead, so the closure of a state needs no fixpoint.  Conflicts are never
resolved: a table exists exactly if the trimmed grammar is LR(1).
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from compiler.words.grammar import Cfg, Rule, components, nullable, trimmed

STEP_LIMIT = 2_000_000


@dataclass(frozen=True, slots=True)
class LrAutomaton:
    """A conflict-free LR(1) automaton; the initial state is 0.

    ``rules`` are those of the trimmed grammar (rule r is number ``useful_rules(cfg)[r]`` of the
    given grammar).  ``end``, the end marker, is the number after the last terminal.  For each
    state, ``actions`` maps a terminal or ``end`` to the state to shift to, to ``~r`` for a
    reduction by rule r, or to ``accept_action``; ``gotos`` maps a nonterminal to the next state.
    """

    rules: tuple[Rule, ...]
    end: int
    actions: tuple[dict[int, int], ...]
    gotos: tuple[dict[int, int], ...]

    @property
    def accept_action(self) -> int:
        """The action on ``end`` that accepts: the reduction by the added start rule."""
        return ~len(self.rules)


@dataclass(frozen=True, slots=True)
class LrItem:
    """Rule number ``rule`` with the dot before its symbol number ``dot``.

    Rule ``len(rules)`` is the added ``S' -> start``.
    """

    rule: int
    dot: int
    lookahead: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class LrConflict:
    """The reason why a grammar is not LR(1): after ``prefix``, several actions fit ``lookahead``.

    ``prefix`` is a shortest viable prefix with a conflict; ``lookahead`` is a terminal, or the
    number after the last terminal for the end.  The actions are a shift, if ``shift`` is true, and
    the reductions by the rules numbered ``reductions``, where ``len(rules)`` stands for accepting.
    """

    rules: tuple[Rule, ...]
    prefix: tuple[int, ...]
    lookahead: int
    shift: bool
    reductions: tuple[int, ...]
    items: tuple[LrItem, ...]


@dataclass(frozen=True, slots=True)
class LrTooLarge:
    """The construction stopped after ``steps`` steps; the grammar may or may not be LR(1)."""

    steps: int


# Item numbers with their lookahead sets, in increasing order.
_Kernel: TypeAlias = tuple[tuple[int, int], ...]


def lr_automaton(cfg: Cfg, step_limit: int = STEP_LIMIT) -> LrAutomaton | LrConflict | LrTooLarge:
    """The LR(1) automaton, or the first conflict, or ``LrTooLarge`` after ``step_limit`` steps.

    A step is an item or a table entry; the number of steps, unlike the time, does not depend on the
    machine.
    """
    grammar = trimmed(cfg)
    if not grammar.rules:
        return LrAutomaton((), cfg.terminals, ({},), ({},))
    return _Construction(grammar, step_limit).run()


class _Construction:
    """Builds the states in breadth-first order, so that the first conflict has a shortest prefix.

    An item is a number; the next number is the same item with the dot moved by one symbol.
    """

    def __init__(self, cfg: Cfg, step_limit: int) -> None:
        self.cfg = cfg
        self.steps = 0
        self.step_limit = step_limit
        self.inherit = 1 << (cfg.terminals + 1)
        self.empty = nullable(cfg)
        self.first = _first_sets(cfg, self.empty)
        self.places: list[tuple[int, int]] = []
        # For each item, the symbol after the dot, or ~rule at the end.
        self.next: list[int] = []
        # For each item, the terminals that can follow the symbol after the dot.
        self.follow: list[int] = []
        # For each nonterminal, the items of its rules with the dot after the first symbol.
        self.openings: list[list[tuple[int, int]]] = [[] for _ in range(cfg.nonterminals)]
        self.empties: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
        self.corners: list[list[tuple[int, int]]] = [[] for _ in range(cfg.nonterminals)]
        self.opened: dict[int, tuple[tuple[int, int], ...]] = {}
        for r, rule in enumerate(cfg.rules):
            self._add_rule(r, rule)
        start = self._add_items(len(cfg.rules), (cfg.start,))
        self.kernels: list[_Kernel] = [((start, 1 << cfg.terminals),)]
        self.number = {self.kernels[0]: 0}
        self.parents: list[tuple[int, int]] = [(-1, -1)]
        self.actions: list[dict[int, int]] = []
        self.gotos: list[dict[int, int]] = []

    def _add_rule(self, r: int, rule: Rule) -> None:
        item = self._add_items(r, rule.right)
        left = rule.left - self.cfg.terminals
        if not rule.right:
            self.empties[left].append(r)
            return
        self.openings[left].append((rule.right[0], item + 1))
        if rule.right[0] >= self.cfg.terminals:
            self.corners[left].append((rule.right[0], self.follow[item]))

    def _add_items(self, r: int, right: tuple[int, ...]) -> int:
        """Number the items of a rule; return the number of the item with the dot at the start."""
        item = len(self.next)
        self.places += [(r, dot) for dot in range(len(right) + 1)]
        self.next += [*right, ~r]
        behind = [0]
        following = self.inherit
        for symbol in reversed(right):
            behind.append(following)
            if symbol < self.cfg.terminals:
                following = 1 << symbol
            elif symbol in self.empty:
                following |= self.first[symbol - self.cfg.terminals]
            else:
                following = self.first[symbol - self.cfg.terminals]
        self.follow += reversed(behind)
        return item

    def _given(self, follow: int, ahead: int) -> int:
        """``follow`` with the bit for the inherited lookahead replaced by ``ahead``."""
        return (follow ^ self.inherit) | ahead if follow & self.inherit else follow

    def run(self) -> LrAutomaton | LrConflict | LrTooLarge:
        """Expand all states."""
        for state, kernel in enumerate(self.kernels):
            conflict = self._expand(state, kernel)
            if self.steps > self.step_limit:
                return LrTooLarge(self.step_limit)
            if conflict is not None:
                return conflict
        return LrAutomaton(
            self.cfg.rules, self.cfg.terminals, tuple(self.actions), tuple(self.gotos)
        )

    def _expand(self, state: int, kernel: _Kernel) -> LrConflict | None:
        closure = self._closure(kernel)
        moves, reductions = self._moves(kernel, closure)
        symbols = sorted(moves)
        doubled, taken = 0, sum(1 << s for s in symbols if s < self.cfg.terminals)
        for ahead in reductions.values():
            doubled |= taken & ahead
            taken |= ahead
        if doubled:
            return self._conflict(state, _bits(doubled)[0], moves, reductions, closure)
        actions: dict[int, int] = {}
        gotos: dict[int, int] = {}
        for symbol in symbols:
            table = actions if symbol < self.cfg.terminals else gotos
            table[symbol] = self._target(state, symbol, moves[symbol])
        for r in sorted(reductions):
            actions.update(dict.fromkeys(_bits(reductions[r]), ~r))
        self.steps += len(actions) + len(gotos)
        self.actions.append(actions)
        self.gotos.append(gotos)
        return None

    def _moves(
        self, kernel: _Kernel, closure: dict[int, int]
    ) -> tuple[dict[int, list[tuple[int, int]]], dict[int, int]]:
        """For each symbol, the items after it; for each complete rule, its lookaheads."""
        moves: dict[int, list[tuple[int, int]]] = {}
        reductions: dict[int, int] = {}
        for item, ahead in kernel:
            symbol = self.next[item]
            if symbol < 0:
                reductions[~symbol] = ahead
            else:
                moves.setdefault(symbol, []).append((item + 1, ahead))
        self.steps += len(kernel)
        for symbol, ahead in closure.items():
            openings = self.openings[symbol - self.cfg.terminals]
            empties = self.empties[symbol - self.cfg.terminals]
            self.steps += 1 + len(openings) + len(empties)
            for corner, item in openings:
                moves.setdefault(corner, []).append((item, ahead))
            for r in empties:
                reductions[r] = ahead
        return moves, reductions

    def _closure(self, kernel: _Kernel) -> dict[int, int]:
        """The nonterminals that may begin after a dot, with the lookaheads of their rules."""
        found: dict[int, int] = {}
        for item, ahead in kernel:
            if self.next[item] < self.cfg.terminals:
                continue
            given = self._given(self.follow[item], ahead)
            for symbol, follow in self._opened(self.next[item]):
                found[symbol] = found.get(symbol, 0) | self._given(follow, given)
        return found

    def _opened(self, symbol: int) -> tuple[tuple[int, int], ...]:
        """The closure of a nonterminal, whose own lookahead is the bit for the inherited one."""
        if symbol not in self.opened:
            found = {symbol: self.inherit}
            todo = [symbol]
            while todo and self.steps <= self.step_limit:
                above = todo.pop()
                for corner, follow in self.corners[above - self.cfg.terminals]:
                    self.steps += 1
                    known = found.get(corner, 0)
                    ahead = known | self._given(follow, found[above])
                    if ahead != known:
                        found[corner] = ahead
                        todo.append(corner)
            self.opened[symbol] = tuple(found.items())
        return self.opened[symbol]

    def _target(self, state: int, symbol: int, moved: list[tuple[int, int]]) -> int:
        """The state of a kernel; added if it is new."""
        kernel = tuple(sorted(moved))
        if kernel not in self.number:
            self.number[kernel] = len(self.kernels)
            self.kernels.append(kernel)
            self.parents.append((state, symbol))
        return self.number[kernel]

    def _conflict(
        self,
        state: int,
        lookahead: int,
        moves: Container[int],
        reductions: dict[int, int],
        closure: dict[int, int],
    ) -> LrConflict:
        opened = [
            (r, 0, closure[rule.left])
            for r, rule in enumerate(self.cfg.rules)
            if rule.left in closure
        ]
        items = [(*self.places[item], ahead) for item, ahead in self.kernels[state]] + opened
        prefix: list[int] = []
        while state:
            state, symbol = self.parents[state]
            prefix.append(symbol)
        return LrConflict(
            self.cfg.rules,
            tuple(reversed(prefix)),
            lookahead,
            lookahead < self.cfg.terminals and lookahead in moves,
            tuple(r for r in sorted(reductions) if reductions[r] >> lookahead & 1),
            tuple(LrItem(r, dot, _bits(ahead)) for r, dot, ahead in items),
        )


def _bits(mask: int) -> tuple[int, ...]:
    """The elements of a set of bits in increasing order."""
    found: list[int] = []
    while mask:
        lowest = mask & -mask
        found.append(lowest.bit_length() - 1)
        mask ^= lowest
    return tuple(found)


def _first_sets(cfg: Cfg, empty: Container[int]) -> list[int]:
    """FIRST of each nonterminal as bit sets, in one pass over the components of left corners."""
    own = [0] * cfg.nonterminals
    corners: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    for left, right in cfg.rules:
        for symbol in right:
            if symbol < cfg.terminals:
                own[left - cfg.terminals] |= 1 << symbol
            else:
                corners[left - cfg.terminals].append(symbol - cfg.terminals)
            if symbol not in empty:
                break
    component = components(cfg.nonterminals, corners.__getitem__)
    shared = [0] * cfg.nonterminals
    for n in sorted(range(cfg.nonterminals), key=component.__getitem__):
        for corner in corners[n]:
            own[n] |= shared[component[corner]]
        shared[component[n]] |= own[n]
    return [shared[c] for c in component]


# --- Recognition -------------------------------------------------------------------------------


def accepts(automaton: LrAutomaton, word: Sequence[int]) -> bool:
    """Whether the word of terminal numbers is in the language; linear time."""
    return right_parse(automaton, word) is not None


def right_parse(automaton: LrAutomaton, word: Sequence[int]) -> tuple[int, ...] | None:
    """The rule numbers of the rightmost derivation in reverse; None if there is no derivation."""
    actions, gotos = automaton.actions, automaton.gotos
    accept = automaton.accept_action
    applied: list[int] = []
    stack = [0]
    for symbol in (*word, automaton.end):
        action = actions[stack[-1]].get(symbol)
        while action is not None and accept < action < 0:
            left, right = automaton.rules[~action]
            del stack[len(stack) - len(right) :]
            stack.append(gotos[stack[-1]][left])
            applied.append(~action)
            action = actions[stack[-1]].get(symbol)
        if action is None:
            return None
        if action == accept:
            break
        stack.append(action)
    # If the word itself contained the number of the end marker, it would be accepted too early.
    return None if automaton.end in word else tuple(applied)


# --- The leftmost derivation of an LR parse ----------------------------------------------------


def leftmost_derivation(automaton: LrAutomaton, word: Sequence[int]) -> tuple[int, ...] | None:
    """The rule numbers of the word's leftmost derivation; None if there is no derivation.

    A right parse lists the derivation tree in postorder, the leftmost derivation in preorder.
    """
    parse = right_parse(automaton, word)
    if parse is None:
        return None
    inner = [sum(s >= automaton.end for s in rule.right) for rule in automaton.rules]
    children: list[tuple[int, ...]] = []
    roots: list[int] = []
    for node, r in enumerate(parse):
        cut = len(roots) - inner[r]
        children.append(tuple(roots[cut:]))
        roots[cut:] = [node]
    derivation: list[int] = []
    while roots:
        node = roots.pop()
        derivation.append(parse[node])
        roots += reversed(children[node])
    return tuple(derivation)
