"""The pendulums of ARCH-COMP, whose controllers are neural networks, enclosed by the verifier.

Every property is shown of all starts, or disproved by one (`network_pendulums.py`); scipy simulates
the published equations from corners and random starts of every part. The networks are published
and not part of this repository: `--networks` is a folder that has the .nnet files somewhere in it.

    git clone https://github.com/verivital/ARCH-COMP2024 out/ARCH-COMP2024
    python benchmarks/arch_closed_loop.py
"""

from __future__ import annotations

import argparse
import hashlib
import platform
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path
from statistics import median

import numpy as np
from scipy.integrate import solve_ivp
from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from benchmarks.network_pendulums import CASES, Box, Case, Enclosed, enclosed, shown
from benchmarks.relu_network import ReluNetwork, read_network
from compiler.arrays import Array
from solvers.verifier.proofs.tube_checks import Status

SEED = 1
INSTANTS = 4
"""In a step, at which motions are compared with their enclosure."""
SLACK = 1e-8
"""What a simulation may be off by."""
PUBLISHED = (
    ("JuliaReach", "single 2024", "shown, 12 parts", "8.1 to 260"),
    ("JuliaReach", "single 2023", "violated by a corner", "0.32 to 12"),
    ("JuliaReach", "less robust 2024", "shown of 2 steps of 20, 8 parts", "34 to 139"),
    ("JuliaReach", "more robust 2024", "violated by a corner", "0.65 to 21"),
    ("POLAR", "single 2023", "violated", "1"),
)
"""Wall seconds. JuliaReach: the pages of ClosedLoopReachability.jl 0.6.2 (17 August 2025, Julia
1.11.6) to 0.8.0 (30 July 2026, Julia 1.12.6), least and largest of six versions. POLAR: the files
in `ARCH-COMP22/Single_Pendulum/outputs` of its repository, whole seconds. No machine is named."""
DRAWN = (
    ("single 2024", "CROWN-Reach", (0.5664, 0.7085)),
    ("single 2023", "POLAR", (0.5696, 0.7197)),
)
"""The angle on the last piece of published pictures, 0.99 s to 1 s: `single_pendulum.fig` of 30 May
2024 in the repository of CROWN-Reach, `Single_Pendulum_1.plt` in that of POLAR."""
LAST_PIECE = Fraction(99, 5), Fraction(20)


def accelerations(x: Array, torque: Array) -> Array:
    """Those of the published equations, m = l = 0.5, g = 1, c = 0: (n,), or (n, starts).

    Source: `dynamics_sp.m` and `dynamics_dp.m` of the competition, solved for the accelerations.
    """
    if len(x) == 2:
        return 2 * np.sin(x[:1]) + 8 * torque
    first, second, v, w = x
    s, c = np.sin(first - second), np.cos(first - second)
    a = 2 * np.sin(first) + 4 * torque[0] - w**2 * s / 2
    b = (s * v**2 + 8 * torque[1] + 2 * np.sin(second) - c * a) / (1 - c**2 / 2)
    return np.array([a - c * b / 2, b])


def simulated(
    case: Case, network: ReluNetwork, starts: Array, instants: int = INSTANTS
) -> Iterator[Array]:
    """States (2 n, starts) at first, and at so many instants of each step."""
    x, n = starts, case.links
    yield x
    for _ in range(case.steps):
        torque = network(x.T).T

        def rate(_: float, flat: Array, torque: Array = torque) -> Array:
            state = flat.reshape(starts.shape)
            return np.concatenate([state[n:], accelerations(state, torque)]).ravel()

        for _ in range(instants):
            span = (0.0, float(case.period) / instants)
            ran = solve_ivp(rate, span, x.ravel(), method="DOP853", rtol=1e-10, atol=1e-12)
            x = ran.y[:, -1].reshape(starts.shape)
            yield x


def starts_of(box: Box, count: int, rng: np.random.Generator) -> Array:
    """The corners of a box, and so many of its points: (2 n, starts)."""
    low, high = np.array(box, dtype=float).T
    corners = np.array(list(product((0.0, 1.0), repeat=len(box))))
    return (low + (high - low) * np.vstack([corners, rng.random((count, len(box)))])).T


def margins(case: Case, network: ReluNetwork, starts: Array) -> Array:
    """The least distance of each motion from its limits, negative beyond them: (starts,)."""
    worst = np.full(starts.shape[1], np.inf)
    for number, x in enumerate(simulated(case, network, starts)):
        if number < INSTANTS * case.first:
            continue
        for entry, limit in zip(x, case.limits, strict=True):
            if limit is not None:
                worst = np.minimum(worst, entry - float(limit[0]))
                worst = np.minimum(worst, float(limit[1]) - entry)
    return worst


def checked(case: Case, network: ReluNetwork, box: Box, found: Enclosed, starts: Array) -> Array:
    """Simulated motions from a box at its end, (2 n, starts).

    Raises:
        SystemExit: one is outside of the enclosure at one of the instants.
    """
    x = starts
    for number, x in enumerate(simulated(case, network, starts)):
        instant = Fraction(number, INSTANTS)
        ends = found.bounds(instant, instant, Fraction(case.period))
        low, high = (np.array(end)[:, None] for end in ends)
        if (x < low - SLACK).any() or (x > high + SLACK).any():
            sys.exit(f"{case.name}: a motion from {box} left the enclosure at instant {number}")
    return x


