"""Why paths cannot be followed, where algebra says it: a carriage of 1 kg, pushed by at most 4 N.

From rest it needs the time 2 sqrt(d / a) for a way of d metres from rest to rest, and sqrt(2 d / a)
if it may arrive at speed, with a = 4 m/s^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, permutations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from compiler.workspaces.bisection import bisections
from grammar_lang.load import load_text
from solvers.run_context import RunContext
from solvers.search import path_cores
from solvers.search.configuration_search import Configuration
from solvers.search.path_cores import PathCore, PathCores, quick_explanation
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_relaxation import PathRelaxation
from solvers.trajectory.task_size import least_margin

CARRIAGE = """\
module B { role base; }
module RX { role joint; dof q: prismatic x in [-6, 6] m; }
module RY { role joint; dof q: prismatic y in [-3, 3] m; }
module W { role effector; const mass = 1 kg; }
edge eps;

grammar Carriages {
  start N;
  base: N -> B;
  along: N -> N eps RX;
  across: N -> N eps RY;
  tool: N -> N eps W;
  accept matches B eps RX eps RY eps W;
}

semantics Carriages {
  base { this.frame = world; }
  along { this.frame = N.frame * move(x, RX.q); }
  across { this.frame = N.frame * move(y, RY.q); }
  tool { this.frame = N.frame; point(frame: N.frame, mass: W.mass); effector(frame: N.frame); }
}

workspace Hall {
  plane xy;
  bounds box [-6, 6] x [-3, 3] m;
REGIONS}

task Go {
  robot Carriages;
  workspace Hall;
  start in S at rest;
  reach T;
  effort <= 4 N;
  horizon 24 steps of STEP s;
}
"""
STEPS = 24
CELLS = 24
"""So many at least, so that paths have room to pass."""
AROUND = """\
  region S box [-0.5, 0.5] x [-2, -1.5] m;
  region A box [2.5, 3.5] x [-0.5, 0.5] m;
  region B box [-3.5, -2.5] x [-0.5, 0.5] m;
  target T box [-0.5, 0.5] x [1.5, 2] m;
"""
"""To 2.5 m and back takes 2 sqrt(2 / a) + sqrt(4 / a) = 2.4 s."""
ALONG = """\
  region S box [-5, -4.5] x [-0.5, 0.5] m;
  region A box [-3, -2] x [1.5, 2.5] m;
  region B box [3, 4] x [-0.5, 0.5] m;
  target T box [4.5, 5] x [-2.5, -1.5] m;
