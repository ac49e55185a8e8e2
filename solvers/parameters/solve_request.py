"""One control synthesis, asked for: where it starts, what is free in it and how hard to try."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256

from compiler.arrays import Array
from solvers.motions.control_problem import FULL, ControlOutcome, Effort
from solvers.motions.path_following import Follower
from solvers.motions.path_timing import Entries
from solvers.motions.trajectory import Trajectory

RADIUS = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class SolveRequest:
    """The arguments of :meth:`Follower.solve`, or of :meth:`Follower.released`.

    Without ``entries`` the follower's own timing is meant; with ``box``, a pair of bounds (p,), the
    parameters are unknowns too.
    """

    start: Trajectory
    entries: Entries | None = None
    box: tuple[Array, Array] | None = None
    effort: Effort = FULL
    radius: float = RADIUS
    released: bool = False

    def outcome(self, follower: Follower) -> ControlOutcome:
        """What the follower makes of it; the same arguments have the same outcome."""
        if self.released:
            entries = follower.waypoints()[1] if self.entries is None else self.entries
            return follower.released(self.start, entries, self.box, self.effort, self.radius)
        return follower.solve(self.start, self.entries, self.box, self.effort, self.radius)

    @property
    def digest(self) -> str:
        """A name for these arguments, the same in every run."""
        plain = (self.entries, self.effort, self.radius, self.released, self.box is None)
        text = sha256(repr(plain).encode())
        for array in (self.start.x, self.start.u, self.start.theta, *(self.box or ())):
            text.update(repr(array.shape).encode() + array.astype("<f8").tobytes())
        return text.hexdigest()
