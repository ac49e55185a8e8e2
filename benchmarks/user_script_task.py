"""What the script of `user_script.py` is given, and the judge of what it finds."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from timing import ROOT
from user_script_motions import PARTS, Answer
from user_script_planner import Array, Scene

sys.path.insert(0, str(ROOT))

from compiler.discretisation.batched_function import BatchedFunction
from compiler.dynamics.controlled_system import controlled_system
from compiler.dynamics.energy_graph import ldl_solve
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from solvers.conclusion import module_bound
from solvers.parameters.parameter_search import parameter_space
from srgc.session import program_of
from tests.oracles import rod_chains
from tests.oracles.feasible_maps import HIGH, PIXEL, WIDE
from tests.oracles.feasible_tasks import MAPS, FeasibleTask

BLOCK = 128
"""States that torques are computed of at once."""


# --- what the script is given ---------------------------------------------------------------------


class CompiledRobot:
    """Srgc's equations of motion of the only structure of a task."""

    def __init__(self, file: Path, step: float, bound: float, count: int) -> None:
        program = program_of(file)
        task = next(iter(program.tasks.values()))
        family = family_of(program, task)
        model = next(candidates(family, module_bound(family, task), None)).model
        if model is None:
            raise SystemExit(f"{file} has no robot")
        space = parameter_space(model)
        self.bounds: tuple[Array, Array] = (space.lower, space.upper)
        system = controlled_system(robot_graph(model, task.gravity))
        n, p, self.constants = system.coordinates, system.parameters, system.constants
        q, v, a, theta = (ca.SX.sym(name, k) for name, k in zip("qvat", (n, n, n, p), strict=True))
        k, u = ca.SX.sym("k", len(self.constants)), ca.SX.sym("u", n)
        mass, forces = system.forces(q, v, ca.SX.zeros(system.inputs), theta, k)
        torques = ca.Function("torques", [q, v, a, theta, k], [mass @ a - forces])
        self._torques = BatchedFunction.of(
            ca.Function("torques", [ca.vertcat(q, v, a, theta), k], [mass @ a - forces])
        )
        self._torques((np.ones((BLOCK, 3 * n + p)),), self.constants)
        x = ca.vertcat(q, v)
        rates = ca.Function("rates", [x, u, theta, k], [ca.vertcat(v, ldl_solve(mass, forces + u))])
        sizes = n, p, len(self.constants)
        self._follow = _closed_loop(torques, rates, sizes, step, bound).mapaccum("follow", count)

    def torques(self, q: Array, v: Array, a: Array, lengths: Array) -> Array:
        """Inverse dynamics of K states."""
        rods = np.tile(lengths[lengths > 0], (len(q), 1))
        rows = np.concatenate([q, v, a, rods], axis=1)
        padded = np.concatenate([rows, np.repeat(rows[-1:], -len(rows) % BLOCK, axis=0)])
        return self._torques((padded,), self.constants)[: len(rows), :, 0]

    def follow(self, first: Array, columns: Array, lengths: Array) -> tuple[Array, Array]:
        """The simulated closed loop."""
        given = np.concatenate([lengths[lengths > 0], self.constants])
        rows = np.concatenate([columns, np.tile(given, (len(columns), 1))], axis=1)
        ends, told = (np.asarray(each.full()).T for each in self._follow(first, rows.T))
        size = len(first)
        between = told[:, : size * (PARTS - 1)].reshape(len(ends), PARTS - 1, size)
        states = np.concatenate([between, ends[:, None]], axis=1).reshape(-1, size)
        return np.concatenate([first[None], states]), told[:, size * (PARTS - 1) :]