def point_of(box: Box, state: Sequence[float]) -> Box:
    """A state in a box: corners in floats may be a little outside of it."""
    pairs = zip(state, box, strict=True)
    exact = [min(max(Fraction(x), low), high) for x, (low, high) in pairs]
    return tuple((x, x) for x in exact)


def line(case: Case, network: ReluNetwork, runs: int, count: int) -> str:
    """A case in a line of the table."""
    rng = np.random.default_rng(SEED)
    starts = starts_of(case.box, count, rng)
    worst = margins(case, network, starts)
    box = case.box
    if worst.min() < 0:
        box = point_of(case.box, starts[:, worst.argmin()].tolist())
    outcomes = [shown(case, network, box) for _ in range(runs)]
    seconds = median(outcome.seconds for outcome in outcomes)
    outcome = outcomes[0]
    what = {Status.HOLDS: "shown", Status.FAILS: "violated", Status.UNDECIDED: "not shown"}
    ends = [
        checked(case, network, part, found, starts_of(part, count, rng))
        for part, found in outcome.parts
        if found.complete(case)
    ]
    told = f"{case.name:<18}{what[outcome.status]:<10}{len(outcome.parts):>6}{outcome.tried:>7}"
    told += f"{outcome.margin:>10.4f}{worst.min():>10.4f}{seconds:>9.2f}"
    if outcome.status is Status.HOLDS:
        reached = np.concatenate(ends, axis=1)
        spread = reached.max(axis=1) - reached.min(axis=1)
        pairs = zip(outcome.widths(case.steps), spread.tolist(), strict=True)
        told += "  " + ", ".join(f"{width:.3f} ({exact:.3f})" for width, exact in pairs)
    return told


def drawn(case: Case, network: ReluNetwork, count: int) -> Iterator[str]:
    """The range of the first angle on the last piece, and what others have drawn of it."""
    free = replace(case, limits=(None,) * len(case.limits))
    low, high = enclosed(free, network, case.box).bounds(*LAST_PIECE, Fraction(case.period))
    yield f"{case.name:<18}{'ours':<14}{low[0]:>9.4f}{high[0]:>9.4f}{high[0] - low[0]:>9.4f}"
    starts, sizes = starts_of(case.box, count, np.random.default_rng(SEED)), []
    for number, x in enumerate(simulated(case, network, starts, instants=5)):
        if Fraction(number, 5) >= LAST_PIECE[0]:
            sizes += [x[0].min(), x[0].max()]
    least, most = min(sizes), max(sizes)
    yield f"{case.name:<18}{'sampled':<14}{least:>9.4f}{most:>9.4f}{most - least:>9.4f}"
    for name, tool, (bottom, top) in DRAWN:
        if name == case.name:
            yield f"{case.name:<18}{tool:<14}{bottom:>9.4f}{top:>9.4f}{top - bottom:>9.4f}"


def processor() -> str:
    """What the times are of."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    models = [each.partition(":")[2].strip() for each in lines if each.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


HEAD = (
    f"{'case':<18}{'property':<10}{'parts':>6}{'tubes':>7}{'margin':>10}{'sampled':>10}{'cpu s':>9}"
    "  widths at the end (sampled)"
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--networks", type=Path, default=ROOT / "out" / "ARCH-COMP2024", help="with .nnet files"
    )
    parser.add_argument("--cases", nargs="*", help="names; default all")
    parser.add_argument("--runs", type=int, default=3, help="of which times are the medians")
    parser.add_argument("--starts", type=int, default=1000, help="random ones that are simulated")
    options = parser.parse_args()
    print(f"{machine()}\n\n{HEAD}", flush=True)
    files = {path.name: path for path in sorted(options.networks.rglob("*.nnet"))}
    for case in CASES:
        if options.cases and case.name not in options.cases:
            continue
        if case.network not in files:
            print(f"{case.name:<18}no file {case.network} in the folder of networks")
            continue
        print(
            line(case, read_network(files[case.network]), options.runs, options.starts), flush=True
        )
    print(f"\none process on {processor()}, Python {platform.python_version()}")
    print("\nangle from 0.99 s to 1 s: least, largest, width")
    for case in CASES:
        if case.network in files and case.name in {name for name, _, _ in DRAWN}:
            network = read_network(files[case.network])
            for told in drawn(case, network, options.starts):
                print(told, flush=True)
    print("\npublished, wall seconds")
    for tool, name, what, seconds in PUBLISHED:
        print(f"{tool:<12}{name:<18}{what:<34}{seconds:>12}")
    print("\nnetworks, SHA-256")
    for name in sorted({case.network for case in CASES} & set(files)):
        print(f"{name:<46}{hashlib.sha256(files[name].read_bytes()).hexdigest()[:16]}")


if __name__ == "__main__":
    main()
