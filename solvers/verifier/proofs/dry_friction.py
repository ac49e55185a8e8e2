r"""Segments of a tube of a robot with dry friction: joints slide, stick, leave rest, or are open.

Coulomb friction of size c at joint j is a measurable :math:`f_j \in -c_j\,\operatorname{Sgn}(v_j)`.
These efforts are :math:`-\partial\Phi(v)` of the convex :math:`\Phi(v) = \sum_j c_j |v_j|`, so that
two motions under the same inputs obey, with forces and M(q) Lipschitz on a bounded set,

.. math:: \frac{d}{dt}\,(v_1 - v_2)^T M (v_1 - v_2) \le L\,|x_1 - x_2|^2 :

so there is only one motion from each start. Hence it is enough to show that the motions of a smooth
system have the friction of the law:

- **sliding** with sign s: :math:`f_j = -s c_j`, and :math:`s v_j \ge 0` throughout, which holds if
  it is positive at the start and grows where it vanishes;
- **sticking**: :math:`v_j = 0` at the start, the joint is rigid (``sticking_field.py``), holding it
  takes an effort of at most :math:`c_j`, and M with its row and column is regular, too;
- **leaving** rest with sign s: the joint breaks away at some instant, and :math:`s v_j \ge 0` from
  the start. At rest friction balances the effort :math:`p_j` on the joint, or is :math:`-s c_j` if
  that effort is larger; where :math:`s p_j \ge c_j - \delta_j > -c_j` it is
  :math:`f_j \in -s\,[c_j - \delta_j, c_j]`, a disturbance, and the rate does not change its sign;
- **either**: any :math:`|f_j| \le c_j`, a disturbance, for the time that passing through rest or
  coming to rest takes.

Joints S certainly come to rest if friction outweighs all other efforts on them. With a constant
:math:`\Lambda_0` near :math:`\Lambda = ((M^{-1})_{SS})^{-1}` and g the other effort on them,

.. math:: V = v_S^T \Lambda_0 v_S, \qquad
    \dot V = 2 v_S^T (1 + \Delta)(g + f_S) \le -2 \sum_j \delta_j |v_j|, \qquad
    \delta_j = c_j - |g_j| - \sum_i |\Delta_{ji}| (|g_i| + c_i),

with :math:`\Delta = \Lambda_0 \Lambda^{-1} - 1`, so that :math:`v_S = 0` after the time
:math:`\lambda\,|v_S(0)| / \min \delta`, :math:`\lambda` being the largest eigenvalue of
:math:`\Lambda_0`, and from then on.

Source of the uniqueness: Brezis, *Operateurs maximaux monotones* (1973); of the law as an
inclusion: Filippov, *Differential equations with discontinuous righthand sides* (1988).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import SIGNS, absolute, column, identity
from solvers.verifier.proofs.a_priori import Drive
from solvers.verifier.proofs.friction_modes import (
    Leaving,
    Mode,
    Modes,
    Signs,
    freed,
    let_go,
    sign_of,
    sticking,
)
from solvers.verifier.proofs.linearisation import InertiaMatrix
from solvers.verifier.proofs.passage import Accuracy, Passage, longest_passage
from solvers.verifier.proofs.step_control import StepControl
from solvers.verifier.proofs.sticking_field import StickingFields
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import Zonotope

SLICES = 16
"""The parts of a segment in which the modes of the joints are checked."""
MOST_TRIALS = 64
SHORTEST = Fraction(1, 2**30)
"""In steps: the shortest segment that is tried."""
FARTHER = 8
"""If the direction of a joint is unknown, a segment is this many times as long as the rate needs to
change by its own size."""
LET_GO = Fraction(1, 2**12)
"""In steps: how precisely the instant is found at which a joint breaks away."""
MOST_WIDE = 2
"""A joint whose rate is at most this many radii of its set is as near to rest as can be seen."""
ANYTHING = arb(0, arb("inf"))
SPARE = 1.25
"""Estimated times to pass through rest are multiplied by this factor."""


@dataclass(frozen=True, slots=True)
class _Outcome:
    """The part of a segment up to which its modes hold, and the ``joint`` that breaks them there.

    ``instead`` is the joint's next mode, if the effort on it shows it.
    """

    until: Fraction
    joint: int | None = None
    instead: Mode | None = None


@dataclass(frozen=True, slots=True)
class Moved:
    """A segment, its length in steps, the inputs and friction in it, and the signs of rates."""

    length: Fraction
    passage: Passage
    drive: Drive
    signs: Signs


@dataclass(frozen=True, slots=True)
class RubbingRobot:
    """A robot under the inputs of a step; ``drive`` leaves out its dry friction, if it has any.

    Segments are those of ``longest_passage`` with its arguments.
    """

    fields: StickingFields
    drive: Drive
    dt: arb
    accuracy: Accuracy
    control: StepControl

    @property
    def field(self) -> VectorField:
        """The field of the robot whose joints all move."""
        return self.fields.whole

    def next(self, states: Zonotope, rest: Fraction, signs: Signs) -> Moved | None:
        """A segment of at most ``rest`` steps; ``signs`` are those of the segment before."""
        if not self.field.friction:
            found = longest_passage(
                self.field, states, self.drive, self.dt, rest, self.accuracy, self.control
            )
            return None if found is None else Moved(*found, self.drive, {})
        modes, most, limit = self._modes(states, signs), rest, rest
        if "either" in modes.values():
            most = min(rest, self._through_rest(states, modes))
        for _ in range(MOST_TRIALS):
            drive, held = self._driven(modes), sticking(modes)
            field = self.fields.of(held)
            found = longest_passage(
                field, states, drive, self.dt, most, self.accuracy, self.control
            )
            if found is None:
                return None
            length, passage = found
            outcome = self._checked(states, passage, modes, signs)
            if outcome.joint is None:
                stopped, wanted = self._stopped(states, passage, modes)
                if wanted > length and length == most < limit:
                    most = min(limit, wanted)
                    continue
                end = _at_rest(passage.end, held | stopped, field)
                left = {j: mode.sign for j, mode in modes.items() if isinstance(mode, Leaving)}
                return Moved(length, replace(passage, end=end), drive, left)
            before = modes[outcome.joint]
            if outcome.until:
                most = limit = length * outcome.until
            elif length > self._shortest(before) and not self._near_rest(
                states, outcome.joint, modes
            ):
                most = limit = length / SLICES
            else:
                modes, limit = {**modes, outcome.joint: freed(before, outcome.instead)}, rest
                most = rest
                if "either" in modes.values():
                    most = min(rest, self._through_rest(states, modes))
        return None

    def _shortest(self, mode: Mode) -> Fraction:
        """The length of a segment, in steps, below which a joint is given another mode."""
        return LET_GO if mode == "sticking" or isinstance(mode, Leaving) else SHORTEST

    def _modes(self, states: Zonotope, signs: Signs) -> Modes:
        """The likely modes of the joints: those at rest stick unless other efforts move them."""
        hull, n = states.hull(), self.field.dofs
        modes = dict[int, Mode]()
        for joint, _ in self.field.friction:
            rate = hull[n + joint]
            modes[joint] = (
                1 if rate > 0 else -1 if rate < 0 else "sticking" if rate.is_zero() else "either"
            )
        while (loose := self._loosest(hull, modes)) is not None:
            modes[loose[0]] = loose[1]
        for joint, size in self.field.friction:
            if modes[joint] == "either" and joint in signs:
                push = self._push_at_rest(hull, modes, joint)
                mode = let_go(push, size)
                # A joint that comes to rest again is better left without a known sign.
                if mode == signs[joint] or (
                    isinstance(mode, Leaving)
                    and mode.sign == signs[joint]
                    and bool((mode.sign * push).mid() > size.mid())
                ):
                    modes[joint] = mode
        return modes

    def _loosest(self, state: Sequence[arb], modes: Modes) -> tuple[int, Mode] | None:
        """The joint that friction holds least, and its next mode; None if all are held."""
        held = [(joint, size) for joint, size in self.field.friction if modes[joint] == "sticking"]
        if not held:
            return None
        pushes = self._pushes(state, modes)
        loose = [(joint, size) for joint, size in held if not abs(pushes[joint]) <= size]
        if not loose:
            return None
        joint, size = max(loose, key=lambda item: float(abs(pushes[item[0]]) / item[1]))
        return joint, let_go(pushes[joint], size)

    def _pushes(self, state: Sequence[arb], modes: Modes) -> list[arb]:
        """The efforts (n,) that friction balances at the joints that stick: b - M a in each row.

        Unbounded if M may be singular, even if M without the rows of these joints is not.
        """
        held, n = sticking(modes), self.field.dofs
        pull = self._pull(state, modes)
        moving = [arb(0) if i in held else pull[i] for i in range(n)]
        mass, forces = self.field.balance_at(state, self._driven(modes).all)
        try:
            InertiaMatrix(mass).solve(column(forces))
        except ZeroDivisionError:
            return [ANYTHING] * n
        return (column(forces) - mass * column(moving)).entries()

    def _pull(self, state: Sequence[arb], modes: Modes) -> list[arb]:
        """The accelerations (n,) of all states of a box; unbounded if M may be singular."""
        try:
            field = self.fields.of(sticking(modes))
            return field.acceleration(state, self._driven(modes).all)
        except ZeroDivisionError:
            return [ANYTHING] * self.field.dofs

    def _driven(self, modes: Modes) -> Drive:
        """All inputs; friction opposes the motion or is unknown, and is zero at a rigid joint."""
        stated, unknown = list(self.drive.stated), list(self.drive.disturbance)
        for joint, size in self.field.friction:
            mode = modes[joint]
            if isinstance(mode, Leaving):
                stated.append(-mode.sign * (size - mode.spare / 2))
                unknown.append((mode.spare / 2).upper())
                continue
            stated.append(-size * mode if mode in (1, -1) else arb(0))
            unknown.append(size.upper() if mode == "either" else arb(0))
        return Drive(stated, unknown)

    def _checked(self, states: Zonotope, passage: Passage, modes: Modes, signs: Signs) -> _Outcome:
        """Check that the joints keep their assumed modes throughout a segment."""
        n, start = self.field.dofs, states.hull()
        for joint, mode in modes.items():
            sign = sign_of(mode)
            if sign and signs.get(joint) != sign and not start[n + joint] * sign >= 0:
                return _Outcome(Fraction(0), joint)
        for number in range(SLICES):
            ends = (passage.path.length * arb(k) / SLICES for k in (number, number + 1))
            time = next(ends).union(next(ends))
            pairs = zip(passage.path.at(time), passage.moved.radii, strict=True)
            state = [x + SIGNS * r for x, r in pairs]
            for joint in sticking(modes):
                state[n + joint] = arb(0)
            broken = self._broken(state, modes)
            if broken is not None:
                return _Outcome(Fraction(number, SLICES), *broken)
        return _Outcome(Fraction(1))

    def _broken(self, state: Sequence[arb], modes: Modes) -> tuple[int, Mode | None] | None:
        """A joint that may leave its mode in a box of states, and its next mode if known."""
        loose = self._loosest(state, modes)
        if loose is not None:
            return loose
        n, sizes = self.field.dofs, dict(self.field.friction)
        for joint, mode in modes.items():
            sign = sign_of(mode)
            if not sign or state[n + joint] * sign > 0:
                continue
            if isinstance(mode, Leaving):
                push = self._push_at_rest(state, modes, joint)
                least = (sizes[joint] - mode.spare).max(-sizes[joint])
                if not (sign * push > least and sign * push > -sizes[joint]):
                    return joint, let_go(push, sizes[joint])
            elif not state[n + joint] * sign >= 0:
                still = list(state)
                still[n + joint] = arb(0)
                pull = self._pull(still, modes)
                if not pull[joint] * sign > 0:
                    return joint, None
        return None

    def _push_at_rest(self, state: Sequence[arb], modes: Modes, joint: int) -> arb:
        """The effort on a joint if it is at rest and stays there."""
        still = list(state)
        still[self.field.dofs + joint] = arb(0)
        return self._pushes(still, {**modes, joint: "sticking"})[joint]

    def _near_rest(self, states: Zonotope, joint: int, modes: Modes) -> bool:
        """Whether a joint is so near to rest that a shorter segment would not show its mode."""
        place = self.field.dofs + joint
        rate, radius = states.middle[place], states.radii[place]
        if modes[joint] == "sticking" or radius.is_zero():
            return False
        return bool(abs(rate) <= MOST_WIDE * radius)

    def _through_rest(self, states: Zonotope, modes: Modes) -> Fraction:
        """About how many steps joints of unknown mode take to come to rest or pass through it."""
        state, n = states.hull(), self.field.dofs
        try:
            stopping, time = self._time_to_rest(state, state, modes)
        except ZeroDivisionError:
            stopping, time = frozenset(), None
        left = [j for j, mode in modes.items() if mode == "either" and j not in stopping]
        if not left:
            return self._steps(arb(0) if time is None else time)
        pull = self._pull(state, modes)
        rates = {joint: state[n + joint].abs_upper() for joint in left}
        through = [
            rates[joint] / pull[joint].abs_lower()
            for joint in left
            if rates[joint] > 0 and not pull[joint].contains(0)
        ]
        # The unknown part then grows from segment to segment until it decides.
        times = [FARTHER * rates[joint] / pull[joint].abs_upper() for joint in left]
        wanted = min(through, key=float) if through else max(times, key=float)
        return self._steps(wanted if time is None else wanted.max(time))

    def _steps(self, time: arb) -> Fraction:
        """A time in steps, with a margin."""
        steps = float(time / self.dt) * SPARE
        return max(SHORTEST, Fraction(steps)) if math.isfinite(steps) else SHORTEST

    def _stopped(
        self, states: Zonotope, passage: Passage, modes: Modes
    ) -> tuple[frozenset[int], Fraction]:
        """The joints that certainly have come to rest by the end of a segment and were not held.

        The second value is the number of steps after which joints would be at rest; 0 if it is not
        needed or not known.
        """
        path = passage.path
        over = path.at(arb(0).union(path.length))
        box = [x + SIGNS * r for x, r in zip(over, passage.moved.radii, strict=True)]
        for joint in sticking(modes):
            box[self.field.dofs + joint] = arb(0)
        try:
            stopping, time = self._time_to_rest(box, states.hull(), modes)
        except ZeroDivisionError:
            stopping, time = frozenset(), None
        if time is None or not time.is_finite():
            return frozenset(), Fraction(0)
        if bool(time <= path.length):
            return stopping, Fraction(0)
        return frozenset(), self._steps(time)

    def _time_to_rest(
        self, box: Sequence[arb], start: Sequence[arb], modes: Modes
    ) -> tuple[frozenset[int], arb | None]:
        """Joints that friction brings to rest, and within which time; None if this is not certain.

        Args:
            box: all states until then.
            start: the states at the beginning.
            modes: the modes of the joints.
        """
        n, sizes = self.field.dofs, dict(self.field.friction)
        unknown = [joint for joint, mode in modes.items() if mode == "either"]
        mass, _ = self.fields.of(sticking(modes)).balance_at(box, self._driven(modes).all)
        solver = InertiaMatrix(mass)
        while unknown:
            # The other efforts on them: without their own friction, with all friction of the other
            # joints.
            drive = self._driven({**modes, **dict.fromkeys(unknown, "sticking")})
            _, forces = self.fields.of(sticking(modes)).balance_at(box, drive.all)
            pull = solver.solve(column(forces))
            columns = solver.solve(arb_mat([[arb(int(i == j)) for j in unknown] for i in range(n)]))
            mobility = arb_mat([[columns[i, j] for j in range(len(unknown))] for i in unknown])
            near = mobility.mid().inv().mid()
            near = ((near + near.transpose()) / 2).mid()
            off = absolute(near * mobility - identity(len(unknown)))
            push = InertiaMatrix(mobility).solve(column([pull[i, 0] for i in unknown])).entries()
            size = [sizes[joint] for joint in unknown]
            worst = off * column([(abs(g) + c).upper() for g, c in zip(push, size, strict=True)])
            spare = [
                (c - abs(g) - w).lower()
                for c, g, w in zip(size, push, worst.entries(), strict=True)
            ]
            kept = [joint for joint, left in zip(unknown, spare, strict=True) if left > 0]
            if len(kept) == len(unknown):
                heaviest = max(sum(row, arb(0)).upper() for row in absolute(near).tolist())
                fast = sum((start[n + joint].abs_upper() ** 2 for joint in unknown), arb(0)).sqrt()
                least = min(spare, key=float)
                return frozenset(unknown), (heaviest * fast / least).upper()
            unknown = kept
        return frozenset(), None


def _at_rest(states: Zonotope, joints: frozenset[int], field: VectorField) -> Zonotope:
    """The states, with the rates of the given joints set to zero."""
    if not joints:
        return states
    middle, columns = list(states.middle), states.columns.copy()
    for joint in joints:
        middle[field.dofs + joint] = arb(0)
        columns[field.dofs + joint] = 0.0
    return Zonotope(middle, columns)
