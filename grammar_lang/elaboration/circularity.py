"""Circular attribute definitions: the test for absolute noncircularity.

Sources: D. E. Knuth, "Semantics of Context-Free Languages: Correction", *Mathematical Systems
Theory* 5 (1971); K. Kennedy and S. K. Warren, POPL 1976.  For each nonterminal, one relation holds
every dependence of a synthesized attribute on an inherited one that some derivation may induce.  A
production is rejected if its own dependences form a cycle with them.  The test is polynomial, and
conservative: a grammar is also rejected if no derivation combines those dependences.  Cycles are
found by repeatedly removing nodes that depend on nothing (A. B. Kahn, 1962).

If a grammar is rejected, a cycle that occurs in a derivation is shown if there is one.  That is
Knuth's own test, which keeps the relations of single derivations apart.  Their number may be
exponential, so the test gives up after a number of steps.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.ir.expressions import children

Node: TypeAlias = ir.AttributeOf
Graph: TypeAlias = dict[Node, list[Node]]
Pairs: TypeAlias = dict[tuple[str, str], None]
Induced: TypeAlias = dict[str, Pairs]

COMBINATIONS = 1_000
"""The most combinations of derivations tried to find a cycle that occurs in one of them."""


def reads(expr: ir.Expr) -> Iterator[Node]:
    """The attributes that an expression reads."""
    stack = [expr]
    while stack:
        node = stack.pop()
        if isinstance(node, ir.AttributeOf):
            yield node
        stack.extend(reversed(children(node)))


def _own(block: ir.SemanticBlock) -> Graph:
    """The graph of a block, with edges from what is read to what is defined."""
    graph: Graph = {}
    for rule in block.rules:
        for read in reads(rule.value):
            graph.setdefault(read, []).append(rule.target)
    return graph


def _with_pairs(own: Graph, pairs: Iterable[tuple[int, Iterable[tuple[str, str]]]]) -> Graph:
    """The graph extended by the named dependences that the children at some positions add."""
    graph = {node: list(after) for node, after in own.items()}
    for position, added in pairs:
        for before, after in added:
            node = ir.AttributeOf(position, before)
            graph.setdefault(node, []).append(ir.AttributeOf(position, after))
    return graph


def _with_induced(own: Graph, production: ir.Production, induced: Induced) -> Graph:
    inner = ((i, induced.get(symbol.name, {})) for i, symbol in enumerate(production.right))
    return _with_pairs(own, inner)


def _reachable(graph: Graph, source: Node) -> dict[Node, Node]:
    """Every node reached from ``source`` by some edge, nearest first, with its predecessor."""
    found: dict[Node, Node] = {}
    waiting = deque([source])
    while waiting:
        node = waiting.popleft()
        for after in graph.get(node, ()):
            if after not in found:
                found[after] = node
                waiting.append(after)
    return found


def _through(graph: Graph, block: ir.SemanticBlock) -> Iterator[tuple[str, str]]:
    """The pairs of attributes of the left side: an inherited one, and one that depends on it."""
    for source in _inherited(graph, block):
        for target in _reachable(graph, source):
            if target.occurrence == ir.THIS:
                yield source.name, target.name


def _inherited(graph: Graph, block: ir.SemanticBlock) -> list[Node]:
    """The attributes of the left side that a production reads but does not define."""
    defined = {rule.target for rule in block.rules}
    return [node for node in graph if node.occurrence == ir.THIS and node not in defined]


def _on_cycle(graph: Graph) -> Node | None:
    """A node that depends on itself, the first one of its cycle; None if there is none."""
    before: dict[Node, set[Node]] = {}
    for node, targets in graph.items():
        for after in targets:
            before.setdefault(after, set()).add(node)
    free = [node for node in graph if node not in before]
    while free:
        done = free.pop()
        for after in dict.fromkeys(graph.get(done, ())):
            before[after].discard(done)
            if not before[after]:
                del before[after]
                free.append(after)
    # Every remaining node has a remaining predecessor, so the way back runs into a cycle.
    order = {node: number for number, node in enumerate(graph) if node in before}
    if not order:
        return None
    here = next(iter(order))
    passed: dict[Node, None] = {}
    while here not in passed:
        passed[here] = None
        here = min(before[here], key=order.__getitem__)
    way = list(passed)
    return min(way[way.index(here) :], key=order.__getitem__)


class _Waiting:
    """A queue of productions; those that use a nonterminal can be queued again."""

    def __init__(self, productions: Sequence[ir.Production]) -> None:
        self._productions = productions
        self._users: dict[str, list[int]] = {}
        self._queue = deque(range(len(productions)))
        self._queued = set(self._queue)
        for number, production in enumerate(productions):
            for name in dict.fromkeys(symbol.name for symbol in production.right):
                self._users.setdefault(name, []).append(number)

    def __iter__(self) -> Iterator[ir.Production]:
        while self._queue:
            number = self._queue.popleft()
            self._queued.discard(number)
            yield self._productions[number]

    def again(self, nonterminal: str) -> None:
        for number in self._users.get(nonterminal, ()):
            if number not in self._queued:
                self._queued.add(number)
                self._queue.append(number)


def _induce(
    productions: Sequence[ir.Production],
    own: Mapping[str, Graph],
    blocks: Mapping[str, ir.SemanticBlock],
) -> Induced:
    induced: Induced = {p.left: {} for p in productions}
    waiting = _Waiting(productions)
    for production in waiting:
        graph = _with_induced(own[production.label], production, induced)
        relation = induced[production.left]
        before = len(relation)
        relation |= dict.fromkeys(_through(graph, blocks[production.label]))
        if len(relation) > before:
            waiting.again(production.left)
    return induced


def _occurring(
    productions: Sequence[ir.Production],
    own: Mapping[str, Graph],
    blocks: Mapping[str, ir.SemanticBlock],
) -> Iterator[tuple[ir.Production, Graph]]:
    """The attribute dependences of each production, in single derivations.

    Either all of them, or those of the first ``COMBINATIONS`` combinations.
    """
    relations: dict[str, dict[frozenset[tuple[str, str]], Pairs]] = {}
    tried: set[tuple[str, tuple[frozenset[tuple[str, str]], ...]]] = set()
    waiting = _Waiting(productions)
    for production in waiting:
        inner = [i for i, s in enumerate(production.right) if s.kind == "nonterminal"]
        below = (tuple(relations.get(production.right[i].name, {}).items()) for i in inner)
        for chosen in product(*below):
            key = (production.label, tuple(relation for relation, _ in chosen))
            if key in tried:
                continue
            if len(tried) == COMBINATIONS:
                return
            tried.add(key)
            pairs = zip(inner, (found for _, found in chosen), strict=True)
            graph = _with_pairs(own[production.label], pairs)
            yield production, graph
            through = dict.fromkeys(_through(graph, blocks[production.label]))
            found = relations.setdefault(production.left, {})
            if frozenset(through) not in found:
                found[frozenset(through)] = through
                waiting.again(production.left)


def _around(graph: Graph, node: Node) -> tuple[Node, ...]:
    """A shortest cycle through a node that depends on itself."""
    before = _reachable(graph, node)
    path = [node]
    while before[path[-1]] != node:
        path.append(before[path[-1]])
    return tuple(reversed(path))


def induced(
    productions: Sequence[ir.Production], blocks: Mapping[str, ir.SemanticBlock]
) -> Induced:
    """For each nonterminal, the pairs (inherited, synthesized) that some derivation may connect.

    The second depends on the first, directly or not.  Productions without a block are ignored.
    """
    own = {label: _own(block) for label, block in blocks.items()}
    return _induce([p for p in productions if p.label in own], own, blocks)


def cycle(
    productions: Sequence[ir.Production], blocks: Mapping[str, ir.SemanticBlock]
) -> tuple[ir.Production, tuple[Node, ...]] | None:
    """A production with a cycle of dependences, and the cycle; None if there is none.

    Each attribute of the cycle depends on the previous one, and the first on the last.  Cycles
    within one block are preferred, then cycles that occur in a derivation, then cycles whose
    dependences only occur in different derivations.
    """
    own = {label: _own(block) for label, block in blocks.items()}
    known = [p for p in productions if p.label in own]
    relation = _induce(known, own, blocks)
    graphs = [(p, _with_induced(own[p.label], p, relation)) for p in known]
    if all(_on_cycle(graph) is None for _, graph in graphs):
        return None
    alone = [(p, own[p.label]) for p in known]
    for candidates in (alone, _occurring(known, own, blocks), graphs):
        for production, graph in candidates:
            node = _on_cycle(graph)
            if node is not None:
                return production, _around(graph, node)
    return None
