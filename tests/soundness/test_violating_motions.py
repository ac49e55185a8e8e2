"""What is called a violation by a disturbed motion is one; no sound closed loop is refuted.

Robots and laws are random.  SciPy's method of order 8 integrates the motions of robots that are
written out by hand (``planar_chain``), and the law is applied by hand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.scene import UNWATCHED, Motion, Scene, scene_of
from solvers.verifier.proofs.single_disturbance import (
    Disturbance,
    disturbed,
    error_sizes,
    undisturbed,
    unrolled,
)
from solvers.verifier.proofs.trajectory_proof import ACCURACIES, prove_motion
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.violating_motion import conditions_of, with_violation
from solvers.verifier.proofs.worst_disturbance import harmful
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.some_cases import examples

STEPS, FINE, CORNERS = 6, 6, 12
CLOSE = 1e-8
"""What the oracle may be off by, in SI."""
FEW = (0, 13, 2)
"""Loops of the usual suite: of a link, two links, and a link; one for each kind of limit."""
EFFORT, RANGE, RATE = "effort (N*m)", "range of", "rate of"
SPEC = """
module B {{ role base; }}
module J {{ role joint;
  dof q: revolute z in [-{angle}, {angle}] rad rate in [-{rate}, {rate}] rad/s; }}
{links}
module E {{ role effector; }}
edge eps;
grammar Arm {{
  start N; base: N -> B; turn: N -> N eps J; hand: N -> N eps E; {productions}
}}
semantics Arm {{
  base {{ this.frame = world; }}
  turn {{ this.frame = N.frame * rot(z, J.q); }}
  hand {{ this.frame = N.frame; effector(frame: N.frame); }}
  {bodies}
}}
workspace W {{
  plane xy; bounds box [-9, 9] x [-9, 9] m; region Begin box [-9, 9] x [-9, 9] m;
  target End box [-9, 9] x [-9, 9] m;
}}
task P {{
  robot Arm; workspace W; start in Begin rates <= 9; reach End;
  gravity ({pull[0]}, {pull[1]}) m/s^2;
  effort <= {effort} N*m; horizon {steps} steps of {step} s; control feedback;
  robust start {start[0]} rad, {start[1]} rad/s; robust measure {noise[0]} rad, {noise[1]} rad/s;
  robust effort {part} %; robust effort {push} % of bound; robust mass {mass} %;
}}
"""


def decimals(values: Array) -> list[Fraction]:
    return [Fraction(round(1e6 * value), 10**6) for value in np.ravel(values).tolist()]


def text(value: Fraction) -> str:
    return f"{float(value):.12f}"


@dataclass(frozen=True)
class Limits:
    """Of coordinates and rates of all joints, and of efforts."""

    angle: Fraction = Fraction(6)
    rate: Fraction = Fraction(50)
    effort: Fraction = Fraction(200)


class RandomLoop:
    """A chain that holds a pose against its weight, with disturbances of all kinds."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([23, seed])
        self.n = n = int(rng.integers(1, 4))
        self.lengths, self.pull = (
            decimals(rng.uniform(0.6, 1.4, n)),
            decimals(rng.uniform(-9, 9, 2)),
        )
        state = np.concatenate([rng.uniform(-1.5, 1.5, n), rng.uniform(-0.4, 0.4, n)])
        mass, _, weight = self.dynamics(state, 1.0)
        stiff = rng.uniform(4, 36)
        gains = np.hstack([stiff * mass, 2 * np.sqrt(stiff) * rng.uniform(0.5, 1.2) * mass])
        inputs = [decimals(weight + rng.uniform(-0.5, 0.5, n)) for _ in range(STEPS)]
        size = 10.0 ** rng.uniform(-3.5, -1.7)
        self.start, self.noise = (decimals(rng.uniform(0, size * part, 2)) for part in (1, 0.3))
        # In per cent: of 200 N*m, of all masses, of what is commanded.
        self.push, self.mass, self.part = decimals(rng.uniform(0, size, 3) * [0.5, 100, 100])
        self.step = Fraction(int(rng.integers(2, 7)), 100)
        begin = decimals(state)
        gain = [decimals(row) for row in gains]
        law = ControlLaw((tuple(begin),) * STEPS, (tuple(map(tuple, gain)),) * STEPS)
        self.motion = Motion((), tuple(begin), tuple(map(tuple, inputs)), 0, (), law)

    def dynamics(self, x: Array, factor: float) -> tuple[Array, Array, Array]:
        n, pull = self.n, [float(value) for value in self.pull]
        lengths = np.array(self.lengths, float)
        return chain_dynamics(lengths, factor * np.ones(n), x[:n], x[n:], pull)

    def scene(self, folder: Path, limits: Limits) -> Scene:
        # The error of efforts stays what it is when their bound changes.
        push = self.push * 200 / limits.effort
        names = range(self.n)
        spec = SPEC.format(
            angle=text(limits.angle), rate=text(limits.rate), effort=text(limits.effort),
            links="\n".join(
                f"module L{i} {{ role link; const length = {text(self.lengths[i])} m; "
                "const density = 1 kg/m; }" for i in names
            ),
            productions=" ".join(f"l{i}: N -> N eps L{i};" for i in names),
            bodies="\n".join(
                f"l{i} {{ this.frame = N.frame * move(x, L{i}.length); "
                f"rod(frame: N.frame, axis: x, length: L{i}.length, density: L{i}.density); }}"
                for i in names
            ),
            pull=[text(x) for x in self.pull], steps=STEPS, step=text(self.step),
            start=[text(x) for x in self.start], noise=[text(x) for x in self.noise],
            part=text(self.part), push=text(push), mass=text(self.mass),
        )  # fmt: skip
        path = folder / "spec.srg"
        path.write_text(spec, encoding="utf-8")
        program = load(path).program
        assert program is not None
        task = program.tasks["P"]
        family = family_of(program, task)
        labels = [label for i in reversed(names) for label in (f"l{i}", "turn")]
        derivation = family.replay(("hand", *labels, "base"))
        cells = abstract(program.workspaces["W"])
        return scene_of(program, task, family.robot(derivation), cells, derivation)

    # --- the oracle -----------------------------------------------------------------------------

    def corners(self, rng: np.random.Generator) -> list[Disturbance]:
        """Corners at random; every other one has errors that stay the same all the time."""

        def signs(*shape: int, steady: bool) -> list[tuple[int, ...]]:
            rows = rng.choice((-1, 1), shape)
            return [
                tuple(row.tolist())
                for row in (np.tile(rows[0], (len(rows), 1)) if steady else rows)
            ]

        found = []
        for number in range(CORNERS):
            steady = number % 2 == 0
            (start,), (mass,) = signs(1, 2 * self.n, steady=steady), signs(1, 1, steady=steady)
            misread = signs(STEPS, 2 * self.n, steady=steady)
            pushed = signs(STEPS, self.n, steady=steady)
            scaled = signs(STEPS, self.n, steady=steady)
            found.append(Disturbance(start, mass, tuple(misread), tuple(scaled), tuple(pushed)))
        return found

    def largest(self, signs: Disturbance) -> dict[str, float]:
        """The largest coordinate, rate and commanded effort of a motion with these errors."""
        n, dt, law = self.n, float(self.step), self.motion.law
        assert law is not None
        start, noise = (np.repeat(np.array(each, float), n) for each in (self.start, self.noise))
        factor = 1 + float(self.mass) / 100 * signs.masses[0]
        push = 200 * float(self.push) / 100
        begin = np.array(self.motion.state, float)
        state, states, commanded = begin + start * np.array(signs.start), [], [np.zeros(n)]
        states.append(state)
        for k, planned in enumerate(np.array(self.motion.inputs, float)):
            seen = state + noise * np.array(signs.misread[k])
            u = planned - np.array(law.gains[k], float) @ (seen - begin)
            commanded.append(u)
            torque = u * (1 + float(self.part) / 100 * np.array(signs.scaled[k]))
            torque = torque + push * np.array(signs.pushed[k])

            def slope(_: float, x: Array, torque: Array = torque) -> Array:
                mass, turned, weight = self.dynamics(x, factor)
                return np.concatenate([x[n:], np.linalg.solve(mass, torque - turned - weight)])

            found = solve_ivp(
                slope, (0, dt), state, "DOP853", rtol=1e-12, atol=1e-13,
                t_eval=np.linspace(0, dt, FINE + 1)[1:],
            )  # fmt: skip
            states += list(found.y.T)
            state = states[-1]
        every = np.abs(np.array(states))
        return {
            RANGE: float(every[:, :n].max()), RATE: float(every[:, n:].max()),
            EFFORT: float(np.abs(np.array(commanded)).max()),
        }  # fmt: skip


