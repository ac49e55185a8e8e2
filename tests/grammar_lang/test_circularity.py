"""The test for absolute noncircularity against the dependences of whole derivations."""

from __future__ import annotations

import random
from itertools import product

import pytest

from grammar_lang import ir
from grammar_lang.circularity import cycle

HERE = ir.NOWHERE
Tree = tuple[int, tuple["Tree", ...]]


def nonterminals(production: ir.Production) -> list[int]:
    return [i for i, s in enumerate(production.right) if s.kind == "nonterminal"]


def random_grammar(
    choose: random.Random,
) -> tuple[list[ir.Production], dict[str, ir.SemanticBlock]]:
    """S, A and B with attributes i, j (inherited) and s, t (synthesized), each rule reads some."""
    productions, blocks = [], {}
    rights = {"S": ["A"], "A": ["a", "B", "B B", "A"], "B": ["b", "A b"]}
    for left, sides in rights.items():
        for number, side in enumerate(sides):
            right = tuple(
                ir.Symbol(x, "nonterminal" if x.isupper() else "module") for x in side.split()
            )
            production = ir.Production(f"{left}{number}", left, right)
            inner = nonterminals(production)
            given = [ir.AttributeOf(ir.THIS, n) for n in ("s", "t")]
            given += [ir.AttributeOf(i, n) for i in inner for n in ("i", "j")]
            read = [ir.AttributeOf(i, n) for i in inner for n in ("s", "t")]
            read += [ir.AttributeOf(ir.THIS, n) for n in ("i", "j") if left != "S"]
            rules = []
            for target in given:
                value: ir.Expr = ir.Pi()
                for node in choose.sample(read, min(len(read), choose.choice((0, 0, 0, 1, 1, 2)))):
                    value = ir.Binary("+", value, node)
                rules.append(ir.AttributeRule(target, value, HERE))
            productions.append(production)
            blocks[production.label] = ir.SemanticBlock(tuple(rules), (), HERE)
    return productions, blocks


def trees(productions: list[ir.Production], left: str, depth: int) -> list[Tree]:
    """Some derivation trees of a nonterminal."""
    found: list[Tree] = []
    for number, production in enumerate(productions):
        if production.left == left and depth:
            below = [
                trees(productions, production.right[i].name, depth - 1)
                for i in nonterminals(production)
            ]
            found += [(number, parts) for parts in product(*below)]
    return found[:60]


def reads(value: ir.Expr) -> list[ir.AttributeOf]:
    if isinstance(value, ir.AttributeOf):
        return [value]
    return reads(value.left) + reads(value.right) if isinstance(value, ir.Binary) else []


def circular(
    tree: Tree, productions: list[ir.Production], blocks: dict[str, ir.SemanticBlock]
) -> bool:
    """Whether the attributes of a whole tree cannot be ordered."""
    edges: dict[tuple[object, str], set[tuple[object, str]]] = {}

    def visit(tree: Tree, path: tuple[int, ...]) -> None:
        production = productions[tree[0]]
        inner = nonterminals(production)

        def at(node: ir.AttributeOf) -> tuple[object, str]:
            here = node.occurrence == ir.THIS
            return (path if here else (*path, inner.index(node.occurrence)), node.name)

        for rule in blocks[production.label].rules:
            edges.setdefault(at(rule.target), set()).update(map(at, reads(rule.value)))
        for number, part in enumerate(tree[1]):
            visit(part, (*path, number))

    visit(tree, ())
    left = set(edges)
    while free := {node for node in left if not edges[node] & left}:
        left -= free
    return bool(left)


def test_what_passes_is_never_circular() -> None:
    passed = refused = 0
    for seed in range(800):
        productions, blocks = random_grammar(random.Random(seed))
        wrong = any(circular(t, productions, blocks) for t in trees(productions, "S", 5))
        if cycle(productions, blocks) is None:
            assert not wrong, seed
            passed += 1
        else:
            refused += wrong
    assert passed > 20
    assert refused > 20


def test_alternatives_may_order_synthesized_attributes_differently() -> None:
    """Nothing comes from above, so that no derivation can be circular."""
    s, t = (ir.AttributeOf(ir.THIS, name) for name in "st")
    productions = [
        ir.Production("root", "S", (ir.Symbol("A", "nonterminal"),)),
        ir.Production("p", "A", (ir.Symbol("a", "module"),)),
        ir.Production("q", "A", (ir.Symbol("b", "module"),)),
    ]
    blocks = {
        "root": ir.SemanticBlock((ir.AttributeRule(s, ir.AttributeOf(0, "s"), HERE),), (), HERE),
        "p": ir.SemanticBlock(
            (ir.AttributeRule(s, ir.Pi(), HERE), ir.AttributeRule(t, s, HERE)), (), HERE
        ),
        "q": ir.SemanticBlock(
            (ir.AttributeRule(t, ir.Pi(), HERE), ir.AttributeRule(s, t, HERE)), (), HERE
        ),
    }
    assert cycle(productions, blocks) is None


@pytest.mark.parametrize("behind", [0, 3])
def test_the_cycle_is_given_in_its_order(behind: int) -> None:
    """Each attribute depends on the one before it; what only reads the cycle is no part of it."""
    names = [f"a{i}" for i in range(5)]
    pairs = [(f"b{i}", names[i]) for i in range(behind)]
    pairs += [(name, names[i - 1]) for i, name in enumerate(names)]
    rules = tuple(
        ir.AttributeRule(ir.AttributeOf(ir.THIS, a), ir.AttributeOf(ir.THIS, b), HERE)
        for a, b in pairs
    )
    production = ir.Production("p", "A", (ir.Symbol("a", "module"),))
    found = cycle([production], {"p": ir.SemanticBlock(rules, (), HERE)})
    assert found is not None
    ring = [node.name for node in found[1]]
    start = names.index(ring[0])
    assert ring == names[start:] + names[:start]
