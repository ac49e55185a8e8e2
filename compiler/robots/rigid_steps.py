"""Frames that carry something, with the rigid steps between their joints merged."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from compiler.expressions.scalars import ScalarTable
from compiler.robots.robot import WORLD, FrameNode, Offset, RobotModel, Step, Turn


def with_rigid_steps_merged(model: RobotModel) -> RobotModel:
    """The model with only the frames on the way to an item, neighbouring rigid steps merged."""
    table = ScalarTable()
    for node in model.scalars:
        table.add(node)
    rebuilder = _Rebuilder(model, table)
    bodies = tuple(replace(body, frame=rebuilder.frame(body.frame)) for body in model.bodies)
    effectors = tuple(rebuilder.frame(frame) for frame in model.effectors)
    return replace(
        model,
        frames=tuple(rebuilder.frames),
        scalars=tuple(table.nodes),
        bodies=bodies,
        effectors=effectors,
    )


@dataclass(slots=True)
class _Chain:
    """A last step behind the rest of a chain; ``frame`` is its new frame once it is needed.

    Chains share their beginnings.  A chain without a step is the world.
    """

    rest: _Chain | None
    step: Step | None
    frame: int | None = None


@dataclass(slots=True)
class _Rebuilder:
    """Rebuilds the frames that are used, each once."""

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
        """The chain of an old frame, from the nearest one that is known."""
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
        """A chain with a step behind it, merged with the last one where both are of one sort."""
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
        """A merged step behind the rest of a chain; nothing where the two have cancelled."""
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