def kind(name: str) -> str:
    return name if name == EFFORT else " ".join(name.split()[:2])


def bounds(conditions: tuple[CheckedCondition, ...], limits: Limits) -> dict[str, float]:
    """What coordinates, rates and efforts are proved to stay below."""
    most = {RANGE: float(limits.angle), RATE: float(limits.rate), EFFORT: float(limits.effort)}
    found = dict.fromkeys(most, 0.0)
    for each in conditions:
        if kind(each.name) in most:
            of = kind(each.name)
            found[of] = max(found[of], most[of] - each.margin)
    return found


def above(value: float, part: float) -> Fraction:
    return Fraction(round(value * (1 + part) * 10**9) + 1, 10**9)


def sound_loop(seed: int, folder: Path) -> bool:
    """Whether a tube was complete; no motion is called a violation of limits that hold in it."""
    loop, wide = RandomLoop(seed), Limits()
    conditions = prove_motion(loop.scene(folder, wide), loop.motion)
    if any(each.status is not Status.HOLDS for each in conditions):
        return False
    held = bounds(conditions, wide)
    close = Limits(*(above(held[each], 1e-4) for each in (RANGE, RATE, EFFORT)))
    scene = loop.scene(folder, close)
    # As if nothing were proved, so that all are looked at.
    found = with_violation(scene, loop.motion, (), (), ACCURACIES[:1], UNWATCHED)
    assert found == (), (seed, found)
    return True