"""
"""Straight on sqrt(18 / a) = 2.1 s; to 3 m, back to -2 m, and on again: 6.8 s."""


def posed(regions: str, time: float, visited: Sequence[str]) -> PathProblem:
    """A path that visits regions in turn, by the fewest cells between them, none twice."""
    text = CARRIAGE.replace("REGIONS", regions).replace("STEP", f"{time / STEPS}")
    program = load_text(text, "carriage.srg").program
    assert program is not None
    task = program.tasks["Go"]
    workspace = program.workspaces["Hall"]
    family = family_of(program, task)
    model = family.robot(family.replay(("tool", "across", "along", "base")))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    cells = abstract(workspace)
    cells = cells.cut(bisections(cells, CELLS))
    graph = nx.Graph((a, b) for a, near in enumerate(cells.neighbours) for b in near)
    stops = [
        next(at for at, cell in enumerate(cells.cells) if cell.region == name) for name in visited
    ]
    path = stops[:1]
    for stop in stops[1:]:
        free = graph.subgraph(set(graph) - set(path[:-1]) - (set(stops) - {path[-1], stop}))
        path += nx.shortest_path(free, path[-1], stop)[1:]
    margin = least_margin(workspace, task)
    return PathProblem(numeric, workspace, task, cells, 0, tuple(path), margin, 0)


def followed(path_problem: PathProblem) -> Configuration:
    """The motion that is bound to the cells of the path, which the search itself need not be."""
    (seed, *_), entries = path_problem.seeds(np.zeros(0)), path_problem.waypoints()[1]
    outcome = path_problem.solve(seed, entries)
    assert not outcome.feasible
    return Configuration(outcome, entries, path_problem.cells)


def can_visit(path_problem: PathProblem, cells: Sequence[int]) -> bool:
    """Whether a carriage can visit cells in turn, at whatever samples: linear programs by axis."""
    task, abstraction = path_problem.task, path_problem.abstraction
    dt, axes = float(task.step), range(2)
    speed = np.tril(np.full((STEPS + 1, STEPS), dt), -1)
    place = np.zeros((STEPS + 1, STEPS))
    place[1:] = np.cumsum(speed[:-1] * dt + np.eye(STEPS) * dt**2 / 2, axis=0)

    def box(cell: int) -> np.ndarray:
        corners = np.array(abstraction.cells[cell].polytope.vertices, dtype=float)
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    start, end = (box(path_problem.cells[at]) for at in (0, -1))
    for times in combinations(range(STEPS + 1), len(cells)):
        stops = [*zip(times, map(box, cells), strict=True), (STEPS, end)]
        rows = np.c_[place[[at for at, _ in stops]], np.ones(len(stops))]
        low, high = np.array([region for _, region in stops]).transpose(1, 2, 0)
        if all(
            linprog(
                np.zeros(STEPS + 1),
                np.vstack([rows, -rows]),
                np.concatenate([high[axis], -low[axis]]),
                bounds=[*[(-4, 4)] * STEPS, tuple(start[:, axis])],
            ).status == 0
            for axis in axes
        ):  # fmt: skip
            return True
    return False


@pytest.mark.parametrize(
    ("regions", "time", "visited", "size"),
    [
        (AROUND, 1.8, "SABT", 1),
        (AROUND, 1.8, "SBAT", 1),
        (ALONG, 3.8, "SBAT", 2),
        (ALONG, 1.5, "ST", 0),
    ],
)
def test_it_is_what_linear_programs_say(regions: str, time: float, visited: str, size: int) -> None:
    path_problem = posed(regions, time, visited)
    core = PathCores(RunContext(), "robot").explained(path_problem, followed(path_problem), "path")
    assert isinstance(core, PathCore)
    assert (len(core.places), core.ordered) == (size, True)
    cells = [path_problem.cells[place] for place in core.places]
    assert not can_visit(path_problem, cells)
    for fewer in combinations(cells, size - 1) if size else ():
        assert can_visit(path_problem, fewer)
    if size > 1:
        assert any(can_visit(path_problem, order) for order in permutations(cells))


@pytest.mark.parametrize("ordered", [True, False])
def test_order_is_left_out_where_it_does_not_matter(
    monkeypatch: pytest.MonkeyPatch, *, ordered: bool
) -> None:
    def fails(_: object, kept: Sequence[int], rounds: int = 1) -> bool:
        both = {2, 5} <= set(kept)
        return both and (not ordered or list(kept).index(2) < list(kept).index(5))

    monkeypatch.setattr(path_cores._Trials, "fails", fails)
    path_problem = posed(ALONG, 3.8, "SBAT")
    core = PathCores(RunContext(), "robot").explained(path_problem, followed(path_problem), "path")
    assert core == PathCore((2, 5), ordered=ordered)


def test_a_resumed_search_asks_nothing_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    path_problem, cores = posed(ALONG, 4.2, "SBAT"), PathCores(RunContext(), "robot")
    motion = followed(path_problem)
    found = cores.explained(path_problem, motion, "path")
    monkeypatch.delattr(PathRelaxation, "outcome")
    assert cores.explained(path_problem, motion, "path") == found


# --- QuickXplain ----------------------------------------------------------------------------------


@given(st.integers(1, 7), st.lists(st.sets(st.integers(0, 6), min_size=1), min_size=1, max_size=4))
def test_a_minimal_set_that_fails(count: int, conflicts: list[set[int]]) -> None:
    facts = tuple(range(count))
    known = [conflict for conflict in conflicts if conflict <= set(facts)] or [set(facts)]

    def fails(kept: tuple[int, ...]) -> bool:
        return any(conflict <= set(kept) for conflict in known)

    found = quick_explanation(facts, fails)
    assert fails(found)
    assert list(found) == sorted(found)
    assert not any(fails(less) for less in combinations(found, len(found) - 1))
