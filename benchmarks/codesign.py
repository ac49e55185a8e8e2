"""Measure the case study with free lengths against IPOPT with the lengths as unknowns.

IPOPT cannot choose which cell holds a sample: it gets the cells by sample and the half-planes of
our design and, in a second table, those of a motion with minimum jerk along the planned path.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np
from timing import ROOT, SPEC, SRGC, machine, process

from compiler.arrays import Array

sys.path.insert(0, str(ROOT))

from codesign_starts import random_starts
from control_cases import STEPS, fixed, path_problem
from control_ipopt import ipopt_problem

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.parameters.parameter_search import parameter_space
from solvers.run_context import RunContext
from solvers.search.configuration_search import Configuration, search_configuration
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import ControlOutcome, ControlProblem
from solvers.trajectory.convex_step import Trajectory
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries

NEAR = 0.005
"""By this part of rho we may be less robust than IPOPT's best."""


@dataclass(frozen=True)
class Run:
    """Seconds, the peak effort of a motion where one was found, else NaN, and its lengths."""

    seconds: float
    peak: float
    theta: Array


@dataclass(frozen=True)
class FixedProblem:
    """Given cells by sample and half-planes, lengths free in ``box``, and where to start."""

    problem: ControlProblem
    box: tuple[Array, Array] | None
    starts: list[Trajectory]


def fixed_problem(path: PathProblem, about: ControlOutcome, entries: Entries, starts: int,
                  seed: int) -> FixedProblem:  # fmt: skip
    """The problem with the half-planes of an outcome, and random starts along the path."""
    box = parameter_space(path.model).free_box(about.trajectory.theta)
    problem = fixed(path.problem(entries), about)
    return FixedProblem(problem, box, random_starts(path, starts, seed))


# --- the two sides ------------------------------------------------------------------------------


def searched(path: PathProblem) -> tuple[Run, Configuration]:
    """Our parameter search, with polishing and timing."""
    started = time.perf_counter()
    found = search_configuration(path, "", RunContext())
    taken = time.perf_counter() - started
    if not found.outcome.feasible:
        raise SystemExit("our search found nothing")
    return _run(taken, found.outcome), found


def from_start(one: FixedProblem, start: Trajectory) -> Run:
    """Our convex programs with the lengths as unknowns, from one start, without a search."""
    started = time.perf_counter()
    outcome = synthesise_control(one.problem, start, one.box)
    return _run(time.perf_counter() - started, outcome)


def _run(taken: float, outcome: ControlOutcome) -> Run:
    peak = outcome.effort_peak if outcome.feasible else float("nan")
    return Run(taken, peak, outcome.trajectory.theta)


def by_ipopt(one: FixedProblem, steps: int, ours: Trajectory) -> tuple[float, list[Run], Run]:
    """Seconds to make the program, what IPOPT finds from every start, and from our own motion."""
    started = time.perf_counter()
    program = ipopt_problem(
        one.problem, one.problem.rows_of(np.zeros(0), np.zeros(0)), steps, one.box
    )
    made = time.perf_counter() - started
    runs = []
    for start in [*one.starts, ours]:
        started = time.perf_counter()
        answer = program.solve(start)
        taken = time.perf_counter() - started
        peak = one.problem.scale - answer.margin if answer.solved else float("nan")
        runs.append(Run(taken, peak, answer.trajectory.theta))
    return made, runs[:-1], runs[-1]


def planned_timing(path: PathProblem, near: Trajectory) -> tuple[Run, ControlOutcome, Entries]:
    """Our motion with the planned timing, lengths free, from a motion with another timing."""
    entries = path.waypoints()[1]
    box = parameter_space(path.model).free_box(near.theta)
    started = time.perf_counter()
    outcome = path.solve(near, entries, box)
    if not outcome.feasible:
        raise SystemExit(f"planned timing: {outcome.status}")
    return _run(time.perf_counter() - started, outcome), outcome, entries


def graph_made(path: PathProblem, found: Configuration) -> float:
    """The seconds of our graph of the robot and of its first uses."""
    at, n = found.outcome.trajectory, path.numeric.n
    started = time.perf_counter()
    numeric = NumericRobot(robot_graph(path.model, path.task.gravity))
    numeric.step(at.x[:-1], at.u, at.theta, float(path.task.step), path.substeps)
    numeric.simulate(at.x[0], at.u, at.theta, float(path.task.step), path.substeps)
    numeric.points(at.x[:, :n], at.theta)
    numeric.mass_matrix(at.x[:, :n], at.theta)
    return time.perf_counter() - started


# --- tables -------------------------------------------------------------------------------------


