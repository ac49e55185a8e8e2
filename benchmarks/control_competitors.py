"""Ways to evaluate the robustness of a robot on a path, ready to be called."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

from control_cases import Case
from control_cvxpy import CvxpyLoop, Form
from control_ipopt import IpoptProblem, ipopt_problem
from control_stages import StagedProblem, staged_problem

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.convex_step import step_maker
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.trajectory import Trajectory

STRATEGIES = ("monotone", "adaptive")
"""IPOPT's for its barrier."""
FATROP: Mapping[str, Mapping[str, object]] = {
    "as it is": {},
    "expanded": {"expand": True},
    "a smaller barrier at first": {"fatrop.mu_init": 1e-2},
    "expanded, a smaller barrier": {"expand": True, "fatrop.mu_init": 1e-2},
}
"""Options, by what they are called."""
VIOLATION = 1e-4
"""What a loop over cvxpy may leave of a constraint, in SI."""

Found: TypeAlias = tuple[float, int]
"""Rho and the number of iterations."""


@dataclass(frozen=True)
class Competitor:
    """A name, a call, and the seconds that were spent before the first one, which do not count."""

    name: str
    call: Callable[[], Found]
    made: float


def ours(one: Case, problem: ControlProblem, name: str = "ours") -> Competitor:
    """``synthesise_control``; made: the robot's graph and programs from it."""
    started = time.perf_counter()
    path_problem, seed = one.path_problem, one.seed
    numeric = NumericRobot(robot_graph(path_problem.model, path_problem.task.gravity))
    fresh = replace(problem, numeric=numeric)
    synthesise_control(fresh, seed)
    made = time.perf_counter() - started
    started = time.perf_counter()
    synthesise_control(fresh, seed)
    made -= time.perf_counter() - started

    def call() -> Found:
        outcome = synthesise_control(problem, seed)
        if not outcome.feasible:
            raise SystemExit(f"{name}: {outcome.status}")
        return outcome.robustness, outcome.iterations

    return Competitor(name, call, max(0.0, made))


def ours_in_cvxpy(one: Case, problem: ControlProblem) -> Competitor:
    """Our own iteration with its convex steps written in cvxpy."""
    other = replace(problem, steps=step_maker("CLARABEL"))
    return replace(ours(one, other, "our iteration, its steps in cvxpy"), made=0.0)


def ipopt(one: Case, problem: ControlProblem, rows: PositionRows, least: float) -> Competitor:
    """IPOPT in the form and with the strategy that are faster here.

    Made: the program with its derivatives.  Some end elsewhere: those that reach ``least`` are
    preferred.
    """
    steps = len(one.seed.u)
    makers: dict[str, Callable[[], IpoptProblem | StagedProblem]] = {
        f"CasADi + IPOPT, {strategy}": partial(
            ipopt_problem, problem, rows, steps, one.theta, {"ipopt.mu_strategy": strategy}
        )
        for strategy in STRATEGIES
    }
    staged = partial(staged_problem, problem, rows, steps, one.theta, "ipopt")
    return _best({**makers, "CasADi + IPOPT, stage by stage": staged}, one.seed, least)


def fatrop(one: Case, problem: ControlProblem, rows: PositionRows, least: float) -> Competitor:
    """FATROP, given its stages, as it is faster here."""
    staged = partial(staged_problem, problem, rows, len(one.seed.u), one.theta, "fatrop")
    makers = {
        f"CasADi + FATROP, {name}": partial(staged, options) for name, options in FATROP.items()
    }
    return _best(makers, one.seed, least)


def _best(
    makers: Mapping[str, Callable[[], IpoptProblem | StagedProblem]],
    seed: Trajectory,
    least: float,
) -> Competitor:
    found = []
    for name, make in makers.items():
        started = time.perf_counter()
        program = make()
        made = time.perf_counter() - started
        started = time.perf_counter()
        answer = program.solve(seed)
        taken = time.perf_counter() - started
        if answer.solved:
            worse = answer.margin < least
            found.append((worse, taken, Competitor(name, partial(_call, program, seed), made)))
    if not found:
        raise SystemExit(f"no optimum: {', '.join(makers)}")
    return min(found, key=lambda each: each[:2])[2]


def _call(program: IpoptProblem | StagedProblem, seed: Trajectory) -> Found:
    answer = program.solve(seed)
    return answer.margin, answer.iterations


def cvxpy(one: Case, problem: ControlProblem, rows: PositionRows, form: Form) -> Competitor:
    """A loop over cvxpy; made: the compilation of a program with parameters."""
    loop = CvxpyLoop(problem, rows, len(one.seed.u), form)
    started = time.perf_counter()
    loop.prepare(one.seed)
    made = time.perf_counter() - started

    def call() -> Found:
        answer = loop.solve(one.seed)
        if answer.violation > VIOLATION:
            raise SystemExit(f"cvxpy: a violation of {answer.violation:.1e}")
        return answer.margin, answer.iterations

    return Competitor(f"cvxpy, {form.value}", call, made)
