"""Circular attribute definitions: the test for absolute noncircularity.

Source: D. E. Knuth, "Semantics of Context-Free Languages: Correction", *Mathematical Systems
Theory* 5 (1971); K. Kennedy and S. K. Warren, POPL 1976.  For each nonterminal one relation holds
every dependence of a synthesized attribute on an inherited one that some derivation may induce;
a production whose own dependences close a cycle with them is refused.  Polynomial, and on the safe
side: a grammar whose derivations never combine those dependences is refused as well.  Cycles are
found by leaving out, again and again, what depends on nothing (A. B. Kahn, 1962).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.extent import children

Node: TypeAlias = ir.AttributeOf
Graph: TypeAlias = dict[Node, list[Node]]
Induced: TypeAlias = dict[str, dict[tuple[str, str], None]]


def reads(expr: ir.Expr) -> Iterator[Node]:
    """The attributes that an expression reads."""
    stack = [expr]
    while stack:
        node = stack.pop()
        if isinstance(node, ir.AttributeOf):
            yield node
        stack.extend(reversed(children(node)))


def _own(block: ir.SemanticBlock) -> Graph:
    """Edges from what is read to what is defined."""
    graph: Graph = {}
    for rule in block.rules:
        for read in reads(rule.value):
            graph.setdefault(read, []).append(rule.target)
    return graph


def _with_induced(own: Graph, production: ir.Production, induced: Induced) -> Graph:
    graph = {node: list(after) for node, after in own.items()}
    for position, symbol in enumerate(production.right):
        for before, after in induced.get(symbol.name, {}):
            node = ir.AttributeOf(position, before)
            graph.setdefault(node, []).append(ir.AttributeOf(position, after))
    return graph


def _reachable(graph: Graph, source: Node) -> dict[Node, Node]:
    """Every node reached from ``source`` by at least one edge, with its predecessor."""
    found: dict[Node, Node] = {}
    stack = [source]
    while stack:
        node = stack.pop()
        for after in graph.get(node, ()):
            if after not in found:
                found[after] = node
                stack.append(after)
    return found


def _inherited(graph: Graph, block: ir.SemanticBlock) -> list[Node]:
    """What a production reads of its left side and does not define itself."""
    defined = {rule.target for rule in block.rules}
    return [node for node in graph if node.occurrence == ir.THIS and node not in defined]


def _on_cycle(graph: Graph) -> Node | None:
    """A node that depends on itself, of one cycle the first."""
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
    # Whatever is left has a predecessor that is left, so that the way back runs into a cycle.
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


def _induce(
    productions: Sequence[ir.Production],
    own: Mapping[str, Graph],
    blocks: Mapping[str, ir.SemanticBlock],
) -> Induced:
    induced: Induced = {p.left: {} for p in productions}
    changed = True
    while changed:
        changed = False
        for production in productions:
            graph = _with_induced(own[production.label], production, induced)
            relation = induced[production.left]
            for source in _inherited(graph, blocks[production.label]):
                for target in _reachable(graph, source):
                    pair = (source.name, target.name)
                    if target.occurrence == ir.THIS and pair not in relation:
                        relation[pair] = None
                        changed = True
    return induced


def cycle(
    productions: Sequence[ir.Production], blocks: Mapping[str, ir.SemanticBlock]
) -> tuple[ir.Production, tuple[Node, ...]] | None:
    """The first production with a cycle of dependences, and the cycle; None if there is none.

    Each attribute of the cycle depends on the one before it, the first on the last.
    """
    own = {label: _own(block) for label, block in blocks.items()}
    known = [p for p in productions if p.label in own]
    induced = _induce(known, own, blocks)
    for production in known:
        graph = _with_induced(own[production.label], production, induced)
        node = _on_cycle(graph)
        if node is not None:
            before = _reachable(graph, node)
            path = [node]
            while before[path[-1]] != node:
                path.append(before[path[-1]])
            return production, tuple(reversed(path))
    return None
