"""Planned evaluation against recursive evaluation on demand, on random attribute grammars."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import pytest

from compiler.expressions.scalars import Constant
from compiler.robots.attributes import SemanticsError, evaluate
from compiler.robots.evaluation_order import EvaluationOrder, Visit
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import PointBody, RobotModel
from compiler.words.derivation import Derivation, replay
from grammar_lang import ir
from grammar_lang.elaboration.circularity import cycle
from grammar_lang.load import load_text
from tests.oracles.attribute_grammars import (
    MODULES,
    SYNTHESIZED,
    CircularError,
    OnDemand,
    RandomGrammar,
    read_model,
)
from tests.oracles.some_cases import examples


def reads(value: ir.Expr) -> Iterator[ir.AttributeOf]:
    match value:
        case ir.AttributeOf():
            yield value
        case ir.Binary(_, left, right) | ir.Compose(left, right):
            yield from reads(left)
            yield from reads(right)
        case ir.Rot(_, part) | ir.Move(_, part):
            yield from reads(part)
        case _:
            pass


def follow(order: EvaluationOrder, derivation: Derivation) -> tuple[list[int], int]:
    """The visits of each node and the number of rules evaluated; all is there when it is read."""
    nodes = derivation.nodes
    known: set[tuple[int, str]] = set()
    visits = [0] * len(nodes)
    rules = 0

    def at(node: int, each: ir.AttributeOf) -> tuple[int, str]:
        return (node if each.occurrence < 0 else nodes[node].children[each.occurrence], each.name)

    def visit(node: int, given: tuple[frozenset[str], ...]) -> None:
        nonlocal rules
        visits[node] += 1
        for name in given[-1]:
            assert (node, name) in known
        for step in order.plan(nodes[node].production.label, given):
            if isinstance(step, Visit):
                visit(nodes[node].children[step.position], step.given)
                continue
            rules += 1
            assert all(at(node, each) in known for each in reads(step.value))
            assert at(node, step.target) not in known
            known.add(at(node, step.target))

    visit(0, order.first(nodes[0].production.label))
    return visits, rules


# --- the check and the evaluation agree -----------------------------------------------------------


@pytest.mark.parametrize(("density", "emitted"), [(0.08, 1), (0.14, 1), (0.14, 0.2)])
def test_what_the_check_accepts_is_evaluated_as_on_demand(density: float, emitted: float) -> None:
    accepted = several = unused = 0
    # Of the sparse ones most are accepted.
    for seed in range(examples(60, 150) if density < 0.1 else 150):
        grammar = RandomGrammar(seed, density, emitted)
        if cycle(grammar.productions, grammar.blocks) is not None:
            continue
        accepted += 1
        order = EvaluationOrder(grammar.productions, grammar.blocks)
        for _ in range(3):
            derivation = grammar.derivation()
            sizes = {i: Fraction(i + 3, 7) for i in range(len(derivation.word))}
            model = evaluate(derivation, MODULES, grammar.blocks, 2, order)
            wanted = OnDemand(derivation, grammar.blocks, sizes).emitted()
            assert read_model(model, sizes) == wanted, seed
            assert model == evaluate(derivation, MODULES, grammar.blocks, 2), seed
            visits, rules = follow(order, derivation)
            assert min(visits) >= 1
            assert max(visits) <= len(SYNTHESIZED) + 1
            all_rules = sum(len(grammar.blocks[label].rules) for label in derivation.labels)
            assert rules == all_rules if emitted == 1 else rules <= all_rules
            several += max(visits) > 1
            unused += rules < all_rules
    assert accepted > 20
    assert several > 10
    assert (unused > 0) == (emitted < 1)


def test_what_the_check_refuses_is_not_evaluated() -> None:
    refused = circular = 0
    for seed in range(120):
        grammar = RandomGrammar(seed, 0.2)
        found = cycle(grammar.productions, grammar.blocks)
        if found is None:
            continue
        refused += 1
        order = EvaluationOrder(grammar.productions, grammar.blocks)
        for _ in range(4):
            derivation = grammar.derivation()
            sizes = {i: Fraction(1) for i in range(len(derivation.word))}
            try:
                OnDemand(derivation, grammar.blocks, sizes).emitted()
            except CircularError:
                circular += 1
            else:
                if found[0].label not in derivation.labels:
                    continue
            with pytest.raises(SemanticsError, match="depends on itself"):
                evaluate(derivation, MODULES, grammar.blocks, 2, order)
    assert refused > 30
    assert circular > 30


# --- several visits -----------------------------------------------------------------------------

PRELUDE = """
module B { role base; }
module L { role link; param length in [1, 2] m; }
edge eps;
"""


def masses(grammar: str, labels: str) -> list[Fraction]:
    """The masses of the points of a derivation, in word order."""
    model = robot(grammar, labels)
    points, _ = read_model(model, dict.fromkeys((p.symbol for p in model.parameters), Fraction(1)))
    return [mass for _, mass in points]


def robot(grammar: str, labels: str) -> RobotModel:
    loaded = load_text(PRELUDE + grammar, "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    program = loaded.program
    (family,) = program.grammars.values()
    derivation = replay(family, labels.split())
    return evaluate(derivation, program.modules, family.semantics or {}, 2)


def test_what_a_child_gives_may_come_back_to_it() -> None:
    """The parts are counted on the way up, and each is told how many there are."""
    grammar = """
    grammar G { start S; top: S -> B T; more: T -> L eps T; last: T -> L; }
    semantics G {
      top { T.all = T.count; }
      more { this.count = T.count + 1; T.all = this.all;
             point(frame: world, mass: (10 * this.all + this.count) * 1 kg); }
      last { this.count = 1; point(frame: world, mass: (10 * this.all + this.count) * 1 kg); }
    }"""
    assert masses(grammar, "top more more last") == [33, 32, 31]


def test_siblings_feed_each_other() -> None:
    """Left to right by a, right to left by b: two visits of the left one."""
    grammar = """
    grammar G { start S; top: S -> B left:T eps right:T; one: T -> L; two: T -> L part:T; }
    semantics G {
      top { left.a = 2; right.a = left.v; right.b = right.v; left.b = right.w; }
      one { this.v = 3 * this.a; this.w = 5 * this.b + this.a;
            point(frame: world, mass: (this.a + 100 * this.b) * 1 kg); }
      two { part.b = this.a; this.v = part.w; part.a = 1; this.w = part.v * this.b;
            point(frame: world, mass: (this.a + 100 * this.b) * 1 kg); }
    }"""
    # left: a 2, v 6; right: a 6, v 18, b 18, w 96; left: b 96.
    assert masses(grammar, "top one one") == [2 + 9600, 6 + 1800]
    # left holds (a 1, b 2), v 3, w 11; so its own v is 11; right: a 11, v 33, b 33, w 176.
    assert masses(grammar, "top two one one") == [2 + 17600, 1 + 200, 11 + 3300]


COUNTED = """
grammar G { start S; top: S -> B T; more: T -> L eps T; last: T -> L; }
semantics G {
  top { T.all = T.count; T.at = this.frame; T.odd = T.all * T.all;
        point(frame: T.end, mass: 1 kg); }
  more { this.count = T.count + 1; T.all = this.all; T.at = this.at * move(x, L.length);
         this.end = move(y, 1 m) * T.end; T.odd = this.odd * this.odd;
         point(frame: this.at, mass: this.all * 1 kg); }
  last { this.count = 1; this.end = move(y, 1 m); point(frame: this.at, mass: this.count * 1 kg); }
}"""


def test_ten_thousand_productions_in_two_visits() -> None:
    """Up, down and suffixes of frames; what nobody emits (``odd``: two to the n digits) is left."""
    count = 10_000
    model = robot(COUNTED, "top " + "more " * (count - 1) + "last")
    found = [model.scalars[body.mass] for body in model.bodies if isinstance(body, PointBody)]
    assert found == [Constant(Fraction(m)) for m in (1, *[count] * (count - 1), 1)]
    assert len(model.chain(model.bodies[0].frame)) == count
    assert len(model.chain(model.bodies[-1].frame)) == count - 1


def test_the_order_belongs_to_the_family() -> None:
    loaded = load_text(PRELUDE + COUNTED, "g.srg")
    assert loaded.program is not None
    family = RobotFamily(loaded.program, loaded.program.grammars["G"], 2)
    order = family.evaluation_order
    given = order.first("top")
    plan = order.plan("top", given)
    family.robot(family.replay(("top", "more", "last")))
    family.robot(family.replay(("top", "last")))
    assert family.evaluation_order is order
    assert order.plan("top", given) is plan


def test_without_semantics_there_is_no_robot() -> None:
    grammar = RandomGrammar(1, 0)
    with pytest.raises(SemanticsError, match="no semantics"):
        evaluate(grammar.derivation(), MODULES, {}, 2)
