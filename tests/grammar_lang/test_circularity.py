"""The test for absolute noncircularity against the dependences of whole derivations."""

from __future__ import annotations

import random
from itertools import product

import pytest

from grammar_lang import ir
from grammar_lang.elaboration.circularity import cycle

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


def dependences(
    tree: Tree, productions: list[ir.Production], blocks: dict[str, ir.SemanticBlock]
) -> set[tuple[ir.AttributeOf, ir.AttributeOf]]:
    """Which attribute that the root production names depends on which, through its children too."""
    production = productions[tree[0]]
    edges = {
        (read, rule.target) for rule in blocks[production.label].rules for read in reads(rule.value)
    }
    for position, part in zip(nonterminals(production), tree[1], strict=True):
        for before, after in dependences(part, productions, blocks):
            if before.occurrence == after.occurrence == ir.THIS:
                edges.add(
                    (ir.AttributeOf(position, before.name), ir.AttributeOf(position, after.name))
                )
    return closure(edges)


def closure(
    edges: set[tuple[ir.AttributeOf, ir.AttributeOf]],
) -> set[tuple[ir.AttributeOf, ir.AttributeOf]]:
    """The transitive closure (S. Warshall, 1962)."""
    nodes = sorted({node for edge in edges for node in edge}, key=lambda n: (n.occurrence, n.name))
    for middle in nodes:
        into = [a for a in nodes if (a, middle) in edges]
        edges |= {(a, c) for a in into for c in nodes if (middle, c) in edges}
    return edges


def test_the_cycle_that_is_given_occurs_in_one_derivation() -> None:
    """In whatever grammar has a derivation with a cycle."""
    found = 0
    for seed in range(150):
        productions, blocks = random_grammar(random.Random(seed))
        if not any(circular(t, productions, blocks) for t in trees(productions, "S", 4)):
            continue
        answer = cycle(productions, blocks)
        assert answer is not None
        production, ring = answer
        assert len(set(ring)) == len(ring)
        pairs = set(zip(ring, (*ring[1:], ring[0]), strict=True))
        rooted = [
            t for t in trees(productions, production.left, 4) if productions[t[0]] == production
        ]
        assert any(pairs <= dependences(t, productions, blocks) for t in rooted), seed
        found += 1
    assert found > 30


def two_ways() -> tuple[list[ir.Production], dict[str, ir.SemanticBlock]]:
    """S hands t to i and s to j; one production of A makes s of i, another one t of j."""
    i, j, s, t = (ir.AttributeOf(ir.THIS, name) for name in "ijst")
    productions = [
        ir.Production("top", "S", (ir.Symbol("A", "nonterminal"),)),
        ir.Production("p", "A", (ir.Symbol("a", "module"),)),
        ir.Production("q", "A", (ir.Symbol("b", "module"),)),
    ]
    crossed = (ir.AttributeRule(ir.AttributeOf(0, "i"), ir.AttributeOf(0, "t")),
               ir.AttributeRule(ir.AttributeOf(0, "j"), ir.AttributeOf(0, "s")))  # fmt: skip
    first = (ir.AttributeRule(s, i), ir.AttributeRule(t, ir.Pi()))
    second = (ir.AttributeRule(s, ir.Pi()), ir.AttributeRule(t, j))
    rules = {"top": crossed, "p": first, "q": second}
    return productions, {label: ir.SemanticBlock(each, ()) for label, each in rules.items()}


def test_dependences_of_different_derivations_are_refused_too() -> None:
    """No derivation has a cycle, but the test keeps one relation for all derivations of A."""
    productions, blocks = two_ways()
    assert not any(circular(t, productions, blocks) for t in trees(productions, "S", 3))
    assert cycle(productions, blocks) is not None


def test_a_cycle_of_one_derivation_comes_first() -> None:
    """The first production only seems circular, the second is."""
    productions, blocks = two_ways()
    productions.append(ir.Production("worse", "S", (ir.Symbol("C", "nonterminal"),)))
    productions.append(ir.Production("r", "C", (ir.Symbol("a", "module"),)))
    again = ir.AttributeRule(ir.AttributeOf(0, "k"), ir.AttributeOf(0, "u"))
    below = ir.AttributeRule(ir.AttributeOf(ir.THIS, "u"), ir.AttributeOf(ir.THIS, "k"))
    blocks |= {"worse": ir.SemanticBlock((again,), ()), "r": ir.SemanticBlock((below,), ())}
    found = cycle(productions, blocks)
    assert found is not None
    assert found[0].label == "worse"


def test_a_shortest_cycle_is_given() -> None:
    """Of a detour of five attributes and one of two, the second."""
    a, b, c, d, e = (ir.AttributeOf(ir.THIS, name) for name in "abcde")
    edges = [(a, b), (b, c), (c, d), (d, e), (e, a), (a, e)]
    values: dict[ir.AttributeOf, ir.Expr] = {}
    for before, after in edges:
        values[after] = ir.Binary("+", values[after], before) if after in values else before
    rules = tuple(ir.AttributeRule(target, value) for target, value in values.items())
    production = ir.Production("p", "A", (ir.Symbol("a", "module"),))
    found = cycle([production], {"p": ir.SemanticBlock(rules, ())})
    assert found is not None
    assert set(found[1]) == {a, e}
