"""Finds where each module of a robot is, by following its frames through the semantic rules.

A copy of the semantics emits an effector at every step of every frame that the rules define, so
that evaluating the robot places them.  A step belongs to the module whose degree of freedom,
parameter or constant it mentions, else to the only module of its production, if there is only one.
Bodies stay as they are and are assigned to modules in the same way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from compiler.robots.attributes import evaluate
from compiler.robots.frame_parents import frame_attributes
from compiler.robots.frame_paths import attribute
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, DerivationNode, emission_order
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Stretch:
    """A step of a frame between two marks; ``place`` is the index of its module in the word.

    If the step is a joint, ``tip`` is the mark a metre along its axis.
    """

    place: int | None
    ends: tuple[int, int]
    joint: ir.DofKind | None
    tip: int | None


@dataclass(frozen=True)
class MarkedRobot:
    """The robot of a derivation, built by its rules, with marks as effectors.

    ``bodies`` and ``effectors`` have the index of the module that each belongs to;
    ``effector_marks`` are the marks of the robot's own effectors.  ``stands`` maps the index of a
    module to a mark at which its production puts it, for modules to which no step belongs.
    """

    model: RobotModel
    stretches: tuple[Stretch, ...]
    bodies: tuple[int | None, ...]
    effectors: tuple[int | None, ...]
    effector_marks: tuple[int, ...]
    stands: Mapping[int, int]


@dataclass(frozen=True, slots=True)
class _Step:
    """A step of a rule; its ends are numbers of marks in the block."""

    module: int | None
    ends: tuple[int, int]
    joint: ir.DofKind | None
    tip: int | None


@dataclass(slots=True)
class _Block:
    """A semantic block with its marks and steps."""

    production: ir.Production
    modules: Mapping[str, ir.Module]
    marks: list[ir.Effector] = field(default_factory=list[ir.Effector])
    steps: list[_Step] = field(default_factory=list[_Step])

    def mark(self, frame: ir.Expr) -> int:
        self.marks.append(ir.Effector(frame))
        return len(self.marks) - 1

    def follow(self, value: ir.Expr) -> None:
        """Mark a frame expression step by step."""
        factors = list(ir.factors(value))
        so_far: ir.Expr = ir.World()
        if factors and isinstance(factors[0], ir.AttributeOf | ir.World):
            so_far = factors.pop(0)
        before = self.mark(so_far)
        for factor in factors:
            so_far_then = ir.Compose(so_far, factor)
            joint, tip = self._joint(factor), None
            if joint is not None and isinstance(factor, ir.Rot | ir.Move):
                metre = ir.Move(factor.axis, ir.Num(Fraction(1)))
                tip = self.mark(ir.Compose(so_far, metre))
            after = self.mark(so_far_then)
            self.steps.append(_Step(self.owner(factor), (before, after), joint, tip))
            before, so_far = after, so_far_then

    def _joint(self, factor: ir.Expr) -> ir.DofKind | None:
        match factor:
            case ir.Rot(_, ir.DofOf()):
                return "revolute"
            case ir.Move(_, ir.DofOf()):
                return "prismatic"
            case _:
                return None

    def owner(self, expression: ir.Expr) -> int | None:
        """The module that an expression belongs to, by its index on the production's right side."""
        found = _mentioned(expression)
        if found:
            return min(found)
        own = self.own()
        return own[0] if len(own) == 1 else None

    def own(self) -> list[int]:
        """The modules of the production, by index."""
        return [i for i, symbol in enumerate(self.production.right) if symbol.name in self.modules]


