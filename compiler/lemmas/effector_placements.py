"""Where effectors can be, over all robots of a regular set of words: attributes of all derivations.

The values of an attribute at all nodes that a graph of derivations identifies are enclosed
together. The enclosure is the least solution of "the value of a rule is enclosed", approached from
below; ends that keep growing are set to infinity. Revolute joints turn freely, prismatic joints and
parameters take all values of their ranges.

Source: Cousot & Cousot, *Abstract interpretation* (1977); Knuth, *Semantics of context-free
languages* (1968) for attributes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.expressions.evaluator import evaluate_expression
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, between
from compiler.expressions.exact_numbers import rational_bounds
from compiler.lemmas.conditioned_derivations import Application, ConditionedDerivations, Node
from compiler.lemmas.frame_placement import (
    EVERYTHING,
    WORLD,
    Placement,
    along,
    freely_turned,
    hull,
    placed,
    total,
    turned,
    widened,
)
from compiler.robots.attributes import AXES, ROOT_ATTRIBUTE
from compiler.robots.evaluation_order import owner
from compiler.time_limits.time_limit import check_time
from grammar_lang import ir
from grammar_lang.elaboration.circularity import reads

UPDATES = 20
"""How often a value may grow before its ends are set to infinity."""

Triple: TypeAlias = tuple[Ends, Ends, Ends]
Value: TypeAlias = Ends | Triple | Placement
Key: TypeAlias = tuple[Node | int, str]
"""An attribute of a node, or a local value of an application, by number."""


class NotPlaced(ValueError):
    """An effector may have no frame in some derivation."""


def effector_placements(
    modules: Mapping[str, ir.Module], grammar: ir.Grammar, derivations: ConditionedDerivations
) -> tuple[Placement, ...]:
    """Placements that together enclose every effector of every robot of some derivations.

    ``derivations`` are derivations of the grammar; their rules are its productions, in order.

    Raises:
        NotPlaced: a frame is not defined in some derivation.
    """
    return _Placing(modules, grammar, derivations).effectors()


@dataclass(slots=True)
class _Placing:
    modules: Mapping[str, ir.Module]
    grammar: ir.Grammar
    derivations: ConditionedDerivations
    values: dict[Key, Value] = field(default_factory=dict[Key, Value])
    updates: dict[Key, int] = field(default_factory=dict[Key, int])
    ranges: dict[tuple[str, str], Ends] = field(default_factory=dict[tuple[str, str], Ends])

    def effectors(self) -> tuple[Placement, ...]:
        """All placements of emitted effectors, once the attributes are enclosed."""
        if self.grammar.semantics is None:
            raise NotPlaced("the grammar has no semantics")
        if not _is_made(self.grammar):
            for root in self.derivations.roots:
                self.values[root, ROOT_ATTRIBUTE] = WORLD
        self._close()
        found: list[Placement] = []  # a list, as infinity has no hash
        for number, application in enumerate(self.derivations.applications):
            for emission in self._block(application).emissions:
                if isinstance(emission, ir.Effector):
                    frame = _Reading(self, number, application).frame(emission.frame)
                    if frame is None:
                        raise NotPlaced(application.rule)
                    if frame not in found:
                        found.append(frame)
        return tuple(found)

    def _close(self) -> None:
        """Evaluate rules until nothing grows."""
        needed = _needed(self.grammar)
        readers: dict[Key, list[tuple[int, ir.AttributeRule]]] = {}
        todo: deque[tuple[int, ir.AttributeRule]] = deque()
        for number, application in enumerate(self.derivations.applications):
            production = self.grammar.productions[application.rule]
            for rule in self._block(application).rules:
                if (owner(production, rule.target), rule.target.name) not in needed:
                    continue
                todo.append((number, rule))
                for read in reads(rule.value):
                    key = _key(number, application, read)
                    readers.setdefault(key, []).append((number, rule))
        waiting = {(number, id(rule)) for number, rule in todo}
        while todo:
            check_time()
            number, rule = todo.popleft()
            waiting.discard((number, id(rule)))
            application = self.derivations.applications[number]
            value = _Reading(self, number, application).value(rule.value)
            key = _key(number, application, rule.target)
            if value is None or not self._grow(key, value):
                continue
            for reader in readers.get(key, ()):
                if (reader[0], id(reader[1])) not in waiting:
                    waiting.add((reader[0], id(reader[1])))
                    todo.append(reader)

    def _grow(self, key: Key, value: Value) -> bool:
        """Enclose one more value; return whether that changes anything."""
        old = self.values.get(key)
        if old is None:
            self.values[key] = value
            return True
        new = _joined(old, value)
        if new == old:
            return False
        self.updates[key] = self.updates.get(key, 0) + 1
        self.values[key] = new if self.updates[key] < UPDATES else _widened(old, new)
        return True

    def _block(self, application: Application) -> ir.SemanticBlock:
        label = self.grammar.productions[application.rule].label
        blocks = self.grammar.semantics or {}
        if label not in blocks:
            raise NotPlaced(f"production `{label}` has no semantics")
        return blocks[label]

    def range_of(self, module: str, name: str) -> Ends:
        """All values of a parameter."""
        key = module, name
        if key not in self.ranges:
            (parameter,) = (p for p in self.modules[module].parameters if p.name == name)
            domain = parameter.domain
            ends = domain.values if isinstance(domain, ir.Choices) else (domain.lower, domain.upper)
            bounds = [rational_bounds(end) for end in ends]
            self.ranges[key] = between(min(a for a, _ in bounds), max(b for _, b in bounds))
        return self.ranges[key]


def _is_made(grammar: ir.Grammar) -> bool:
    """Whether the frame of the start symbol is synthesized; otherwise it is the world."""
    made, blocks = ir.AttributeOf(ir.THIS, ROOT_ATTRIBUTE), grammar.semantics or {}
    return any(
        rule.target == made
        for production in grammar.productions
        if production.left == grammar.start
        if production.label in blocks
        for rule in blocks[production.label].rules
    )


def _needed(grammar: ir.Grammar) -> set[tuple[str, str]]:
    """The attributes that frames of effectors depend on, by owner and name."""
    blocks, sources = grammar.semantics or {}, dict[tuple[str, str], set[tuple[str, str]]]()
    todo: list[tuple[str, str]] = []
    for production in grammar.productions:
        block = blocks.get(production.label)
        if block is None:
            continue
        for rule in block.rules:
            key = owner(production, rule.target), rule.target.name
            read = {(owner(production, each), each.name) for each in reads(rule.value)}
            sources.setdefault(key, set()).update(read)
        for emission in block.emissions:
            if isinstance(emission, ir.Effector):
                todo += [(owner(production, each), each.name) for each in reads(emission.frame)]
    found: set[tuple[str, str]] = set()
    while todo:
        key = todo.pop()
        if key not in found:
            found.add(key)
            todo += sources.get(key, ())
    return found


def _key(number: int, application: Application, attribute: ir.AttributeOf) -> Key:
    """The key of the value of an attribute that a block names."""
    if attribute.occurrence == ir.THIS:
        return application.node, attribute.name
    if attribute.occurrence == ir.LOCAL:
        return number, attribute.name
    (child,) = (node for place, node in application.children if place == attribute.occurrence)
    return child, attribute.name


def _joined(old: Value, new: Value) -> Value:
    match old, new:
        case Placement(), Placement():
            return old.joined(new)
        case Ends(), Ends():
            return hull(old, new)
        case (tuple(), tuple()):
            return hull(old[0], new[0]), hull(old[1], new[1]), hull(old[2], new[2])
        case _:
            raise NotPlaced("an attribute is of two sorts")


def _widened(old: Value, new: Value) -> Value:
    match old, new:
        case Placement(), Placement():
            return old.widened(new)
        case Ends(), Ends():
            return widened(old, new)
        case (tuple(), tuple()):
            return widened(old[0], new[0]), widened(old[1], new[1]), widened(old[2], new[2])
        case _:
            raise NotPlaced("an attribute is of two sorts")


def _after(frame: Placement | None, step: Placement | None) -> Placement:
    """One frame placed in another; None is the world, or a step that changes nothing."""
    if frame is None or step is None:
        return frame or step or WORLD
    return frame.then(step)


class _Unread(Exception):
    """An attribute has no value yet."""


@dataclass(frozen=True, slots=True)
class _Reading:
    """The values of expressions in the block of an application."""

    placing: _Placing
    number: int
    application: Application

    def value(self, expression: ir.Expr) -> Value | None:
        """The value of an expression; None if something that it reads has no value yet."""
        try:
            match expression:
                case ir.AttributeOf():
                    return self._read(expression)
                case ir.Vector(x, y, z):
                    return self._scalar(x), self._scalar(y), self._scalar(z)
                case ir.World() | ir.Rot() | ir.Move() | ir.Shift() | ir.Compose():
                    return self._frame(expression)
                case _:
                    return self._scalar(expression)
        except _Unread:
            return None

    def frame(self, expression: ir.Expr) -> Placement | None:
        """The value of a frame; None as in ``value``."""
        found = self.value(expression)
        if found is not None and not isinstance(found, Placement):
            raise NotPlaced("a frame is expected")
        return found

    def _frame(self, expression: ir.Expr) -> Placement:
        """The value of a frame; runs of rigid steps are combined first, into one displacement."""
        found: Placement | None = None
        run: Placement | None = None
        for step, rigid in self._steps(expression):
            if rigid:
                run = _after(run, step)
                continue
            found = _after(_after(found, run) if found or run else None, step)
            run = None
        return _after(found, run)

    def _steps(self, expression: ir.Expr) -> Iterator[tuple[Placement, bool]]:
        """The factors of a frame, and whether each is rigid or slides."""
        for factor in ir.factors(expression):
            match factor:
                case ir.World():
                    continue
                case ir.AttributeOf():
                    value = self._read(factor)
                    if not isinstance(value, Placement):
                        raise NotPlaced("a frame is expected")
                    yield value, False
                case ir.Rot(axis, ir.DofOf()):
                    yield freely_turned(AXES[axis][0]), False
                case ir.Rot(axis, angle):
                    yield turned(AXES[axis][0], self._signed(axis, self._scalar(angle))), True
                case ir.Move(axis, ir.DofOf() as dof):
                    yield along(AXES[axis][0], self._signed(axis, self._slide(dof))), True
                case ir.Move(axis, distance):
                    yield along(AXES[axis][0], self._signed(axis, self._scalar(distance))), True
                case ir.Shift(vector):
                    yield placed(self._vector(vector)), True
                case _:
                    raise NotPlaced("a frame is expected")

    def _signed(self, axis: ir.Axis, value: Ends) -> Ends:
        return value if AXES[axis][1] > 0 else INTERVALS.neg(value)

    def _slide(self, dof: ir.DofOf) -> Ends:
        """All coordinates of a prismatic joint."""
        module = self.placing.modules[self._module(dof.occurrence)]
        (found,) = (each for each in module.dofs if each.name == dof.name)
        if found.range is None:
            return EVERYTHING
        low, high = rational_bounds(found.range.lower)[0], rational_bounds(found.range.upper)[1]
        return between(low, high)

    def _vector(self, expression: ir.Expr) -> Triple:
        match expression:
            case ir.Vector(x, y, z):
                return self._scalar(x), self._scalar(y), self._scalar(z)
            case ir.AttributeOf():
                found = self._read(expression)
                if isinstance(found, tuple):
                    return found
            case _:
                pass
        raise NotPlaced("a vector is expected")

    def _scalar(self, expression: ir.Expr) -> Ends:
        return total(evaluate_expression(expression, INTERVALS, self._leaf))

    def _leaf(self, leaf: ir.Expr) -> Ends:
        match leaf:
            case ir.ParameterOf(occurrence, name):
                return self.placing.range_of(self._module(occurrence), name)
            case ir.AttributeOf():
                found = self._read(leaf)
                if isinstance(found, Ends):
                    return found
            case _:
                pass
        raise NotPlaced("a scalar is expected")

    def _read(self, attribute: ir.AttributeOf) -> Value:
        found = self.placing.values.get(_key(self.number, self.application, attribute))
        if found is None:
            raise _Unread
        return found

    def _module(self, occurrence: int) -> str:
        """The name of the module at an occurrence."""
        return self.placing.grammar.productions[self.application.rule].right[occurrence].name
