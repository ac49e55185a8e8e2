"""Random attribute grammars of points and effectors, and evaluation by recursion on demand."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.scalars import evaluate_scalars
from compiler.robots.robot import Joint, Offset, PointBody, RobotModel, Turn
from compiler.words.derivation import Derivation, tree
from grammar_lang import ir
from tests.oracles.exact_chain import Rationals
from tests.oracles.robots import interval

Productions: TypeAlias = list[ir.Production]
Blocks: TypeAlias = dict[str, ir.SemanticBlock]
Path: TypeAlias = tuple[tuple[str, int, Fraction], ...]
Value: TypeAlias = Fraction | Path

LENGTH = ir.Parameter("length", interval(1, 5), "m")
MODULES = {name: ir.Module(name, "link", (LENGTH,), ()) for name in "ab"}
INHERITED, SYNTHESIZED = ("i", "j", "down"), ("s", "t", "up")
FRAMES = ("down", "up")
RIGHTS = {"S": ("A", "B a A"), "A": ("a", "B", "B b B", "A"), "B": ("b", "A b")}


# --- random grammars --------------------------------------------------------------------------


def number(value: int) -> ir.Num:
    return ir.Num(Fraction(value))


def is_inner(symbol: ir.Symbol) -> bool:
    return symbol.kind == "nonterminal"


class RandomGrammar:
    """Three inherited and three synthesized attributes of A and B.

    A rule reads each attribute that it may with a chance of ``density``, an emission with one of
    ``emitted``.
    """

    def __init__(self, seed: int, density: float, emitted: float = 1.0) -> None:
        self.choose = random.Random(seed)
        self.density = density
        self.emitted = emitted
        self.productions: Productions = []
        self.blocks: Blocks = {}
        for left, sides in RIGHTS.items():
            for count, side in enumerate(sides):
                right = tuple(
                    ir.Symbol(x, "nonterminal" if x.isupper() else "module") for x in side.split()
                )
                self.productions.append(ir.Production(f"{left}{count}", left, right))
                self.blocks[f"{left}{count}"] = self.block(self.productions[-1])

    def block(self, production: ir.Production) -> ir.SemanticBlock:
        inner = [i for i, symbol in enumerate(production.right) if is_inner(symbol)]
        outer = production.left != "S"
        read = [ir.AttributeOf(i, n) for i in inner for n in SYNTHESIZED]
        read += [ir.AttributeOf(ir.THIS, n) for n in INHERITED if outer]
        given = [ir.AttributeOf(ir.THIS, n) for n in SYNTHESIZED if outer]
        given += [ir.AttributeOf(i, n) for i in inner for n in INHERITED]
        self.choose.shuffle(given)
        modules = [i for i, s in enumerate(production.right) if s.kind == "module"]
        rules = []
        for target in given:
            some = [each for each in read if self.choose.random() < self.density]
            self.choose.shuffle(some)
            made = self.frame if target.name in FRAMES else self.scalar
            rules.append(ir.AttributeRule(target, made(some, modules)))
        shown = [each for each in read if self.choose.random() < self.emitted]
        body = ir.PointMass(self.frame(shown, modules), self.scalar(shown, modules))
        return ir.SemanticBlock(tuple(rules), (body, ir.Effector(self.frame(shown, modules))))

    def scalar(self, read: list[ir.AttributeOf], modules: list[int]) -> ir.Expr:
        value: ir.Expr = number(self.choose.randrange(2, 100))
        for position in modules:
            value = ir.Binary("+", value, ir.ParameterOf(position, "length"))
        for each in read:
            if each.name not in FRAMES:
                value = ir.Binary("+", ir.Binary("*", number(2), value), each)
        return value

    def frame(self, read: list[ir.AttributeOf], modules: list[int]) -> ir.Expr:
        value: ir.Expr = ir.Move("y", self.scalar([], modules))
        for each in read:
            step = each if each.name in FRAMES else ir.Rot("z", each)
            pair = (value, step) if self.choose.random() < 0.5 else (step, value)
            value = ir.Compose(*pair)
        return value

    def derivation(self, depth: int = 5) -> Derivation:
        """A random one, deeper than asked for only as far as it cannot end at once."""
        shortest = {"S": "S0", "A": "A0", "B": "B0"}
        by_label = {p.label: p for p in self.productions}
        found: Productions = []
        todo = [("S", 0)]
        while todo:
            left, level = todo.pop()
            among = [p for p in self.productions if p.left == left]
            chosen = by_label[shortest[left]] if level > depth else self.choose.choice(among)
            found.append(chosen)
            todo += [(s.name, level + 1) for s in reversed(chosen.right) if is_inner(s)]
        return tree("S", found)


# --- the oracle -------------------------------------------------------------------------------


class CircularError(Exception):
    """An attribute of the derivation depends on itself."""


class OnDemand:
    """Values of a derivation by recursion, with numbers for parameters and paths for frames."""

    def __init__(self, derivation: Derivation, blocks: Blocks, sizes: dict[int, Fraction]) -> None:
        self.derivation, self.blocks, self.sizes = derivation, blocks, sizes
        self.above: dict[int, tuple[int, int]] = {}
        for parent, node in enumerate(derivation.nodes):
            for position, symbol in enumerate(node.production.right):
                if is_inner(symbol):
                    self.above[node.children[position]] = (parent, position)
        self.known: dict[tuple[int, str], Value | None] = {}

    def attribute(self, node: int, name: str) -> Value:
        if (node, name) not in self.known:
            self.known[node, name] = None
            where, place = (node, ir.THIS) if name in SYNTHESIZED else self.above[node]
            block = self.blocks[self.derivation.nodes[where].production.label]
            (rule,) = (r for r in block.rules if r.target == ir.AttributeOf(place, name))
            self.known[node, name] = self.value(where, rule.value)
        found = self.known[node, name]
        if found is None:
            raise CircularError
        return found

    def value(self, node: int, expression: ir.Expr) -> Value:
        children = self.derivation.nodes[node].children
        match expression:
            case ir.Num(value):
                return value
            case ir.ParameterOf(occurrence, _):
                return self.sizes[children[occurrence]]
            case ir.AttributeOf(occurrence, name):
                return self.attribute(node if occurrence < 0 else children[occurrence], name)
            case ir.Binary(operator, left, right):
                a, b = self.number(node, left), self.number(node, right)
                return a + b if operator == "+" else a * b
            case ir.Move("y", distance):
                return (("move", 1, self.number(node, distance)),)
            case ir.Rot("z", angle):
                return (("turn", 2, self.number(node, angle)),)
            case ir.Compose(left, right):
                return self.path(node, left) + self.path(node, right)
            case _:
                raise AssertionError(expression)

    def number(self, node: int, expression: ir.Expr) -> Fraction:
        found = self.value(node, expression)
        assert isinstance(found, Fraction)
        return found

    def path(self, node: int, expression: ir.Expr) -> Path:
        found = self.value(node, expression)
        assert isinstance(found, tuple)
        return found

    def emitted(self) -> tuple[list[tuple[Path, Fraction]], list[Path]]:
        """Points and effectors of every node, in the order of the first module of its block."""
        size = len(self.derivation.word)
        nodes = self.derivation.nodes
        places = []
        for count, node in enumerate(nodes):
            own = [c for c, s in zip(node.children, node.production.right, strict=True)
                   if s.kind == "module"]  # fmt: skip
            places.append((own[0] if own else size, count))
        points, tips = [], []
        for _, node_number in sorted(places):
            for emission in self.blocks[nodes[node_number].production.label].emissions:
                frame = self.path(node_number, emission.frame)
                if isinstance(emission, ir.PointMass):
                    points.append((frame, self.number(node_number, emission.mass)))
                else:
                    tips.append(frame)
        return points, tips


def read_model(
    model: RobotModel, sizes: dict[int, Fraction]
) -> tuple[list[tuple[Path, Fraction]], list[Path]]:
    """Points and effectors of a model, with the steps that lead to them."""

    known = [sizes.get(parameter.symbol, Fraction(0)) for parameter in model.parameters]
    values = evaluate_scalars(model.scalars, Rationals(), known)

    def path(frame: int) -> Path:
        found: list[tuple[str, int, Fraction]] = []
        for step in model.steps(frame):
            match step:
                case Turn(axis, angle):
                    found.append(("turn", axis, values[angle]))
                case Offset((x, y, z)):
                    assert values[x] == values[z] == 0
                    found.append(("move", 1, values[y]))
                case Joint():
                    raise AssertionError
        return tuple(found)

    points = []
    for body in model.bodies:
        assert isinstance(body, PointBody)
        points.append((path(body.frame), values[body.mass]))
    return points, [path(frame) for frame in model.effectors]
