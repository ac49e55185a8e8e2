"""Whether every effector of every robot of a family is a point of some body.

Such effectors never enter what bodies avoid. The semantic rules decide it: an effector is on a body
if its production emits a rod or a shape with a point at its frame's origin, or if its frame is an
attribute that another production defines at such a point. Nonterminals are split by which of their
frames are on bodies; an accepted word that has an effector elsewhere is then looked for as in
:mod:`compiler.robots.effector_counts`.

Origins are compared as the rules write them, so the answer may be "no" although they always agree.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TypeAlias

from compiler.robots.effector_counts import SEVERAL, some_word_has_several
from compiler.words.grammar import Cfg, Rule, srg
from grammar_lang import ir

MOST_FREE = 10
"""With more frames from outside in one production, nothing is decided."""
MOST_PARTS = 2000
"""A frame with more parts, once attributes are replaced, is somewhere unknown."""
EXTENDED = {"capsule", "cylinder"}
"""Shapes that begin at their frame's origin; spheres and boxes are centred there."""
OPPOSITE: Mapping[ir.Axis, ir.Axis] = {
    "x": "-x", "y": "-y", "z": "-z", "-x": "x", "-y": "y", "-z": "z"
}  # fmt: skip

NO_RULES = ir.SemanticBlock((), ())

Place: TypeAlias = tuple[ir.Expr, ...]
"""An origin: an attribute unless it starts at the world, and the steps that lead from there."""
Split: TypeAlias = tuple[str, tuple[bool, ...]]
"""A nonterminal, and for each of its frames in order whether it is on a body."""


def effectors_are_on_bodies(program: ir.Program, grammar: ir.Grammar) -> bool:
    """Whether all effectors of all accepted derivations are surely points of bodies that collide.

    Centres of mass count if the family has no shapes, which would collide in their place.
    """
    blocks = grammar.semantics
    if blocks is None:
        return False
    emissions = [each for block in blocks.values() for each in block.emissions]
    points = not any(isinstance(each, ir.Shape) for each in emissions)
    rules = [_Origins(p, blocks.get(p.label, NO_RULES), points) for p in grammar.productions]
    frames = defaultdict[str, set[str]](set)
    for each in rules:
        for attribute in each.passed_on:
            frames[each.symbol(attribute.occurrence)].add(attribute.name)
    names = {symbol: tuple(sorted(found)) for symbol, found in frames.items()}
    if any(len(each.free(names)) > MOST_FREE for each in rules):
        return False
    cfg, marks = _split(program, grammar, rules, names)
    return some_word_has_several(cfg, marks, grammar.accept, program.terminals) is False


def _split(
    program: ir.Program,
    grammar: ir.Grammar,
    rules: Sequence[_Origins],
    names: Mapping[str, tuple[str, ...]],
) -> tuple[Cfg, tuple[int, ...]]:
    """The split grammar, and for each rule ``SEVERAL`` if it has an effector off all bodies."""
    plain = srg(grammar, program.terminals, program.modules).cfg
    first = plain.terminals
    numbers: dict[Split, int] = {}

    def number(split: Split) -> int:
        return numbers.setdefault(split, first + 1 + len(numbers))

    found, marks = list[Rule](), list[int]()
    for each, rule in zip(rules, plain.rules, strict=True):
        for flags in product((False, True), repeat=len(each.free(names))):
            known = dict(zip(each.free(names), flags, strict=True))
            left = number(each.split(ir.THIS, names, known))
            right = tuple(
                code if code < first else number(each.split(place, names, known))
                for place, code in enumerate(rule.right)
            )
            found.append(Rule(left, right))
            marks.append(0 if all(each.is_on_body(e, known) for e in each.effectors) else SEVERAL)
    for (symbol, _), code in numbers.items():
        if symbol == grammar.start:
            found.append(Rule(first, (code,)))
            marks.append(0)
    return Cfg(first, 1 + len(numbers), tuple(found), first), tuple(marks)


