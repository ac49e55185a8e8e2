"""Random tasks in which an arm of rods takes a load up and puts it down, with a motion that does.

The arm, with the load and without it, is that of ``rod_chains.py``: no code of the project computes
anything here.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from tests.oracles.feasible_text import Frame, plain
from tests.oracles.rod_chains import Array, RodChain, box, quintic, region_about

STEP = 0.1
RANGE = np.radians(160)
SPARE = 1.2
"""The witness has so many times the effort to spare."""


@dataclass(frozen=True)
class CarryingTask:
    """A task that is feasible; ``load`` in kg, ``bound`` in N m, ``slow`` in rad/s.

    ``regions`` (4) are the start, where the load is taken up, where it is put down, and the end.
    """

    text: str
    arm: RodChain
    load: float
    bound: float
    slow: float
    regions: tuple[tuple[Array, Array], ...]

    def dynamics(self, lengths: Sequence[float], carried: float) -> RodChain:
        """The arm with rods of these lengths, and a part of the load."""
        payload = self.arm.payload + carried * self.load
        return replace(self.arm, lengths=tuple(lengths), payload=payload)

    def faults(self, certificate: dict[str, Any]) -> list[str]:
        """What a simulation of a certificate violates."""
        n = len(self.arm.axes)
        values = {each["symbol"]: float(each["value"]) for each in certificate["parameters"]}
        lengths = [values[symbol] for symbol in sorted(values)]
        state = np.array([float(x) for x in certificate["start"]])
        states, there, found = [state], [], []
        for row in certificate["inputs"]:
            u = np.array([float(x) for x in row])
            there.append(u[n])
            if np.abs(u[:n]).max() > self.bound:
                found.append("effort")
            state = _held(self.dynamics(lengths, float(u[n])), state, u[:n])
            states.append(state)
        steps = [k for k, value in enumerate(there) if value == 1]
        if set(there) != {0.0, 1.0} or steps != [*range(steps[0], steps[-1] + 1)]:
            return [*found, "no single load"]
        samples = (0, steps[0], steps[-1] + 1, len(there))
        for sample, (low, high) in zip(samples, self.regions, strict=True):
            tip = self.dynamics(lengths, 0).places(states[sample][:n])[2][-1]
            d = 3 if self.arm.base[2] else 2
            if not ((low <= tip) & (tip <= high))[:d].all():
                found.append(f"sample {sample}: not in its region")
        rates = {sample: np.abs(states[sample][n:]).max() for sample in samples[1:3]}
        found += [f"sample {k}: too fast" for k, rate in rates.items() if not rate < self.slow]
        return found


def _held(arm: RodChain, state: Array, u: Array) -> Array:
    found = solve_ivp(
        lambda _t, x: arm.slope(x, u), (0.0, STEP), state,
        method="DOP853", rtol=1e-10, atol=1e-11,
    )  # fmt: skip
    last: Array = found.y[:, -1]
    return last


def carrying_task(seed: int) -> CarryingTask:
    """The first draw of a seed whose regions are apart and whose motion keeps to them."""
    rng = random.Random(f"carrying {seed}")
    while (found := _drawn(rng)) is None:
        pass
    return found


def _drawn(rng: random.Random) -> CarryingTask | None:
    space = rng.random() < 0.4
    axes = rng.choice(("zyy", "zy")) if space else rng.choice(("zz", "zzz"))
    down = (0.0, 0.0, -9.81) if space else rng.choice(((0.0, -9.81, 0.0), (0.0, 0.0, 0.0)))
    arm = RodChain(
        axes,
        tuple(round(rng.uniform(0.3, 0.6), 3) for _ in axes),
        density=round(rng.uniform(1, 3), 2),
        base=(0.0, 0.0, 0.5) if space else (0.0, 0.0, 0.0),
        down=down,
        payload=round(rng.uniform(0.2, 0.6), 2),
    )
    load = round(rng.choice((0.3, 1.0, 2.5)) * rng.uniform(0.8, 1.2), 2)
    counts = [rng.randint(8, 16) for _ in range(3)]
    poses = [np.array([rng.uniform(-1.3, 1.3) for _ in axes]) for _ in range(4)]
    n, state, states, peak = len(axes), np.concatenate([poses[0], 0 * poses[0]]), [], 0.0
    states.append(state)
    for part, count in enumerate(counts):
        robot = replace(arm, payload=arm.payload + load * (part == 1))
        for k in range(count):
            ends = poses[part], poses[part + 1]
            at, middle = (quintic(*ends, (k + x) / count, count * STEP) for x in (0.0, 0.5))
            off, late = at[0] - state[:n], at[1] - state[n:]
            u = robot.inverse(middle[0], middle[1], middle[2] + 9 * off + 6 * late)
            state = _held(robot, state, u)
            states.append(state)
            peak = max(peak, float(np.abs(u).max()))
    samples = [0, counts[0], counts[0] + counts[1], sum(counts)]
    tips = [arm.places(states[sample][:n])[2][-1] for sample in samples]
    apart = [np.linalg.norm(a - b) for a, b in pairwise(tips)]
    rates = max(float(np.abs(states[sample][n:]).max()) for sample in samples[1:3])
    if min(apart) < 0.35 or rates > 0.2 or max(np.abs(s[:n]).max() for s in states) > RANGE:
        return None
    regions = tuple(region_about(rng, tip, rng.uniform(0.06, 0.15)) for tip in tips)
    slow = round(max(0.02, 1.5 * rates), 3)
    bound = round(SPARE * rng.uniform(1, 1.5) * peak + 0.01, 3)
    text = _text(arm, load, bound, slow, regions, sum(counts))
    return CarryingTask(text, arm, load, bound, slow, regions)


def _text(
    arm: RodChain,
    load: float,
    bound: float,
    slow: float,
    regions: Sequence[tuple[Array, Array]],
    steps: int,
) -> str:
    space = bool(arm.base[2])
    frame, d = Frame(space), 3 if space else 2
    robot = frame.robot([arm], [np.full(len(arm.axes), RANGE)])
    reach = 1.3 * sum(arm.lengths) + 0.6
    sides = [f"[-{plain(reach, 2)}, {plain(reach, 2)}]"] * d
    names = ("Start", "Pick", "Place", "End")
    places = "".join(
        f"  region {name} {box(*region, d)};\n" for name, region in zip(names, regions, strict=True)
    )
    pull = ", ".join(plain(x, 2) for x in arm.down[:d])
    return (
        f"{robot}workspace W {{\n  {'space xyz' if space else 'plane xy'};\n"
        f"  bounds box {' x '.join(sides)} m;\n{places}}}\n"
        "task T {\n  robot G; workspace W; start in Start at rest; reach End;\n"
        f"  carry {plain(load, 2)} kg from Pick to Place rates <= {plain(slow, 3)} rad/s;\n"
        f"  gravity ({pull}) m/s^2; effort <= {plain(bound, 3)} N*m; control open loop;\n"
        f"  horizon {steps} steps of {plain(STEP, 2)} s;\n}}\n"
    )
