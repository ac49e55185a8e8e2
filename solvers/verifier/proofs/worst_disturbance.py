r"""Find the worst disturbance: the corner to which a linear estimate in floats points.

Along a simulated motion the sensitivities of state and commanded inputs to all errors are followed:

.. math:: S_{k+1} = \frac{\partial \Phi_k}{\partial z}\, S_k, \qquad z = (x, u),

with the errors of step k as new columns, and the law's rows -K S for the inputs that are held.  A
distance g from a violation then changes by at most the sum of the entries of |dg/dx S|, with each
error at one end of its range.  Nothing is proved here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import casadi as ca
import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.robots.state_and_input import InputBound, input_bounds
from solvers.verifier.proofs.effort_bounds import bound_name
from solvers.verifier.proofs.end_conditions import (
    at_instant,
    end_positions,
    final_rates,
    rates_name,
)
from solvers.verifier.proofs.instant_conditions import position_conditions, state_limits
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.scene import Motion, Scene
from solvers.verifier.proofs.single_disturbance import (
    Disturbance,
    DisturbedMotion,
    ErrorSizes,
    Signs,
    disturbed,
    law_of,
)
from solvers.verifier.proofs.state_limits import StateLimit
from solvers.verifier.proofs.tube_checks import Constraint
from solvers.verifier.proofs.tube_proof import DrivenRobot, driven_robot

SUBSTEPS = 4
"""Runge-Kutta substeps per step of the task."""
NUDGE = 1e-6
"""The step of finite differences, in SI units."""


# --- The distance of a state from a violation -----------------------------------------------------


Distance = Callable[[Sequence[arb], Slice], float]
"""A function of a state and of the positions of its points."""


@dataclass(frozen=True, slots=True)
class _Placed:
    """The distance of points from a violation."""

    condition: Constraint

    def __call__(self, _: Sequence[arb], at: Slice) -> float:
        return float(self.condition.bound(at)[1].mid())


@dataclass(frozen=True, slots=True)
class _Stated:
    """The distance of coordinates or rates from a violation."""

    limit: StateLimit

    def __call__(self, state: Sequence[arb], _: Slice) -> float:
        return float(self.limit.gap(state).mid())


@dataclass(frozen=True)
class Distances:
    """The distances of a motion from violations, by the names of the conditions."""

    robot: DrivenRobot
    wanted: Callable[[str], bool]

    @cached_property
    def always(self) -> dict[str, Distance]:
        """The distances that count at every instant."""
        scene, found = self.robot.scene, dict[str, Distance]()
        for item in position_conditions(scene, self.robot.tail):
            found[item.name] = _Placed(item)
        for limit in state_limits(scene, self.robot.field.size):
            found[limit.name] = _Stated(limit)
        return {name: of for name, of in found.items() if self.wanted(name)}

    @cached_property
    def at_end(self) -> dict[str, Distance]:
        """The distances that count only at the end."""
        scene, effector = self.robot.scene, self.robot.motion.effector
        found, reach = dict[str, Distance](), scene.task.reach
        if reach is None or scene.task.repeat:
            return found
        for item in end_positions(scene, effector):
            found[item.name] = _Placed(item)
        if reach.rates is not None:
            found[rates_name(reach.rates)] = _Stated(final_rates(scene.graph, reach.rates))
        return {name: of for name, of in found.items() if self.wanted(name)}

    @cached_property
    def efforts(self) -> dict[str, InputBound]:
        """The bounds of commanded inputs, by name; an open loop commands the stated inputs."""
        scene = self.robot.scene
        bounds = {bound_name(bound): bound for bound in input_bounds(scene.model, scene.task)}
        return {name: bound for name, bound in bounds.items() if self.wanted(name)}

    def of(self, state: Array, *, last: bool) -> dict[str, float]:
        """The distances in a state (N,); at the end, including those that count only there."""
        balls = [arb(x) for x in state.tolist()]
        at = at_instant(self.robot.point_map.positions(balls), 0.0)
        asked = self.always | self.at_end if last else self.always
        return {name: of(balls, at) for name, of in asked.items()}

    def of_inputs(self, row: Array) -> dict[str, float]:
        """The distances of commanded inputs, (m,), from their bounds."""
        return {name: _gap(bound, row) for name, bound in self.efforts.items()}

    def slopes(self, state: Array, *, last: bool) -> tuple[dict[str, float], dict[str, Array]]:
        """The distances in a state and their derivatives in coordinates and rates, (2n,) each."""
        here, count = self.of(state, last=last), 2 * self.robot.field.dofs
        slopes = {name: np.zeros(count) for name in here}
        for i in range(count):
            moved = state.copy()
            moved[i] += NUDGE
            for name, value in self.of(moved, last=last).items():
                slopes[name][i] = (value - here[name]) / NUDGE
        return here, slopes


def _gap(bound: InputBound, row: Array) -> float:
    own = row[list(bound.inputs)]
    if bound.norm2:
        return float(bound.upper) - float(np.linalg.norm(own))
    return float(min(own.min() - float(bound.lower), float(bound.upper) - own.max()))


# --- A motion with its sensitivities --------------------------------------------------------------


@dataclass(frozen=True)
class Course:
    """A simulated motion, as far as it is finite.

    Attributes:
        samples: the states at the samples, with held inputs and factors of masses, (N,) each.
        fine: the same states and those between them.
        spread: how errors move the samples, each error times its size, (N, e) each.
        commanded: the inputs that are commanded, (m,) each.
        moved: how errors move the commanded inputs, (m, e) each.
        whole: whether the simulation reaches the end.
    """

    samples: list[Array]
    fine: list[Array]
    spread: list[Array]
    commanded: list[Array]
    moved: list[Array]
    whole: bool


def course(scene: Scene, of: DisturbedMotion, sizes: ErrorSizes) -> Course:
    """Simulate a disturbed motion; columns of its spread are ordered as in :func:`flat`."""
    robot = driven_robot(scene, of.motion, factors=of.masses)
    law = law_of(of.motion)
    n, m, p = robot.field.dofs, len(sizes.most), len(of.masses)
    z = np.array([float(item) for item in robot.state])
    held = slice(len(z) - p - m, len(z) - p)
    rows = np.array(robot.graph.coordinates.rows, float).reshape(n, n)
    turn = np.block([[rows, np.zeros((n, n))], [np.zeros((n, n)), rows]])
    noise, most, part = (np.array(e, float) for e in (sizes.noise, sizes.most, sizes.part))
    steps = len(of.motion.inputs)
    spread = np.zeros((len(z), 2 * n + p + steps * (2 * n + m)))
    spread[: 2 * n, : 2 * n] = np.linalg.solve(turn, np.diag(np.array(sizes.start, float)))
    spread[len(z) - p :, 2 * n : 2 * n + p] = np.diag(np.array(sizes.masses, float))
    step = _Step(robot, float(scene.task.step))
    found = Course([z], [z], [spread], [], [], whole=False)
    with np.errstate(all="ignore"):
        for k in range(steps):
            gain = np.array(law.gains[k], float).reshape(m, 2 * n)
            deviation = turn @ z[: 2 * n] - np.array(law.reference[k], float)
            turns = law.turned(k)
            deviation[: len(turns)] -= 2 * np.pi * np.array(turns)
            factor = np.array(of.factor[k], float)
            z, spread = z.copy(), spread.copy()
            z[held] = np.array(of.motion.inputs[k], float) - gain @ deviation
            spread[held] = -gain @ turn @ spread[: 2 * n]
            first = 2 * n + p + k * (2 * n + m)
            spread[held, first : first + 2 * n] = -gain * noise
            commanded = (z[held] - np.array(of.added[k], float)) / factor
            found.commanded.append(commanded)
            found.moved.append(spread[held] / factor[:, None])
            pushed = np.diag(part * np.abs(commanded) + most)
            spread[held, first + 2 * n : first + 2 * n + m] = pushed
            between, slope = step.along(z)
            if not (np.isfinite(between).all() and np.isfinite(slope).all()):
                return found
            z, spread = between[-1], slope @ spread
            found.samples.append(z)
            found.fine.extend(between)
            found.spread.append(spread)
    return Course(found.samples, found.fine, found.spread, found.commanded, found.moved, whole=True)


class _Step:
    """The Runge-Kutta method of order 4 over one step, for a state and its neighbours at once."""

    def __init__(self, robot: DrivenRobot, seconds: float) -> None:
        self.n, self.size, self.length = robot.field.dofs, robot.field.size, seconds / SUBSTEPS
        graph, tail = robot.graph, [float(item) for item in robot.tail]
        count = self.size + 1
        self.acceleration = graph.acceleration.map(count)
        split = len(graph.model.parameters)
        self.added = ca.DM.zeros(graph.parts.u.numel(), count)
        self.theta, self.k = (
            ca.repmat(ca.DM(part), 1, count) for part in (tail[:split], tail[split:])
        )

    def along(self, z: Array) -> tuple[list[Array], Array]:
        """The states after each substep, (N,) each, and the derivative (N, N) of the last one."""
        x = np.column_stack([z, z[:, None] + NUDGE * np.eye(self.size)])
        found = []
        for _ in range(SUBSTEPS):
            h = self.length
            a = self._rate(x)
            b = self._rate(x + h / 2 * a)
            c = self._rate(x + h / 2 * b)
            x = x + h / 6 * (a + 2 * b + 2 * c + self._rate(x + h * c))
            found.append(x[:, 0])
        return found, (x[:, 1:] - x[:, :1]) / NUDGE

    def _rate(self, x: Array) -> Array:
        n = self.n
        pull = self.acceleration(x[:n], x[n:], self.added, self.theta, self.k)
        return np.vstack([x[n : 2 * n], np.asarray(pull, dtype=np.float64)])


# --- The worst corner -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Estimate:
    """The estimated least distance to a violation of one condition, and the disturbance for it."""

    name: str
    least: float
    signs: Disturbance


def nearest(seen: Course, distances: Distances) -> float:
    """The least distance along a simulated motion; infinite if there are no conditions."""
    found, last = inf, len(seen.fine) - 1
    for number, state in enumerate(seen.fine):
        values = distances.of(state, last=seen.whole and number == last)
        found = min([found, *values.values()])
    for row in seen.commanded:
        found = min([found, *distances.of_inputs(row).values()])
    return found


def estimates(
    seen: Course, distances: Distances, about: Disturbance, sizes: ErrorSizes
) -> list[Estimate]:
    """For each condition, the worst disturbance by a linear estimate about another disturbance."""
    best: dict[str, tuple[float, Array]] = {}
    signs = flat(about, seen)

    def keep(name: str, value: float, slope: Array) -> None:
        least = value - float(np.abs(slope).sum()) - float(slope @ signs[: len(slope)])
        if np.isfinite(least) and (name not in best or least < best[name][0]):
            best[name] = least, slope

    last = len(seen.samples) - 1
    for number, (state, spread) in enumerate(zip(seen.samples, seen.spread, strict=True)):
        values, slopes = distances.slopes(state, last=seen.whole and number == last)
        for name, slope in slopes.items():
            keep(name, values[name], slope @ spread[: len(slope)])
    for row, moved in zip(seen.commanded, seen.moved, strict=True):
        for name, value in distances.of_inputs(row).items():
            slope = np.array(
                [
                    (distances.of_inputs(row + nudge)[name] - value) / NUDGE
                    for nudge in NUDGE * np.eye(len(row))
                ]
            )
            keep(name, value, slope @ moved)
    found = [
        Estimate(name, least, _corner(-slope, seen, about, sizes))
        for name, (least, slope) in best.items()
    ]
    return sorted(found, key=lambda each: each.least)


def flat(signs: Disturbance, seen: Course) -> Array:
    """The entries of a disturbance in the order of the columns of a spread, (e,)."""
    rows = [
        [*misread, *pushed] for misread, pushed in zip(signs.misread, signs.pushed, strict=True)
    ]
    found = np.array([*signs.start, *signs.masses, *(x for row in rows for x in row)], float)
    return found[: seen.spread[0].shape[1]]


def _corner(towards: Array, seen: Course, about: Disturbance, sizes: ErrorSizes) -> Disturbance:
    """The corner in a direction; an error without effect stays at zero."""
    ends = iter(np.sign(towards).astype(int).tolist())

    def signs(bounds: Sequence[object]) -> Signs:
        return tuple(end if bound else 0 for bound, end in zip(bounds, ends, strict=False))

    start, masses = signs(sizes.start), signs(sizes.masses)
    misread, scaled, pushed = [], [], []
    for k in range(len(about.pushed)):
        misread.append(signs(sizes.noise))
        pushed.append(
            signs([part or most for part, most in zip(sizes.part, sizes.most, strict=True)])
        )
        command = np.sign(seen.commanded[k]).astype(int).tolist() if k < len(seen.commanded) else []
        scaled.append(
            tuple(a * b for a, b in zip(pushed[-1], command, strict=True))
            if command
            else (0,) * len(pushed[-1])
        )
    return Disturbance(start, masses, tuple(misread), tuple(scaled), tuple(pushed))


# --- Disturbances worth a proof -------------------------------------------------------------------


MOST_CONDITIONS = 4
"""The most open conditions that are examined: those that a linear estimate violates most."""
ROUNDS = 3
"""How often the estimate is repeated about the disturbance that it found."""


def harmful(
    scene: Scene,
    motion: Motion,
    sizes: ErrorSizes,
    none: Disturbance,
    wanted: Callable[[str], bool],
    tick: Callable[[], None],
) -> Iterator[DisturbedMotion]:
    """Disturbed motions of an unrolled one that violate a wanted condition in a simulation."""
    first = disturbed(motion, sizes, none)
    seen = course(scene, first, sizes)
    robot = driven_robot(scene, first.motion, factors=first.masses)
    if nearest(seen, Distances(robot, wanted)) < 0:
        yield first
    for each in estimates(seen, Distances(robot, wanted), none, sizes)[:MOST_CONDITIONS]:
        guess, distances = each, Distances(robot, each.name.__eq__)
        for _ in range(ROUNDS):
            tick()
            moved = disturbed(motion, sizes, guess.signs)
            there = course(scene, moved, sizes)
            if nearest(there, distances) < 0:
                yield moved
                break
            closer = estimates(there, distances, guess.signs, sizes)
            if not closer or closer[0].signs == guess.signs:
                break
            guess = closer[0]