def line(what: str, runs: Sequence[Run], bound: float) -> Run | None:
    """Print the best and the median peak of the runs that found a motion, and the median time."""
    good = [run for run in runs if np.isfinite(run.peak)]
    times = sorted(run.seconds for run in runs)
    share = f"{len(good)}/{len(runs)}"
    if not good:
        print(f"  {what:<38}{share:>6}{'':>44}{median(times):>9.3f}", flush=True)
        return None
    best = min(good, key=lambda run: run.peak)
    middle = median(run.peak for run in good)
    lengths = ", ".join(f"{value:.3f}" for value in best.theta)
    print(
        f"  {what:<38}{share:>6}{bound - best.peak:>11.6f}{best.peak:>11.6f}{middle:>10.5f}"
        f"  {lengths:<14}{median(times):>6.3f}{times[0]:>9.3f}{times[-1]:>9.3f}",
        flush=True,
    )
    return best


def head(what: str) -> None:
    """The head of a table."""
    print(
        f"\n{what}\n  {'':<38}{'found':>6}{'best rho':>11}{'its peak':>11}{'median':>10}"
        f"  {'lengths':<11}{'median s':>9}{'least':>9}{'most':>9}"
    )


def main() -> None:
    """Measure and print tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=3, help="of our search")
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--seed", type=int, default=0, help="of the starts")
    parser.add_argument("--no-synth", action="store_true", help="without the whole of srgc synth")
    options = parser.parse_args()
    if min(options.starts, options.rounds, options.steps) < 1:
        parser.error("at least one start, round and step")
    print(machine())
    path = path_problem(2, options.steps)
    own, design = zip(*(searched(path) for _ in range(options.rounds)), strict=True)
    found = design[0]
    bound = path.problem(found.entries).scale

    along = path.along(found.cells, found.entries)
    same = fixed_problem(along, found.outcome, found.entries, options.starts, options.seed)
    head(f"cells by sample as in our design, entered at {found.entries}; peaks in N m")
    made, theirs, near = by_ipopt(same, options.steps, found.outcome.trajectory)
    best = line("IPOPT, lengths unknown, random starts", theirs, bound)
    nearest = line("IPOPT, from our design's motion", [near], bound)
    line("our convex programs, the same starts", [from_start(same, s) for s in same.starts], bound)
    mine = line("ours: search, polishing, timing", own, bound)

    run, outcome, entries = planned_timing(path, found.outcome.trajectory)
    planned = fixed_problem(path, outcome, entries, options.starts, options.seed)
    head(f"cells by sample as planned, entered at {entries}")
    _, others, near = by_ipopt(planned, options.steps, outcome.trajectory)
    line("IPOPT, lengths unknown, random starts", others, bound)
    line("IPOPT, from our motion below", [near], bound)
    starts = [from_start(planned, s) for s in planned.starts]
    line("our convex programs, the same starts", starts, bound)
    line("ours, from our design's motion", [run], bound)
    print(
        f"\nmade once, not counted: our graph {graph_made(path, found):.2f} s, "
        f"IPOPT's program {made:.2f} s"
    )
    if mine is not None:
        for name, other in (("best", best), ("best from our motion", nearest)):
            if other is not None:
                robustness(mine, name, other, bound)
        required(own, theirs)
    if not options.no_synth:
        counted(median(run.seconds for run in theirs))


def robustness(mine: Run, name: str, best: Run, bound: float) -> None:
    """Whether we are about as robust, or more."""
    gain = (bound - mine.peak) / (bound - best.peak) - 1
    print(
        f"required: rho within {100 * NEAR:.1f} % of IPOPT's {name}; {_word(gain >= -NEAR)}, "
        f"{100 * gain:+.4f} %; our peak effort is {mine.peak / best.peak:.4f} times its"
    )


def required(own: Sequence[Run], theirs: Sequence[Run]) -> None:
    """Our time, without the search of structures and the certificate, against its median."""
    taken, middle = (median(run.seconds for run in runs) for runs in (own, theirs))
    print(
        f"required: in no more time than its median start; {_word(taken <= middle)}, "
        f"{taken:.2f} s against {middle:.2f} s"
    )


def counted(middle: float) -> None:
    """The search of structures and the certificate counted: the whole process."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "arm"
        taken = process([*SRGC, "synth", str(SPEC), "-o", str(folder)]).wall
        shutil.rmtree(folder, ignore_errors=True)
    print(
        f"counted with structures, certificate and pictures (srgc synth): {taken:.2f} s, "
        f"{taken / middle:.1f} times its median start"
    )


def _word(reached: bool) -> str:  # noqa: FBT001
    return "reached" if reached else "MISSED"


if __name__ == "__main__":
    main()
