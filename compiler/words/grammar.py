"""The structural reconfiguration grammar (SRG, Definitions 2 and 3) as a context-free grammar.

The terminal alphabet is Z = Sigma + Gamma (modules and edges) in declaration order; the productions
are in declaration order too.  Every algorithm works on ``Cfg``, whose symbols are integers, so the
spelling of a name cannot matter.  The analyses are the textbook ones: Hopcroft, Motwani, Ullman,
*Introduction to Automata Theory*, chapters 5 and 7.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias, assert_never

from grammar_lang import ir

Linearity: TypeAlias = Literal["left", "right"]


class Rule(NamedTuple):
    """``left -> right`` over the symbols of a ``Cfg``."""

    left: int
    right: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Cfg:
    """A context-free grammar.

    Symbols below ``terminals`` are terminals; nonterminal number k is ``terminals + k``.
    """

    terminals: int
    nonterminals: int
    rules: tuple[Rule, ...]
    start: int


@dataclass(frozen=True, slots=True)
class Srg:
    """A structural reconfiguration grammar; rule n of ``cfg`` is its n-th production."""

    name: str
    terminals: tuple[str, ...]
    nonterminals: tuple[str, ...]
    productions: tuple[ir.Production, ...]
    start: str
    modules: frozenset[str]
    cfg: Cfg

    def encode(self, word: Sequence[str]) -> tuple[int, ...] | None:
        """The word as terminal numbers; None if a token is not a symbol of Z."""
        number = {name: i for i, name in enumerate(self.terminals)}
        codes = tuple(number.get(token, -1) for token in word)
        return None if -1 in codes else codes

    def decode(self, codes: Iterable[int]) -> tuple[str, ...]:
        """The names of terminal numbers."""
        return tuple(map(self.terminals.__getitem__, codes))

    def names(self, symbols: Container[int]) -> tuple[str, ...]:
        """The names of the nonterminals among ``symbols``, in the order of the grammar."""
        first = self.cfg.terminals
        return tuple(n for k, n in enumerate(self.nonterminals) if first + k in symbols)


def srg(grammar: ir.Grammar, program_terminals: tuple[str, ...], modules: Container[str]) -> Srg:
    """The SRG of a resolved grammar (Definition 3).

    Args:
        grammar: the grammar; its accept condition is not part of the SRG.
        program_terminals: the modules and edges of the program, in declaration order.
        modules: the terminals that are modules.

    Raises:
        ValueError: a production uses a symbol that is not declared.
    """
    terminals = {name: i for i, name in enumerate(program_terminals)}
    first = len(terminals)
    nonterminals = {name: first + k for k, name in enumerate(grammar.nonterminals)}

    def code(symbol: ir.Symbol) -> int:
        table = nonterminals if symbol.kind == "nonterminal" else terminals
        if symbol.name not in table:
            raise ValueError(f"grammar {grammar.name}: undeclared {symbol.kind} {symbol.name!r}")
        return table[symbol.name]

    for name in (grammar.start, *(p.left for p in grammar.productions)):
        if name not in nonterminals:
            raise ValueError(f"grammar {grammar.name}: undeclared nonterminal {name!r}")
    rules = tuple(
        Rule(nonterminals[p.left], tuple(code(s) for s in p.right)) for p in grammar.productions
    )
    return Srg(
        grammar.name,
        program_terminals,
        grammar.nonterminals,
        grammar.productions,
        grammar.start,
        frozenset(name for name in program_terminals if name in modules),
        Cfg(first, len(nonterminals), rules, nonterminals[grammar.start]),
    )


# --- Sets of symbols ---------------------------------------------------------------------------


def _deriving(cfg: Cfg, given: Iterable[int]) -> frozenset[int]:
    """``given`` and the nonterminals that derive a word over ``given``; linear time."""
    missing = [len(rule.right) for rule in cfg.rules]
    uses: dict[int, list[int]] = {}
    for r, rule in enumerate(cfg.rules):
        for symbol in rule.right:
            uses.setdefault(symbol, []).append(r)
    found: set[int] = set()
    todo = [*given, *(rule.left for rule in cfg.rules if not rule.right)]
    while todo:
        symbol = todo.pop()
        if symbol in found:
            continue
        found.add(symbol)
        for r in uses.get(symbol, ()):
            missing[r] -= 1
            if missing[r] == 0:
                todo.append(cfg.rules[r].left)
    return frozenset(found)


def nullable(cfg: Cfg) -> frozenset[int]:
    """The nonterminals that derive the empty word."""
    return _deriving(cfg, ())


def productive(cfg: Cfg) -> frozenset[int]:
    """The nonterminals that derive some word of terminals."""
    return frozenset(s for s in _deriving(cfg, range(cfg.terminals)) if s >= cfg.terminals)


def reachable(cfg: Cfg) -> frozenset[int]:
    """The nonterminals that occur in some sentential form; the start symbol always does."""
    found = {cfg.start}
    todo = [cfg.start]
    by_left = rules_by_left(cfg)
    while todo:
        for r in by_left[todo.pop() - cfg.terminals]:
            for symbol in cfg.rules[r].right:
                if symbol >= cfg.terminals and symbol not in found:
                    found.add(symbol)
                    todo.append(symbol)
    return frozenset(found)


def rules_by_left(cfg: Cfg) -> tuple[tuple[int, ...], ...]:
    """For each nonterminal, the numbers of its rules, in order."""
    table: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    for r, rule in enumerate(cfg.rules):
        table[rule.left - cfg.terminals].append(r)
    return tuple(map(tuple, table))


def useful_rules(cfg: Cfg) -> tuple[int, ...]:
    """The numbers of the rules that occur in the derivation of some word of terminals."""
    good = productive(cfg)
    kept = [
        r
        for r, rule in enumerate(cfg.rules)
        if all(s < cfg.terminals or s in good for s in (rule.left, *rule.right))
    ]
    pruned = Cfg(cfg.terminals, cfg.nonterminals, tuple(cfg.rules[r] for r in kept), cfg.start)
    seen = reachable(pruned)
    return tuple(r for r in kept if cfg.rules[r].left in seen)


def trimmed(cfg: Cfg) -> Cfg:
    """The same language with useful rules only; symbols keep their numbers."""
    rules = tuple(cfg.rules[r] for r in useful_rules(cfg))
    return Cfg(cfg.terminals, cfg.nonterminals, rules, cfg.start)


# --- Cycles ------------------------------------------------------------------------------------


def components(size: int, successors: Callable[[int], Sequence[int]]) -> tuple[int, ...]:
    """The strongly connected component of each node of a graph over ``range(size)``.

    Components are numbered in reverse topological order: a successor's number is never larger.
    Tarjan 1972, with an explicit stack.
    """
    order = [-1] * size
    low = [0] * size
    component = [-1] * size
    path: list[int] = []
    clock = count = 0
    for root in range(size):
        if order[root] >= 0:
            continue
        order[root] = low[root] = clock
        clock += 1
        path.append(root)
        calls = [(root, iter(successors(root)))]
        while calls:
            node, rest = calls[-1]
            child = next(rest, None)
            if child is None:
                calls.pop()
                if calls:
                    low[calls[-1][0]] = min(low[calls[-1][0]], low[node])
                if low[node] == order[node]:
                    count = _close(path, component, node, count)
            elif order[child] < 0:
                order[child] = low[child] = clock
                clock += 1
                path.append(child)
                calls.append((child, iter(successors(child))))
            elif component[child] < 0:
                low[node] = min(low[node], order[child])
    return tuple(component)


def _close(path: list[int], component: list[int], root: int, number: int) -> int:
    """Assign the nodes of ``path`` from ``root`` on to a component; return the next number."""
    while True:
        node = path.pop()
        component[node] = number
        if node == root:
            return number + 1


def on_cycle(size: int, edges: Iterable[tuple[int, int]]) -> frozenset[int]:
    """The nodes of a graph over ``range(size)`` that reach themselves by at least one edge."""
    adjacent: list[list[int]] = [[] for _ in range(size)]
    loops: set[int] = set()
    for tail, head in edges:
        adjacent[tail].append(head)
        if tail == head:
            loops.add(tail)
    component = components(size, adjacent.__getitem__)
    members = [0] * size
    for c in component:
        members[c] += 1
    return frozenset(n for n in range(size) if n in loops or members[component[n]] > 1)


def cyclic(cfg: Cfg) -> frozenset[int]:
    """The nonterminals A with a derivation A =>+ A (through unit and empty productions)."""
    empty = nullable(cfg)
    first = cfg.terminals
    edges: list[tuple[int, int]] = []
    for left, right in cfg.rules:
        solid = [symbol for symbol in right if symbol not in empty]
        if not solid:
            edges += [(left - first, symbol - first) for symbol in right]
        elif len(solid) == 1 and solid[0] >= first:
            edges.append((left - first, solid[0] - first))
    return frozenset(first + n for n in on_cycle(cfg.nonterminals, edges))


def is_finite(cfg: Cfg) -> bool:
    """Whether the language is finite: no useful A =>+ u A v where u v derives a non-empty word."""
    rules = trimmed(cfg).rules
    first = cfg.terminals
    adjacent: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    for left, right in rules:
        adjacent[left - first] += [s - first for s in right if s >= first]
    component = components(cfg.nonterminals, adjacent.__getitem__)
    solid = _non_empty(cfg.terminals, rules)
    for left, right in rules:
        for i, symbol in enumerate(right):
            same = symbol >= first and component[symbol - first] == component[left - first]
            if same and any(s in solid for k, s in enumerate(right) if k != i):
                return False
    return True


def _non_empty(terminals: int, rules: Iterable[Rule]) -> frozenset[int]:
    """The symbols that derive some non-empty word; all rules must be useful."""
    users: dict[int, list[int]] = {}
    for left, right in rules:
        for symbol in right:
            users.setdefault(symbol, []).append(left)
    found = set(range(terminals))
    todo = list(found)
    while todo:
        for left in users.get(todo.pop(), ()):
            if left not in found:
                found.add(left)
                todo.append(left)
    return frozenset(found)


def linearity(cfg: Cfg) -> Linearity | None:
    """Whether all rules are left-linear (``A -> B w | w``) or right-linear (``A -> w B | w``).

    If all rules are both, the answer is "left".
    """
    for side in ("left", "right"):
        inner: Callable[[tuple[int, ...]], tuple[int, ...]]
        inner = (lambda right: right[1:]) if side == "left" else (lambda right: right[:-1])
        if all(s < cfg.terminals for rule in cfg.rules for s in inner(rule.right)):
            return "left" if side == "left" else "right"
    return None


# --------------------------------------------------------------------------------------------------
# The symbols that a grammar uses, in its productions and its accept condition.
#
# Restricted to these symbols, the language is the same, and its automata are as small as the
# grammar, however many modules the file declares.


def alphabet_of(grammar: ir.Grammar, order: Mapping[str, int]) -> tuple[str, ...]:
    """The terminals of a grammar and of its accept condition, in declaration order.

    Args:
        grammar: a resolved grammar.
        order: the position of every declared terminal in the file.
    """
    used = {
        symbol.name
        for production in grammar.productions
        for symbol in production.right
        if symbol.kind != "nonterminal"
    }
    used.update(_accept_symbols(grammar.accept))
    return tuple(sorted(used, key=order.__getitem__))


def _accept_symbols(accept: ir.Accept) -> Iterator[str]:
    todo = [accept]
    while todo:
        node = todo.pop()
        match node:
            case ir.AllOf(parts) | ir.AnyOf(parts):
                todo += parts
            case ir.NotAccept(part):
                todo.append(part)
            case ir.Contains(word) | ir.StartsWith(word) | ir.EndsWith(word):
                yield from word
            case ir.Count(symbol):
                if symbol is not None:
                    yield symbol
            case ir.Matches(regex):
                yield from _regex_symbols(regex)
            case _:
                assert_never(node)


def _regex_symbols(regex: ir.Regex) -> Iterator[str]:
    todo = [regex]
    while todo:
        node = todo.pop()
        match node:
            case ir.RSymbol(name):
                yield name
            case ir.REmpty():
                pass
            case ir.RSequence(parts) | ir.RChoice(parts):
                todo += parts
            case ir.RRepeat(part):
                todo.append(part)
            case _:
                assert_never(node)