def _closed_loop(
    torques: ca.Function, rates: ca.Function, sizes: tuple[int, int, int], step: float, bound: float
) -> ca.Function:
    """A step: the state at its end, and those within it with the torques."""
    n, p, c = sizes
    x, row = ca.MX.sym("x", 2 * n), ca.MX.sym("row", 5 * n + 2 + p + c)
    ends = np.cumsum([0, n, n, n, n, n, 1, 1, p, c]).tolist()
    q, v, middle, rate, change, stiffness, damping, theta, k = ca.vertsplit(row, ends)
    asked = change + stiffness * (q - x[:n]) + damping * (v - x[n:])
    u = ca.fmin(ca.fmax(torques(middle, rate, asked, theta, k), -bound), bound)
    h, states = step / PARTS, [x]
    for _ in range(PARTS):
        at = states[-1]
        k1 = rates(at, u, theta, k)
        k2 = rates(at + h / 2 * k1, u, theta, k)
        k3 = rates(at + h / 2 * k2, u, theta, k)
        k4 = rates(at + h * k3, u, theta, k)
        states.append(at + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return ca.Function("step", [x, row], [states[-1], ca.vertcat(*states[1:-1], u)])


def scene_of(task: FeasibleTask, bounds: tuple[Array, Array]) -> Scene:
    """What the specification says, in arrays."""
    chains_of = [reference.arm for reference in task.references]
    names = "".join(arm.axes for arm in chains_of)
    rods = np.array([length for arm in chains_of for length in arm.lengths])
    shortest, longest = (np.zeros(len(rods)) for _ in range(2))
    shortest[rods > 0], longest[rods > 0] = bounds
    half = np.concatenate([reference.half for reference in task.references])
    on_map, first, arms = task.family == MAPS, 0, []
    for arm in chains_of:
        arms.append((range(first, first + len(arm.axes)), arm.base))
        first += len(arm.axes)
    ordered = sorted(task.visits, key=lambda visit: visit.sample)
    stages = tuple(
        tuple((visit.arm, visit.low, visit.high) for visit in group)
        for _, group in groupby(ordered, key=lambda visit: visit.sample)
    )
    angles = np.array([block.angle for block in task.blocks], dtype=float)
    turns = np.zeros((len(angles), 3, 3))
    turns[:, 0, 0] = turns[:, 1, 1] = np.cos(angles)
    turns[:, 1, 0], turns[:, 0, 1] = np.sin(angles), -np.sin(angles)
    turns[:, 2, 2] = 1.0
    return Scene(
        tuple("xyz".index(axis.lower()) for axis in names),
        tuple(axis.isupper() for axis in names),
        tuple(arms), shortest, longest, np.zeros(len(half)) if on_map else -half, half, stages,
        turns,
        np.array([block.centre for block in task.blocks]).reshape(-1, 3),
        np.array([block.half for block in task.blocks]).reshape(-1, 3),
        _near(_occupied(task)) if on_map else None,
        chains_of[0].base[2] > 0, task.body, task.margin, task.bound,
        len(task.references[0].inputs), task.step, "reach Goal at rest" in task.text,
        "reach" not in task.text, 1.0 if on_map else task.margin / 0.01,
    )  # fmt: skip


def _occupied(task: FeasibleTask) -> Any:
    image = np.frombuffer(task.files["room.pgm"].split(b"255\n", 1)[1], dtype=np.uint8)
    return image.reshape(HIGH, WIDE)[::-1] == 0


def _near(occupied: Any) -> Array:
    """Squared distances from what is occupied, by centimetres of x and y."""
    from scipy.ndimage import distance_transform_edt

    size = round(100 * PIXEL)
    fine = np.kron(occupied.T, np.ones((size, size), dtype=bool))
    found: Array = np.maximum(distance_transform_edt(~fine) - 2**0.5, 0.0) ** 2
    return found


# --- the judge ------------------------------------------------------------------------------------


def fault(task: FeasibleTask, answer: Answer) -> str:
    """What a motion breaks, by the simulation that the tasks' own motions come from; or nothing."""
    if answer.inputs is None or answer.start is None or answer.lengths is None:
        return "none found"
    first, tips, bars = 0, list[Array](), list[Array]()
    for reference in task.references:
        own = slice(first, first + len(reference.arm.axes))
        first = own.stop
        # The specification has one payload, that of the first arm.
        arm = replace(
            reference.arm,
            lengths=tuple(answer.lengths[own].tolist()),
            payload=task.references[0].arm.payload,
        )
        states = _replayed(arm, answer.start[own], answer.inputs[:, own], task.step)
        q, v = np.split(states, 2, axis=1)
        least = 0 * reference.half if task.family == MAPS else -reference.half
        if not ((least <= q) & (q <= reference.half)).all():
            return "a joint leaves its range"
        if "reach Goal at rest" in task.text and np.abs(v[-1]).max() > 0.001:
            return "no rest at the end"
        starts, ends = (np.array(each) for each in zip(*map(arm.bars, q), strict=True))
        tips.append(ends[:, -1])
        bars.append(rod_chains.points_on(starts, ends) if task.body else ends[:, -1])
    if np.abs(answer.inputs).max() > task.bound * (1 + 1e-9):
        return "an input is above its bound"
    points = np.concatenate([each.reshape(-1, 3) for each in bars])
    away = task.margin if task.body else 0.0
    if any(block.distances(points).min() <= away for block in task.blocks):
        return "an obstacle is too near"
    if task.references[0].arm.base[2] > 0 and min(each[:, 2].min() for each in tips) < 0:
        return "an effector is below the floor"
    if task.family == MAPS:
        low = PIXEL * np.stack(np.nonzero(_occupied(task))[::-1], axis=1)
        at = tips[0][:, None, :2]
        gaps = np.linalg.norm(np.maximum(np.maximum(low - at, at - low - PIXEL), 0), axis=2)
        if gaps.min() <= task.margin:
            return "a wall is too near"
    return "" if _visited(task, tips) else "a region is missed"


def _replayed(arm: rod_chains.RodChain, start: Array, inputs: Array, step: float) -> Array:
    """States ``FINE`` times a step and at the end."""
    from scipy.integrate import solve_ivp

    grid = np.linspace(0.0, step, rod_chains.FINE + 1)
    states = [np.concatenate([start, 0 * start])]
    for u in inputs:
        found = solve_ivp(
            lambda _t, x, u=u: arm.slope(x, u), (0.0, step), states[-1],
            method="DOP853", rtol=1e-9, atol=1e-10, t_eval=grid,
        )  # fmt: skip
        states += list(found.y.T[1:])
    return np.array(states)


def _visited(task: FeasibleTask, tips: Sequence[Array]) -> bool:
    """Whether the regions are entered at samples, in order, and the target at the end."""
    size = 3 if task.references[0].arm.base[2] > 0 else 2
    at, last = 0, len(tips[0]) // rod_chains.FINE
    for visit in sorted(task.visits, key=lambda each: each.sample):
        spots = tips[visit.arm][:: rod_chains.FINE]
        middle, half = (visit.low + visit.high) / 2, (visit.high - visit.low) / 2
        inside = np.all((np.abs(spots - middle) <= half)[:, :size], axis=1)
        if visit.arm or visit.region not in ("Home", "Goal") or "reach" not in task.text:
            late = np.flatnonzero(inside[0 if visit.arm else at :])
            if not len(late) or (visit.region == "Home" and late[0]):
                return False
            at = at if visit.arm else at + int(late[0])
        elif not inside[0 if visit.region == "Home" else last]:
            return False
    return True
