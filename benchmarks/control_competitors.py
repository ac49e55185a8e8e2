"""Ways to evaluate the robustness of a robot on a path, ready to be called."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

from control_cases import Case
from control_cvxpy import CvxpyLoop, Form
from control_ipopt import IpoptProblem, ipopt_problem

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.convex_step import step_maker
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.trajectory import Trajectory

STRATEGIES = ("monotone", "adaptive")
"""IPOPT's for its barrier."""
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


def ipopt(one: Case, problem: ControlProblem, rows: PositionRows) -> Competitor:
    """IPOPT with the strategy that is faster here; made: the program with its derivatives."""
    found = []
    for strategy in STRATEGIES:
        started = time.perf_counter()
        program = ipopt_problem(
            problem, rows, len(one.seed.u), one.theta, {"ipopt.mu_strategy": strategy}
        )
        made = time.perf_counter() - started
        call = partial(_by_ipopt, program, one.seed)
        started = time.perf_counter()
        call()
        taken = time.perf_counter() - started
        found.append((taken, Competitor(f"CasADi + IPOPT, {strategy}", call, made)))
    return min(found, key=lambda each: each[0])[1]


def _by_ipopt(program: IpoptProblem, seed: Trajectory) -> Found:
    answer = program.solve(seed)
    if not answer.solved:
        raise SystemExit(f"IPOPT: {answer.status}")
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