@dataclass(frozen=True)
class _Origins:
    """A production, and where its rules put origins; with ``points``, centres of mass collide."""

    production: ir.Production
    block: ir.SemanticBlock
    points: bool

    @cached_property
    def values(self) -> Mapping[ir.AttributeOf, ir.Expr]:
        """The attributes that it defines."""
        return {rule.target: rule.value for rule in self.block.rules}

    @cached_property
    def effectors(self) -> tuple[ir.Expr, ...]:
        """The frames of the effectors that it emits."""
        return tuple(e.frame for e in self.block.emissions if isinstance(e, ir.Effector))

    @cached_property
    def on_bodies(self) -> frozenset[Place]:
        """Origins that are points of the bodies that it emits."""
        points = (p for each in self.block.emissions for p in self._points_of(each))
        return frozenset(place for place in points if place is not None)

    @cached_property
    def passed_on(self) -> frozenset[ir.AttributeOf]:
        """The attributes of other productions at whose origins it puts frames or effectors."""
        places = map(self.place, (*self.effectors, *self.values.values()))
        alone = (place[0] for place in places if place is not None and len(place) == 1)
        return frozenset(each for each in alone if isinstance(each, ir.AttributeOf))

    def symbol(self, occurrence: int) -> str:
        """The symbol at an occurrence."""
        if occurrence == ir.THIS:
            return self.production.left
        return self.production.right[occurrence].name

    def free(self, names: Mapping[str, tuple[str, ...]]) -> tuple[ir.AttributeOf, ...]:
        """The frames that other productions define, of those in ``names`` by nonterminal."""
        occurrences = (ir.THIS, *range(len(self.production.right)))
        every = (
            ir.AttributeOf(at, name)
            for at in occurrences
            for name in names.get(self.symbol(at), ())
        )
        return tuple(each for each in every if each not in self.values)

    def split(
        self,
        at: int,
        names: Mapping[str, tuple[str, ...]],
        known: Mapping[ir.AttributeOf, bool],
    ) -> Split:
        """The symbol at an occurrence, with its frames, given those of other productions.

        The production that defines a frame decides about it: a rod that begins at a given frame
        counts for the effectors there, but the nonterminal stays the one that was derived.
        """
        every = (ir.AttributeOf(at, name) for name in names.get(self.symbol(at), ()))
        flags = (known[e] if e in known else self.is_on_body(e, known) for e in every)
        return self.symbol(at), tuple(flags)

    def is_on_body(self, frame: ir.Expr, known: Mapping[ir.AttributeOf, bool]) -> bool:
        """Whether a frame's origin is on a body, given those that other productions define."""
        place = self.place(frame)
        if place is None or place in self.on_bodies:
            return place is not None
        return len(place) == 1 and isinstance(place[0], ir.AttributeOf) and known[place[0]]

    def place(self, frame: ir.Expr) -> Place | None:
        """The origin of a frame, with the attributes that the production defines replaced.

        None if it has too many parts: an attribute may occur many times in others.
        """
        steps, todo = list[ir.Expr](), [frame]
        for _ in range(MOST_PARTS):
            if not todo:
                break
            current = todo.pop()
            match current:
                case ir.Compose(left, right):
                    todo += [right, left]
                case ir.AttributeOf() if current in self.values:
                    todo.append(self.values[current])
                case ir.World() | ir.Move(distance=ir.Num(value=0)):
                    pass
                case ir.Move() if steps and steps[-1] == _back(current):
                    steps.pop()
                case _:
                    steps.append(current)
        while steps and isinstance(steps[-1], ir.Rot):
            steps.pop()
        return None if todo else tuple(steps)

    def _points_of(self, emission: ir.Emission) -> Iterator[Place | None]:
        match emission:
            case ir.Rod(frame=frame, axis=axis, length=length):
                yield self.place(frame)
                yield self.place(ir.Compose(frame, ir.Move(axis, length)))
            case ir.Shape(kind=kind, frame=frame, axis=axis, sizes=sizes) if kind != "hull":
                yield self.place(frame)
                if kind in EXTENDED and axis is not None:
                    yield self.place(ir.Compose(frame, ir.Move(axis, sizes[0])))
            case ir.PointMass(frame=frame) if self.points:
                yield self.place(frame)
            case _:
                return


def _back(move: ir.Move) -> ir.Move:
    """The move that undoes a move: by the same distance along the opposite axis."""
    return ir.Move(OPPOSITE[move.axis], move.distance)
