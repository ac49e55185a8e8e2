"""The normal form of a robot model: rigid steps merged, idle joints removed, coaxial joints merged.

Two robots whose normal forms have equal keys are equal up to the names of their parameters, so only
one of them needs to be tried. The converse need not hold; a missed equality only costs time. Every
pass is linear in the number of frames.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

from compiler.expressions.scalars import Constant, ScalarTable
from compiler.robots.attributes import evaluate
from compiler.robots.bodies_apart import bodies_apart
from compiler.robots.evaluation_order import EvaluationOrder
from compiler.robots.idle_joints import renumbered, without_idle_joints
from compiler.robots.payloads import with_payloads
from compiler.robots.robot import (
    WORLD,
    FrameNode,
    Joint,
    Offset,
    RobotDof,
    RobotModel,
    Step,
    Turn,
    WordDof,
)
from compiler.words.derivation import Derivation, replay
from compiler.words.language import Language, language
from grammar_lang import ir
from grammar_lang.ir.formula_parts import asked_poses


def normalise(model: RobotModel) -> RobotModel:
    """The normal form of a robot.

    A degree of freedom that moves no mass, effector or body point is removed. Consecutive joints
    about one axis become one if only rigid steps that commute with them lie between; its range is
    the interval sum of their ranges. Own dynamics that no longer act on a degree of freedom are
    left out.
    """
    model = replace(model, joints=model.word_dofs)
    model = with_rigid_steps_merged(without_idle_joints(model))
    model = with_coaxial_joints_merged(model)
    acting = (own.acting() for own in model.own)
    return with_rigid_steps_merged(replace(model, own=tuple(own for own in acting if own.torques)))


# --- Frames that something uses, with the rigid steps between their joints merged -----------------


def with_rigid_steps_merged(model: RobotModel) -> RobotModel:
    """The model with only the frames that lead to an item, adjacent rigid steps merged."""
    table = ScalarTable()
    for node in model.scalars:
        table.add(node)
    rebuilder = _Rebuilder(model, table)
    bodies = tuple(replace(body, frame=rebuilder.frame(body.frame)) for body in model.bodies)
    effectors = tuple(rebuilder.frame(frame) for frame in model.effectors)
    shapes = tuple(replace(shape, frame=rebuilder.frame(shape.frame)) for shape in model.shapes)
    seen = tuple(rebuilder.frame(frame) for frame in model.seen)
    return replace(
        model,
        frames=tuple(rebuilder.frames),
        scalars=tuple(table.nodes),
        bodies=bodies,
        effectors=effectors,
        shapes=shapes,
        seen=seen,
    )


@dataclass(slots=True)
class _Chain:
    """A step and the rest of the chain before it; ``frame`` is its new frame once it is needed.

    Chains share their beginnings. A chain without a step is the world.
    """

    rest: _Chain | None
    step: Step | None
    frame: int | None = None


@dataclass(slots=True)
class _Rebuilder:
    """Rebuilds the used frames, each once."""

    model: RobotModel
    table: ScalarTable
    frames: list[FrameNode] = field(default_factory=lambda: [FrameNode(WORLD, None)])
    index: dict[tuple[int, Step], int] = field(default_factory=dict[tuple[int, Step], int])
    chains: dict[int, _Chain] = field(default_factory=lambda: {WORLD: _Chain(None, None, WORLD)})

    def frame(self, old: int) -> int:
        """The new frame of an old one."""
        todo = []
        chain: _Chain | None = self.chain(old)
        while chain is not None and chain.frame is None:
            todo.append(chain)
            chain = chain.rest
        current = WORLD if chain is None or chain.frame is None else chain.frame
        for link in reversed(todo):
            if link.step is not None:
                current = self.add(current, link.step)
            link.frame = current
        return current

    def chain(self, old: int) -> _Chain:
        """The chain of an old frame, continued from the nearest known one."""
        todo = []
        while old not in self.chains:
            todo.append(old)
            old = self.model.frames[old].parent
        chain = self.chains[old]
        for frame in reversed(todo):
            step = self.model.frames[frame].step
            chain = chain if step is None else self.extended(chain, step)
            self.chains[frame] = chain
        return chain

    def extended(self, chain: _Chain, step: Step) -> _Chain:
        """A chain with one more step, merged with the last step if both are of one kind."""
        last = chain.step
        if isinstance(step, Offset) and isinstance(last, Offset):
            pairs = zip(last.vector, step.vector, strict=True)
            x, y, z = (self.table.binary("+", a, b) for a, b in pairs)
            return self.behind(chain.rest, Offset((x, y, z)))
        if isinstance(step, Turn) and isinstance(last, Turn) and step.axis == last.axis:
            angle = self.table.binary("+", last.angle, step.angle)
            return self.behind(chain.rest, Turn(step.axis, angle))
        return _Chain(chain, step)

    def behind(self, rest: _Chain | None, step: Turn | Offset) -> _Chain:
        """A merged step after the rest of a chain; only the rest if the steps have cancelled."""
        scalars = (step.angle,) if isinstance(step, Turn) else step.vector
        if rest is not None and all(self.table.rational(scalar) == 0 for scalar in scalars):
            return rest
        return _Chain(rest, step)

    def add(self, parent: int, step: Step) -> int:
        key = (parent, step)
        if key not in self.index:
            self.index[key] = len(self.frames)
            self.frames.append(FrameNode(parent, step))
        return self.index[key]


# --- Joints about one axis with nothing between them are one degree of freedom --------------------


def with_coaxial_joints_merged(model: RobotModel) -> RobotModel:
    """The model with each run of coaxial joints merged; the range is the interval sum of theirs.

    A coordinate that occurs in several frames is not merged, because the joints at the other frames
    would not follow. A coordinate that a module's own dynamics read is not merged either: they
    concern that joint alone.
    """
    followers = _followers(model)
    heads = sorted(followers.keys() - followers.values())
    dofs, frames = list(model.dofs), list(model.frames)
    gone: set[int] = set()
    parts = {dof: (dof, 1) for dof in range(len(dofs))}
    for head in heads:
        run = _run(head, followers)
        members = [_joint(model, frame) for frame in run]
        dofs[members[0].dof] = _merged(model, members)
        for member, sign in zip(members, _signs(members), strict=True):
            parts[member.dof] = members[0].dof, sign
        gone.update(member.dof for member in members[1:])
        for frame in run[1:]:
            frames[frame] = FrameNode(frames[frame].parent, None)
    kept = sorted(
        (dof for dof in range(len(dofs)) if dof not in gone), key=lambda i: dofs[i].symbols
    )
    places = {old: new for new, old in enumerate(kept)}
    return replace(
        model,
        dofs=tuple(dofs[dof] for dof in kept),
        frames=renumbered(frames, places),
        own=tuple(own.renumbered(places) for own in model.own),
        joints=tuple(_summand(joint, parts, places) for joint in model.word_dofs),
    )


def _summand(
    joint: WordDof, parts: Mapping[int, tuple[int, int]], places: Mapping[int, int]
) -> WordDof:
    """A degree of freedom of the word after merging; ``parts`` maps dofs to wholes and signs."""
    if joint.dof is None:
        return joint
    whole, sign = parts[joint.dof]
    return replace(joint, dof=places[whole], sign=sign * joint.sign)


def _joint(model: RobotModel, frame: int) -> Joint:
    step = model.frames[frame].step
    if not isinstance(step, Joint):
        raise TypeError("only joints are merged")
    return step


def _run(first: int, followers: dict[int, int]) -> list[int]:
    """A joint frame and the joint frames that follow it directly."""
    run = [first]
    while run[-1] in followers:
        run.append(followers[run[-1]])
    return run


def _followers(model: RobotModel) -> dict[int, int]:
    """Maps a joint frame to the coaxial one that merges into it: nothing is attached between.

    Rigid steps that commute with the first joint's motion do not count as between, as they could
    equally follow both joints.
    """
    items = [item.frame for item in (*model.bodies, *model.shapes)] + list(model.effectors)
    used = _used(model, items)
    carrier = _carriers(model)
    occupied = {carrier[frame] for frame in items}
    behind: dict[int, list[int]] = {}
    for frame in used:
        if model.frames[frame].step is not None:
            behind.setdefault(carrier[model.frames[frame].parent], []).append(frame)
    alone = _alone(model, used)
    found = {}
    for first, joint in alone.items():
        frame = first
        while True:
            nearest = behind.get(frame, [])
            if len(nearest) != 1 or frame in occupied:
                break
            (frame,) = nearest
            if frame in alone:
                if _alike(model, joint, alone[frame]):
                    found[first] = frame
                break
            if not _commutes(model, joint, model.frames[frame].step):
                break
    return found


def _alike(model: RobotModel, a: Joint, b: Joint) -> bool:
    """Whether two joints about parallel local axes are of one kind."""
    return a.axis == b.axis and model.dofs[a.dof].kind == model.dofs[b.dof].kind


def _commutes(model: RobotModel, joint: Joint, step: Step | None) -> bool:
    """Whether a rigid step may be exchanged with the motion of a joint before it."""
    match step:
        case Turn(axis, _):
            return axis == joint.axis
        case Offset(vector):
            zero = Constant(Fraction(0))
            off = [i for i in range(3) if model.scalars[vector[i]] != zero]
            return model.dofs[joint.dof].kind == "prismatic" or not off or off == [joint.axis]
        case _:
            return False


def _used(model: RobotModel, items: Sequence[int]) -> list[int]:
    """The frames that lead to an item, in order."""
    found = [False] * len(model.frames)
    for frame in items:
        found[frame] = True
    for frame in range(len(model.frames) - 1, WORLD, -1):
        found[model.frames[frame].parent] |= found[frame]
    return [frame for frame in range(WORLD + 1, len(found)) if found[frame]]


def _carriers(model: RobotModel) -> list[int]:
    """For each frame the nearest at or before it on its path that has a step or is the world."""
    found = [WORLD]
    for frame, node in enumerate(model.frames[WORLD + 1 :], WORLD + 1):
        found.append(found[node.parent] if node.step is None else frame)
    return found


def _alone(model: RobotModel, used: Sequence[int]) -> dict[int, Joint]:
    """The joint frames without a drive whose coordinate nothing else reads."""
    read = {dof for own in model.own for dof in own.bound_dofs.values()}
    steps = {frame: s for frame in used if isinstance(s := model.frames[frame].step, Joint)}
    uses = Counter(step.dof for step in steps.values())
    driven = {i for i, dof in enumerate(model.dofs) if dof.is_driven}
    return {f: s for f, s in steps.items() if uses[s.dof] == 1 and s.dof not in read | driven}


def _merged(model: RobotModel, members: Sequence[Joint]) -> RobotDof:
    """The degree of freedom that replaces coaxial joints, in the direction of the first one."""
    dofs = [model.dofs[member.dof] for member in members]
    signs = _signs(members)
    return RobotDof(
        tuple(sorted(symbol for dof in dofs for symbol in dof.symbols)),
        dofs[0].kind,
        dofs[0].axis,
        _sum([dof.range for dof in dofs], signs),
        _sum([dof.rate for dof in dofs], signs),
        called=" and ".join(dof.called for dof in dofs),
    )


def _signs(members: Sequence[Joint]) -> list[int]:
    """Whether each coaxial joint moves in the direction of the first one (1) or against it (-1)."""
    return [members[0].sign * member.sign for member in members]


def _sum(intervals: Sequence[ir.Interval | None], signs: Sequence[int]) -> ir.Interval | None:
    """The sum of signed intervals, added in pairs to keep terms shallow; None is unlimited."""
    terms: list[ir.Interval] = []
    for interval, sign in zip(intervals, signs, strict=True):
        if interval is None:
            return None
        terms.append(interval if sign > 0 else _negated(interval))
    while len(terms) > 1:
        pairs = [terms[i : i + 2] for i in range(0, len(terms), 2)]
        terms = [pair[0] if len(pair) == 1 else _plus(*pair) for pair in pairs]
    return terms[0]


def _negated(interval: ir.Interval) -> ir.Interval:
    return ir.Interval(ir.Unary("neg", interval.upper), ir.Unary("neg", interval.lower))


def _plus(a: ir.Interval, b: ir.Interval) -> ir.Interval:
    return ir.Interval(ir.Binary("+", a.lower, b.lower), ir.Binary("+", a.upper, b.upper))


# --------------------------------------------------------------------------------------------------
# A robot family (FRG): an SRG with its accept condition and semantics, in a task's dimension.


@dataclass(frozen=True)
class RobotFamily:
    """A grammar of a program whose derivations are robots in the plane (2) or in space (3).

    ``itself`` says which of their bodies must not touch, ``posed`` whether the orientation of their
    effectors matters, ``payloads`` and ``carries`` what the effectors carry.
    """

    program: ir.Program
    grammar: ir.Grammar
    dimension: Literal[2, 3]
    itself: ir.AvoidSelf | None = None
    posed: bool = False
    payloads: tuple[ir.Payload, ...] = ()
    carries: tuple[ir.Carry, ...] = ()

    @cached_property
    def language(self) -> Language:
        """L(SRG) intersected with L(accept)."""
        return language(self.grammar, self.program.terminals, self.program.modules)

    def with_condition(self, condition: ir.Accept) -> RobotFamily:
        """The robots of the family whose words also satisfy another condition."""
        accept = ir.AllOf((self.grammar.accept, condition))
        return replace(self, grammar=replace(self.grammar, accept=accept))

    @cached_property
    def evaluation_order(self) -> EvaluationOrder:
        """The order in which attributes are evaluated, for all derivations of the grammar."""
        return EvaluationOrder(self.grammar.productions, self.grammar.semantics or {})

    def replay(self, labels: tuple[str, ...]) -> Derivation:
        """The derivation with these labels; BadDerivation if there is none."""
        return replay(self.grammar, labels)

    def built(self, derivation: Derivation) -> RobotModel:
        """The robot of a derivation as its rules build it, before normalisation.

        Raises:
            SemanticsError: the grammar has no semantics, or they define no robot here.
        """
        semantics = self.grammar.semantics or {}
        order = self.evaluation_order
        found = evaluate(derivation, self.program.modules, semantics, self.dimension, order)
        return with_payloads(replace(found, posed=self.posed), self.payloads, self.carries)

    def robot(self, derivation: Derivation) -> RobotModel:
        """The normalised robot of a derivation; raises the errors of ``built``."""
        built = self.built(derivation)
        if self.itself is None:
            return normalise(built)
        return replace(normalise(built), apart=bodies_apart(built, self.itself))


def family_of(program: ir.Program, task: ir.Task) -> RobotFamily:
    """The robot family of a task."""
    workspace = program.workspaces[task.workspace]
    grammar = program.grammars[task.grammar]
    return RobotFamily(
        program, grammar, workspace.dimension, task.avoid_self, bool(asked_poses(task)),
        task.payloads, task.carries,
    )  # fmt: skip
