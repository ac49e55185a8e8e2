"""Ask and tell: one interface to every method that looks for the largest value in the unit cube.

A search asks for points, is told their values in any order, and goes on from there.  A method only
proposes points and learns values; the bookkeeping that all methods share is here.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_space import Cube, Halton

TRIES = 200
"""So many proposals in a row may be points that are known before others are taken."""


@dataclass(slots=True)
class Record:
    """What a search knows: points (p,) with their values, and points that it waits for."""

    cube: Cube
    points: list[Array] = field(default_factory=list[Array])
    values: list[float] = field(default_factory=list[float])
    pending: list[Array] = field(default_factory=list[Array])

    def best(self) -> int:
        """The index of the largest value, the first of equal ones."""
        return int(np.argmax(self.values))


class Method(Protocol):
    """A way to search.  It begins when the initial points have values."""

    def propose(self, count: int, record: Record) -> list[Array]:
        """At most ``count`` points of the cube; none while it has to wait for pending ones."""
        ...

    def learn(self, point: Array, value: float) -> None:
        """The value of a proposed point; values come in the order of the proposals."""
        ...


@dataclass(slots=True)
class ParameterSearch:
    """Asks for points of the unit cube and is told their values; maximises.

    The first ``initial`` points fill the cube evenly, the others are the method's.  A point is
    never asked for twice: where the method comes back to one, it is told the value that is known.
    What is asked depends on the seed and on what was told, on nothing else.
    """

    cube: Cube
    seed: int
    initial: int
    method: Method
    record: Record = field(init=False)
    _proposed: list[Array] = field(default_factory=list[Array])
    _known: dict[bytes, float] = field(default_factory=dict[bytes, float])
    _drawn: int = 0
    _begun: bool = False
    """Whether all initial points have values."""

    def __post_init__(self) -> None:
        if self.initial < 1:
            raise ValueError("a search begins with one point at least")
        self.record = Record(self.cube)

    @property
    def points(self) -> list[Array]:
        """The points (p,) that have a value, in the order in which they were told."""
        return self.record.points

    @property
    def values(self) -> list[float]:
        """Their values."""
        return self.record.values

    def ask(self, count: int) -> list[Array]:
        """At most ``count`` new points of the cube, all different.

        Fewer where the method has to know the values of those first; none where it waits for values
        of points that were asked before, or where all points are known.

        Raises:
            ValueError: ``count`` is not positive.
        """
        if count < 1:
            raise ValueError("at least one point is to be asked for")
        before = len(self.record.pending)
        for _ in range(TRIES):
            wanted = before + count - len(self.record.pending)
            if wanted == 0 or self._exhausted() or not self._advance(wanted):
                break
        else:
            self._fill(before + count)
        return self.record.pending[before:]

    def tell(self, point: Array, value: float) -> None:
        """The value at a point of the cube, asked for or not.

        Raises:
            ValueError: the value is not finite (whoever evaluates has to grade what is infeasible),
                the point is not one of the cube, or it has another value already.
        """
        point = np.array(point, dtype=float)
        if not np.isfinite(value):
            raise ValueError(f"a search cannot be told {value}")
        if point.shape != (self.cube.dimension,) or not np.all((point >= 0) & (point <= 1)):
            raise ValueError(f"no point of the unit cube: {point}")
        point = self.cube.nearest(point)
        key, record = point.tobytes(), self.record
        if key in self._known:
            if self._known[key] != value:
                raise ValueError(f"two values of one point: {self._known[key]} and {value}")
            return
        self._known[key] = float(value)
        record.pending = [p for p in record.pending if p.tobytes() != key]
        record.points.append(point)
        record.values.append(float(value))
        self._learn()

    # --- what to ask for ------------------------------------------------------------------------

    def _advance(self, wanted: int) -> bool:
        """Take points of the initial design, then of the method; False while that has to wait."""
        record = self.record
        if self._drawn < self.initial:
            self._new(self._draw())
            return True
        self._begun = self._begun or not record.pending
        if not self._begun:
            return False
        proposals = self.method.propose(wanted, record)
        if not proposals:
            if record.pending:
                return False
            self._new(self._draw())
            return True
        for raw in proposals:
            self._proposed.append(raw)
            self._new(raw)
        self._learn()
        return True

    def _draw(self) -> Array:
        """The next point of the sequence that fills the cube."""
        self._drawn += 1
        sequence = Halton(self.cube.dimension, self.seed)
        return np.asarray(sequence.points(self._drawn - 1, self._drawn)[0])

    def _fill(self, total: int) -> None:
        """Points of the sequence instead of a method that keeps coming back to known ones."""
        for _ in range(TRIES):
            if len(self.record.pending) >= total or self._exhausted():
                break
            self._new(self._draw())

    def _new(self, raw: Array) -> None:
        """Ask for a point, unless it is asked for already or known."""
        point = self.cube.nearest(raw)
        key = point.tobytes()
        if key not in self._known and all(p.tobytes() != key for p in self.record.pending):
            self.record.pending.append(point)

    def _exhausted(self) -> bool:
        """Whether every point is known or asked for."""
        size = self.cube.size
        return size is not None and len(self._known) + len(self.record.pending) >= size

    def _learn(self) -> None:
        """Tell the method the values of its proposals, in their order, as far as all are known."""
        while self._proposed:
            key = self.cube.nearest(self._proposed[0]).tobytes()
            if key not in self._known:
                break
            self.method.learn(self._proposed.pop(0), self._known[key])
