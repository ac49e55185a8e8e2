"""Random closed loops of planar chains stay in their tubes, at samples and between.

The robot is written out by hand (``planar_chain``), SciPy's method of order 8 integrates it, from
event to event where joints rub (``rubbing_chain``), and the law is applied by hand: nothing is
shared with the proof.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.dynamics.rubbing_joints import with_dry_friction
from compiler.expressions.evaluators.balls import ball, constant_ball, working_precision
from compiler.expressions.tape import tape
from grammar_lang import ir
from solvers.verifier.proofs.control_law import ControlLaw, InputError, sampled_law
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, TubeSegment, tube
from solvers.verifier.proofs.vector_field import Curvature, VectorField
from solvers.verifier.proofs.zonotope import InitialSet
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import rod_chain
from tests.oracles.rubbing_chain import RubbingChain
from tests.oracles.some_cases import campaign, some

ACCURACY = Accuracy(order=12, bits=64, remainder=1e-9)
STEPS, PIECES, MOTIONS = 6, 3, 4
CLOSE = 1e-9
"""What the integration of the oracle may be off by, in SI."""
SLOW_LOOPS = 200


def rational(values: Array) -> list[Fraction]:
    return [Fraction(round(1e6 * value), 10**6) for value in np.ravel(values).tolist()]


@dataclass(frozen=True)
class Loop:
    """A chain that holds a pose, with disturbances of all kinds."""

    lengths: list[Fraction]
    pull: list[Fraction]
    start: list[Fraction]
    inputs: list[list[Fraction]]
    gains: list[list[Fraction]]
    step: Fraction
    radii: list[Fraction]
    noise: list[Fraction]
    part: Fraction
    most: list[Fraction]
    mass: Fraction
    friction: list[Fraction]


def loop_of(rng: np.random.Generator, *, rubs: bool = False) -> Loop:
    n = int(rng.integers(1, 4))
    lengths, pull = rng.uniform(0.6, 1.4, n), rng.uniform(-9.81, 9.81, 2)
    start = np.concatenate([rng.uniform(-1.5, 1.5, n), rng.uniform(-0.4, 0.4, n)])
    mass, _, gravity = chain_dynamics(lengths, np.ones(n), start[:n], start[n:], pull.tolist())
    stiff = rng.uniform(4, 36)
    damped = 2 * np.sqrt(stiff) * rng.uniform(0.5, 1.2)
    gains = np.hstack([stiff * mass, damped * mass])
    inputs = gravity + rng.uniform(-0.5, 0.5, (STEPS, n))
    # How feedback pushes against what was misread is to be less than friction, mostly.
    size = 10.0 ** (rng.uniform(-7, -3) if rubs else rng.uniform(-4, -1.5))
    disturbed = rng.uniform(0, size, 2 * n), rng.uniform(0, 0.3 * size, 2 * n)
    friction = np.zeros(n)
    if rubs:
        # Some joints are at rest at first, some without friction, some without any disturbance.
        friction = rng.uniform(0.02, 0.6, n) * (rng.uniform(size=n) < 0.8)
        still = np.flatnonzero(rng.uniform(size=n) < 0.4)
        start[n + still] = disturbed[0][n + still] = 0.0
    return Loop(
        rational(lengths), rational(pull), rational(start), [rational(row) for row in inputs],
        [rational(row) for row in gains], Fraction(int(rng.integers(2, 7)), 100),
        rational(disturbed[0]), rational(disturbed[1]), rational(rng.uniform(0, size, 1))[0],
        rational(rng.uniform(0, size, n)), rational(rng.uniform(0, size, 1))[0],
        rational(friction),
    )  # fmt: skip


def segments_of(loop: Loop, *, absolute: bool) -> tuple[RobotGraph, list[TubeSegment]]:
    """The tube; its end may be missing, where no enclosure goes on."""
    model = rod_chain(len(loop.lengths))
    n = len(loop.lengths)
    sizes = [ir.Num(size) if size else None for size in loop.friction]
    dofs = (replace(dof, coulomb=size) for dof, size in zip(model.dofs, sizes, strict=True))
    model = replace(model, dofs=tuple(dofs))
    pull = loop.pull[0], loop.pull[1]
    own = robot_graph(model, pull, absolute_angles(model) if absolute else None)
    graph = with_dry_friction(own.holding_inputs.weighed([range(len(model.bodies))]))
    law = ControlLaw((tuple(loop.start),) * STEPS, (tuple(map(tuple, loop.gains)),) * STEPS)
    found: list[TubeSegment] = []
    with working_precision(ACCURACY.bits):
        tail = (*map(ball, loop.lengths), *map(constant_ball, graph.constants))
        field = VectorField(
            tape(graph.balance), tape(graph.variation), n, tail, n + 1,
            tape(graph.input_slopes), Curvature.of(graph),
            friction=tuple((i, ball(size)) for i, size in enumerate(loop.friction) if size),
        )  # fmt: skip
        rows = graph.coordinates.rows
        held = sampled_law(law, loop.inputs, rows, loop.noise, (), 0)
        state = [ball(x) for part in (loop.start[:n], loop.start[n:])
                 for x in graph.coordinates.solved_for(part)]  # fmt: skip
        state += [arb(0)] * n + [arb(1)]
        columns = []
        for number in range(2 * n):
            unit = [Fraction(int(i == number % n)) for i in range(n)]
            moved, none = list(graph.coordinates.solved_for(unit)), [Fraction(0)] * n
            columns.append([*(moved + none if number < n else none + moved), *none, Fraction(0)])
        columns.append([Fraction(int(i == 3 * n)) for i in range(3 * n + 1)])
        initial = InitialSet(
            tuple(state),
            tuple(tuple(ball(column[i]) for column in columns) for i in range(3 * n + 1)),
            tuple(map(ball, (*loop.radii, loop.mass))),
        )
        error = InputError((ball(loop.part),) * len(loop.most), tuple(map(ball, loop.most)))
        made = tube(field, initial, held.inputs, ball(loop.step), ACCURACY, error, held)
        with suppress(EnclosureFailure):
            found.extend(made)
    return graph, found


def check(loop: Loop, graph: RobotGraph, found: list[TubeSegment], rng: np.random.Generator) -> int:
    """Motions at corners and at random are in the tube; how many instants were looked at."""
    n, dt = len(loop.lengths), float(loop.step)
    lengths, pull = np.array(loop.lengths, float), [float(x) for x in loop.pull]
    start, gains = np.array(loop.start, float), np.array(loop.gains, float)
    radii, noise = np.array(loop.radii, float), np.array(loop.noise, float)
    most, back = np.array(loop.most, float), np.linalg.inv(np.array(graph.coordinates.rows, float))
    seen = 0
    for number in range(MOTIONS):

        def signs(count: int, corner: bool = number % 2 == 0) -> Array:
            return rng.choice((-1.0, 1.0), count) if corner else rng.uniform(-1, 1, count)

        factor = 1 + float(loop.mass) * float(signs(1)[0])
        rubbing = RubbingChain(lengths, pull, np.array(loop.friction, float) / factor)
        state = start + radii * signs(2 * n)
        for k, planned in enumerate(np.array(loop.inputs, float)):
            u = planned - gains @ (state + noise * signs(2 * n) - start)
            for piece in range(PIECES):
                push = (u + (float(loop.part) * np.abs(u) + most) * signs(n)) / factor

                def slope(_: float, x: Array, push: Array = push) -> Array:
                    mass, turned, weight = chain_dynamics(lengths, np.ones(n), x[:n], x[n:], pull)
                    return np.concatenate([x[n:], np.linalg.solve(mass, push - turned - weight)])

                if any(loop.friction):
                    state = rubbing.moved(state, push, dt / PIECES)
                else:
                    reached = solve_ivp(
                        slope, (0, dt / PIECES), state, "DOP853", rtol=1e-12, atol=1e-13
                    )
                    state = reached.y[:, -1]
                share = k + Fraction(piece + 1, PIECES)
                seen += _inside(loop, graph, found, share, state, back)
    return seen


def _inside(
    loop: Loop, graph: RobotGraph, found: list[TubeSegment], share: Fraction, state: Array,
    back: Array,
) -> int:  # fmt: skip
    n, seen = len(loop.lengths), 0
    turned = np.concatenate([back @ state[:n], back @ state[n:]])
    for segment in found:
        if not segment.steps[0] <= share <= segment.steps[1]:
            continue
        seen += 1
        with working_precision(ACCURACY.bits):
            tau = ball((share - segment.steps[0]) * loop.step)
            for item, value in zip(segment.at(tau), turned.tolist(), strict=False):
                assert abs(value - float(item.mid())) <= float(item.rad()) + CLOSE
            if segment.spread is None:
                continue
            # What is said of sums of entries is closer, and true as well.
            for i, row in enumerate(graph.coordinates.rows):
                rest = [0] * (n + 1)
                for weights, value in (
                    ([*row, *[0] * n, *rest], state[i]),
                    ([*[0] * n, *row, *rest], state[n + i]),
                ):
                    item = segment.spread.value(weights, tau)
                    assert abs(float(value) - float(item.mid())) <= float(item.rad()) + CLOSE
    return seen


def trial(seed: int, *, rubs: bool = False) -> bool:
    """Whether the tube of a random loop was complete; all that there is of it holds."""
    rng = np.random.default_rng([22, seed])
    loop = loop_of(rng, rubs=rubs)
    graph, found = segments_of(loop, absolute=not rubs and seed % 2 == 0)
    seen = check(loop, graph, found, rng)
    complete = bool(found) and found[-1].steps[1] == STEPS
    assert seen >= MOTIONS * STEPS * PIECES or not complete
    return complete


@pytest.mark.parametrize("seeds", some([((8, 3, 0),), ((1, 2, 4),)], 1))
def test_some_random_closed_loops(seeds: tuple[int, ...]) -> None:
    """Of one, two, and three links; the first and the last in coordinates of their own."""
    assert all(trial(seed) for seed in seeds)


@pytest.mark.parametrize("part", campaign(range(4), 1))
def test_two_hundred_random_closed_loops(part: int) -> None:
    count = SLOW_LOOPS // 4
    assert sum(trial(100 + count * part + k) for k in range(count)) >= 0.6 * count


@pytest.mark.parametrize("seed", some(range(12), 3))
def test_some_random_loops_with_dry_friction(seed: int) -> None:
    """Joints start to move, pass through rest, and come to rest for good."""
    trial(seed, rubs=True)


@pytest.mark.slow
def test_fifty_random_loops_with_dry_friction() -> None:
    count = 50
    assert sum(trial(100 + seed, rubs=True) for seed in range(count)) >= 0.6 * count
