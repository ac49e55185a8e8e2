"""The same questions put to other libraries, as a user would write them down."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from types import FrameType
from typing import Any

from planning_worlds import World


class TooSlow(Exception):
    """The limit was reached."""


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raise ``TooSlow`` in the body after so many seconds of wall time."""
    started = time.monotonic()

    def stop(_signal: int, frame: FrameType | None) -> None:
        # What is raised in a destructor is lost; the alarm comes again.
        while frame is not None:
            if frame.f_code.co_name == "__del__":
                return
            frame = frame.f_back
        raise TooSlow

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds, 0.1)
    try:
        yield
    except Exception as error:
        # A foreign function call turns what the alarm raises into an exception of its own.
        if time.monotonic() - started >= seconds:
            raise TooSlow from error
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def z3_one_hot(
    world: World, seconds: float, more: Callable[[Any, list[dict[int, Any]]], None] | None = None
) -> list[int]:
    """One z3 Boolean per (cell, step), one cell per step, staying allowed."""
    import z3

    solver = z3.Solver()
    solver.set("timeout", int(1000 * seconds))
    at = [{c: z3.Bool(f"{i},{c}") for c in world.free} for i in range(world.steps + 1)]
    solver.add(at[0][world.start])
    if more is None:
        solver.add(at[-1][world.target])
    for row in at:
        solver.add(z3.AtMost(*row.values(), 1))
    for row, after in pairwise(at):
        for cell in world.free:
            ways = [after[c] for c in (cell, *world.neighbours[cell]) if c in after]
            solver.add(z3.Implies(row[cell], z3.Or(ways)))
    if more is not None:
        more(solver, at)
    answer = solver.check()
    if answer == z3.unknown:
        raise TooSlow
    if answer != z3.sat:
        raise SystemExit("z3 has no path")
    model = solver.model()
    return [next(c for c in row if z3.is_true(model[row[c]])) for row in at]


def pysat_clauses(world: World, seconds: float) -> list[int]:
    """The same as clauses made in Python, for CaDiCaL; at most one by a sequential counter."""
    from pysat.solvers import Cadical195

    del seconds
    count, steps = len(world.free), world.steps
    place = {cell: k for k, cell in enumerate(world.free)}

    def at(step: int, cell: int) -> int:
        return 2 * (step * count + place[cell]) + 1

    with Cadical195() as solver:
        solver.add_clause([at(0, world.start)])
        solver.add_clause([at(steps, world.target)])
        for step in range(steps + 1):
            for k, cell in enumerate(world.free):
                own = at(step, cell)
                if k:
                    before = at(step, world.free[k - 1]) + 1
                    solver.add_clause([-before, own + 1])
                    solver.add_clause([-before, -own])
                solver.add_clause([-own, own + 1])
                if step < steps:
                    ways = [at(step + 1, cell)]
                    ways += [at(step + 1, c) for c in world.neighbours[cell] if c in place]
                    solver.add_clause([-own, *ways])
        if not solver.solve():
            raise SystemExit("python-sat has no path")
        true = {literal for literal in solver.get_model() or () if literal > 0}
        return [next(c for c in world.free if at(i, c) in true) for i in range(steps + 1)]


def drake_graph(world: World, seconds: float) -> list[int]:
    """A graph of convex sets, a point per cell; the shortest way by its convex relaxation.

    Points with a cost of 1 per edge are as quick as squares with lengths; without preprocessing,
    which solves a program per edge, it is many times quicker.
    """
    import numpy as np
    from pydrake.geometry.optimization import GraphOfConvexSets, GraphOfConvexSetsOptions, Point
    from pydrake.solvers import ClarabelSolver

    del seconds
    graph = GraphOfConvexSets()
    vertices = {
        cell: graph.AddVertex(Point(np.array(divmod(cell, world.side), dtype=float)), str(cell))
        for cell in world.free
    }
    for cell in world.free:
        for other in world.neighbours[cell]:
            if other in vertices:
                graph.AddEdge(vertices[cell], vertices[other]).AddCost(1.0)
    options = GraphOfConvexSetsOptions()
    options.convex_relaxation = True
    options.preprocessing = False
    options.max_rounded_paths = 1
    options.solver = ClarabelSolver()
    start, target = vertices[world.start], vertices[world.target]
    result = graph.SolveShortestPath(start, target, options)
    if not result.is_success():
        raise SystemExit("Drake has no path")
    edges = graph.GetSolutionPath(start, target, result)
    return [world.start, *(int(edge.v().name()) for edge in edges)]
