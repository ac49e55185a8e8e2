"""Convex solvers that fail: each is given a program and the answer of a solver that works."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solvers.backends.clarabel import Clarabel
from solvers.backends.conic import ConvexProgram, NotSolved, Optimum, Status
from solvers.backends.piqp import ProximalInteriorPoint

Answer = Optimum | NotSolved
Fault = Callable[[ConvexProgram, Callable[[ConvexProgram], Answer]], object]


class Panic(BaseException):
    """As libraries in Rust raise it: no Exception."""


def answers(change):
    """A solver whose points are changed; what it does not solve stays so."""

    def fault(program, honest):
        answer = honest(program)
        return change(program, answer) if isinstance(answer, Optimum) else answer

    return fault


def claims(status):
    return lambda _program, _honest: NotSolved(status)


def raises(error):
    def fault(_program, _honest):
        raise error

    return fault


def random_point(program, _answer):
    rng = np.random.default_rng(len(program.linear))
    return Optimum(rng.normal(size=len(program.linear)), 1.0)


def moved(program, answer):
    """A step off the equations."""
    return Optimum(answer.point + 0.05 * (1 + np.abs(answer.point).max()), answer.value)


def another_point(program, honest):
    """Feasible, and optimal for something else: no reward for the margin of the inputs."""
    return honest(replace(program, linear=np.maximum(program.linear, 0.0)))


def of_infinite(program, answer):
    point = answer.point.copy()
    point[0] = np.inf
    return Optimum(point, answer.value)


GARBAGE: dict[str, Fault] = {
    "NaN": answers(lambda p, a: Optimum(np.full_like(a.point, np.nan), 0.0)),
    "one infinite entry": answers(of_infinite),
    "huge numbers": answers(lambda p, a: Optimum(np.full_like(a.point, 1e300), 0.0)),
    "a value that is NaN": answers(lambda p, a: Optimum(a.point, float("nan"))),
    "a random point": answers(random_point),
    "nothing but zeros": answers(lambda p, a: Optimum(np.full_like(a.point, 0.0) - 7.0, 0.0)),
    "too long": answers(lambda p, a: Optimum(np.append(a.point, 0.0), 0.0)),
    "no array": answers(lambda p, a: Optimum(a.point.tolist(), 0.0)),
    "no answer": lambda _program, _honest: None,
    "off the equations": answers(moved),
}
CLAIMS: dict[str, Fault] = {status.name: claims(status) for status in Status}
RAISED: dict[str, Fault] = {
    "an error": raises(RuntimeError("out of\n luck")),
    "no memory": raises(MemoryError()),
    "a panic": raises(Panic("index out of bounds")),
}
PLAUSIBLE: dict[str, Fault] = {
    "a point that is not optimal": another_point,
    "another value": answers(lambda p, a: Optimum(a.point, a.value - 1e6)),
    "nearly": answers(lambda p, a: Optimum(a.point + 1e-5, a.value)),
}


def inject(monkeypatch, fault: Fault, every: int = 1) -> list[int]:
    """Let each ``every``-th call of the convex solvers fail; the list counts the calls."""
    calls = [0]
    honest = {solver: solver.solve for solver in (ProximalInteriorPoint, Clarabel)}

    def solve(self, program, tolerance):
        calls[0] += 1

        def really(asked):
            return honest[type(self)](self, asked, tolerance)

        return fault(program, really) if calls[0] % every == 0 else really(program)

    for solver in honest:
        monkeypatch.setattr(solver, "solve", solve)
    return calls