def _mentioned(expression: ir.Expr) -> list[int]:
    """The modules on the right side that an expression mentions, by index."""
    found: list[int] = []
    todo = [expression]
    while todo:
        current = todo.pop()
        match current:
            case ir.DofOf(occurrence, _) | ir.ParameterOf(occurrence, _):
                found.append(occurrence)
            case ir.Rot(_, operand) | ir.Move(_, operand) | ir.Shift(operand):
                found += current.mentions
                todo.append(operand)
            case ir.Unary(_, operand):
                todo.append(operand)
            case ir.Binary(_, left, right) | ir.Compose(left, right):
                todo += [left, right]
            case ir.Vector(x, y, z):
                todo += [x, y, z]
            case _:
                pass
    return found


def marked_robot(
    grammar: ir.Grammar, modules: Mapping[str, ir.Module], derivation: Derivation, dimension: int
) -> MarkedRobot:
    """Build the robot of a derivation, with marks where its modules are.

    Raises:
        SemanticsError: the rules define no robot.
    """
    semantics = grammar.semantics or {}
    frames = frame_attributes(grammar)
    blocks: dict[str, _Block] = {}
    marked: dict[str, ir.SemanticBlock] = {}
    for production in {
        node.production.label: node.production for node in derivation.nodes
    }.values():
        block = _Block(production, modules)
        written = semantics[production.label]
        for rule in written.rules:
            if attribute(production, rule.target) in frames:
                block.follow(rule.value)
        for emission in written.emissions:
            if isinstance(emission, ir.Effector):
                block.follow(emission.frame)
        blocks[production.label] = block
        marked[production.label] = replace(written, emissions=(*written.emissions, *block.marks))
    model = evaluate(derivation, modules, marked, dimension)
    return _collected(derivation, semantics, blocks, model)


@dataclass(slots=True)
class _Collection:
    """The emissions of the nodes of a derivation, in the order of the robot."""

    stretches: list[Stretch] = field(default_factory=list[Stretch])
    bodies: list[int | None] = field(default_factory=list["int | None"])
    effectors: list[int | None] = field(default_factory=list["int | None"])
    effector_marks: list[int] = field(default_factory=list[int])
    stands: dict[int, int] = field(default_factory=dict[int, int])
    count: int = 0

    def add(self, node: DerivationNode, written: ir.SemanticBlock, block: _Block) -> None:
        """Add one node: its own emissions, then its marks."""

        def place(position: int | None) -> int | None:
            return None if position is None else node.children[position]

        for emission in written.emissions:
            if isinstance(emission, ir.Effector):
                self.effectors.append(place(_tool(block)))
                self.effector_marks.append(self.count)
                self.count += 1
            elif not isinstance(emission, ir.Shape):
                self.bodies.append(place(_body_owner(block, emission)))
        start = self.count
        self.count += len(block.marks)
        for step in block.steps:
            ends = start + step.ends[0], start + step.ends[1]
            tip = None if step.tip is None else start + step.tip
            self.stretches.append(Stretch(place(step.module), ends, step.joint, tip))
        if block.marks:
            at = start if len(block.own()) > 1 else self.count - 1
            self.stands |= {node.children[i]: at for i in block.own()}


def _tool(block: _Block) -> int | None:
    """The only effector module of a production, or else its only module."""
    own = block.own()
    tools = [i for i in own if block.modules[block.production.right[i].name].role == "effector"]
    for found in (tools, own):
        if len(found) == 1:
            return found[0]
    return None


def _body_owner(block: _Block, emission: ir.Emission) -> int | None:
    """The module that the quantities of a body mention, else the one that its frame belongs to."""
    return min(emission.mentions) if emission.mentions else block.owner(emission.frame)


def _collected(
    derivation: Derivation,
    semantics: Mapping[str, ir.SemanticBlock],
    blocks: Mapping[str, _Block],
    model: RobotModel,
) -> MarkedRobot:
    found = _Collection()
    for number in emission_order(derivation):
        node = derivation.nodes[number]
        label = node.production.label
        found.add(node, semantics[label], blocks[label])
    return MarkedRobot(
        model,
        tuple(found.stretches),
        tuple(found.bodies),
        tuple(found.effectors),
        tuple(found.effector_marks),
        found.stands,
    )