def violated_loop(seed: int, folder: Path) -> bool:
    """Whether a violation is shown of a limit that the oracle sees violated, a little."""
    loop = RandomLoop(seed)
    rng = np.random.default_rng([24, seed])
    seen = [loop.largest(corner) for corner in loop.corners(rng)]
    planned = loop.largest(still(loop))
    of = (RANGE, RATE, EFFORT)[seed % 3]
    worst = max(each[of] for each in seen)
    limit = Fraction(round((0.2 * planned[of] + 0.8 * worst) * 10**9), 10**9)
    field = {RANGE: "angle", RATE: "rate", EFFORT: "effort"}[of]
    scene = loop.scene(folder, replace(Limits(), **{field: limit}))
    found = prove_motion(scene, loop.motion, refute=True)
    failed = [each for each in found if each.status is Status.FAILS]
    assert all(kind(each.name) == of for each in failed), (seed, failed)
    if failed:
        # The same errors, by hand.
        whole, sizes = unrolled(loop.motion), error_sizes(scene)
        none = undisturbed(sizes, STEPS)
        with working_precision(53):
            first = next(harmful(scene, whole, sizes, none, lambda name: kind(name) == of, tick))
        assert loop.largest(first.signs)[of] > float(limit) - 1e-3 * (worst - planned[of])
    return bool(failed)


def tick() -> None:
    """Nobody watches."""


def still(loop: RandomLoop) -> Disturbance:
    none = ((0,) * loop.n,) * STEPS
    return Disturbance((0,) * 2 * loop.n, (0,), ((0,) * 2 * loop.n,) * STEPS, none, none)


def test_a_disturbance_is_the_motion_that_is_meant(tmp_path: Path) -> None:
    """Its law is that of the planned motion, and its errors are added to what the law reads."""
    for seed in range(examples(2, 4)):
        loop, wide = RandomLoop(seed), Limits()
        scene = loop.scene(tmp_path, wide)
        whole, sizes = unrolled(loop.motion), error_sizes(scene)
        for signs in loop.corners(np.random.default_rng(seed))[:3]:
            with working_precision(ACCURACIES[0].bits):
                moved = disturbed(whole, sizes, signs)
                shown = bounds(tuple(conditions_of(scene, moved, ACCURACIES[0], UNWATCHED)), wide)
            meant = loop.largest(signs)
            assert shown[EFFORT] == pytest.approx(meant[EFFORT], abs=CLOSE)
            for each in (RANGE, RATE):
                # The oracle looks at some instants only.
                assert meant[each] - CLOSE <= shown[each] <= 1.1 * meant[each]


def test_no_sound_loop_is_refuted(tmp_path: Path) -> None:
    assert sum(sound_loop(seed, tmp_path) for seed in FEW) >= 2


def test_violations_are_found(tmp_path: Path) -> None:
    assert sum(violated_loop(seed, tmp_path) for seed in FEW) >= 2


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_none_of_a_hundred_sound_loops_is_refuted(part: int, tmp_path: Path) -> None:
    assert sum(sound_loop(100 + 25 * part + k, tmp_path) for k in range(25)) >= 15


@pytest.mark.slow
@pytest.mark.parametrize("part", range(2))
def test_violations_of_many_loops_are_found(part: int, tmp_path: Path) -> None:
    assert sum(violated_loop(300 + 25 * part + k, tmp_path) for k in range(25)) >= 22
