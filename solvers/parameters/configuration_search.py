"""P.Synthesis for one structure and one path: parameters, then polishing, then timing.

GP-ACB finds a basin, the convex programs with the parameters as unknowns find its bottom, and the
steps at which cells are entered are then moved as long as that helps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from compiler.discretisation.float_reading import Array
from solvers.motions.control import FULL, ControlOutcome, Effort
from solvers.motions.path_following import Follower
from solvers.motions.path_timing import Entries
from solvers.parameters.evaluation import Evaluator, evaluate
from solvers.parameters.parameter_search import BayesianSearch, parameter_space
from solvers.progress import Conduct

ROUNDS = 4
BATCH = 2
BASINS = 2
SHIFTS = (4, -4, 1, -1)
LONGEST_RUN = 6
GAIN = 1e-4
RETIMING = Effort(10, 1e-4, 1e-8)
RETIMING_RADIUS = 0.1
RELEASES = (0.3, 0.3)
"""Trust regions of the attempts with the cells released."""
NARROWINGS = 3


@dataclass(frozen=True, slots=True)
class Configuration:
    """The best outcome for a path: its entry steps, the evaluations made, and its cells."""

    outcome: ControlOutcome
    entries: Entries
    evaluations: int
    cells: tuple[int, ...]


def search_configuration(follower: Follower, label: str, conduct: Conduct) -> Configuration:
    """The best configuration found for a path; it may be infeasible.

    ``label`` names the structure and path in the journal.
    """
    space = parameter_space(follower.model)
    entries = follower.waypoints()[1]
    best: list[ControlOutcome] = []
    evaluations = 0
    if space.is_point:
        outcome = evaluate(follower, space.lower, FULL)
        best, evaluations = [outcome], 1
        conduct.reporter.robustness(outcome.robustness)
    else:
        search = BayesianSearch(space, conduct.seed)
        with Evaluator(follower, conduct.jobs) as evaluator:
            _explore(search, evaluator, label, conduct)
            order = np.argsort(-np.array(search.values), kind="stable")[:BASINS]
            thetas = [space.from_cube(search.points[i]) for i in order]
            evaluations = len(search.points)
            for outcome in evaluator.batch(thetas):
                conduct.check_time()
                best.append(_polished(follower, outcome, entries, conduct))
    ranked = sorted(best, key=lambda outcome: -outcome.robustness)
    top = ranked[0]
    for outcome in ranked[:1] if top.feasible else ranked:
        freed = _freed(follower, outcome, entries, conduct)
        if freed is not None:
            top, entries, cells = freed
            follower = follower.along(cells, entries)
            break
    if top.feasible:
        top, entries = _timed(follower, top, entries, conduct)
    return Configuration(top, entries, evaluations, follower.cells)


def _explore(search: BayesianSearch, evaluator: Evaluator, label: str, conduct: Conduct) -> None:
    """Evaluate the initial design, then what the acquisition rule asks for."""
    _tell(search, search.initial(), evaluator, label, conduct)
    for _ in range(ROUNDS):
        points = search.ask(BATCH)
        if not points:
            break
        _tell(search, points, evaluator, label, conduct)


def _tell(
    search: BayesianSearch,
    points: list[Array],
    evaluator: Evaluator,
    label: str,
    conduct: Conduct,
) -> None:
    """Evaluate points, as far as the journal does not know them, and tell their values."""
    keys = [f"{label}|{np.array2string(point, precision=17)}" for point in points]
    known = [conduct.journal.recall(key) for key in keys]
    missing = [i for i, value in enumerate(known) if value is None]
    outcomes = evaluator.batch([search.space.from_cube(points[i]) for i in missing])
    for i, outcome in zip(missing, outcomes, strict=True):
        conduct.check_time()
        known[i] = outcome.robustness
        conduct.journal.record(keys[i], outcome.robustness)
        conduct.reporter.robustness(max(v for v in (*search.values, *known) if v is not None))
    for point, value in zip(points, known, strict=True):
        if value is not None:
            search.tell(point, value)


def _polished(
    follower: Follower, outcome: ControlOutcome, entries: Entries, conduct: Conduct
) -> ControlOutcome:
    """The outcome with its parameters made unknowns of the convex programs."""
    box = parameter_space(follower.model).free_box(outcome.trajectory.theta)
    polished = follower.solve(outcome.trajectory, entries, box, FULL)
    better = max(outcome, polished, key=lambda item: item.robustness)
    conduct.reporter.robustness(better.robustness)
    return better


def _freed(
    follower: Follower, outcome: ControlOutcome, entries: Entries, conduct: Conduct
) -> tuple[ControlOutcome, Entries, tuple[int, ...]] | None:
    """The outcome with free timing: release the cells, optimise, and read the path off.

    The half-planes keep the motion on its side of every obstacle, so it visits the path's cells or
    others next to them.  None where that is no path, or no better.
    """
    space = parameter_space(follower.model)
    best: tuple[ControlOutcome, Entries, tuple[int, ...]] | None = None
    for radius in RELEASES:
        conduct.check_time()
        start, timing = (outcome, entries) if best is None else best[:2]
        follower = follower if best is None else follower.along(best[2], best[1])
        box = None if space.is_point else space.free_box(start.trajectory.theta)
        free = follower.released(start.trajectory, timing, box, FULL, radius)
        visited = follower.visited(free.trajectory) if free.feasible else None
        if visited is None or free.robustness <= start.robustness + GAIN:
            break
        cells, entered = visited
        other = follower.along(cells, entered)
        trial = other.solve(free.trajectory, entered, box, FULL, RETIMING_RADIUS)
        if not trial.feasible or trial.robustness <= start.robustness + GAIN:
            break
        best = trial, entered, cells
        conduct.reporter.robustness(trial.robustness)
    return best


def _timed(
    follower: Follower, outcome: ControlOutcome, entries: Entries, conduct: Conduct
) -> tuple[ControlOutcome, tuple[int, ...]]:
    """Move entry steps, one at a time and on in the same direction, while the robustness grows."""
    moves = [(cell, shift) for shift in SHIFTS for cell in range(1, len(entries))]
    for cell, shift in moves:
        for _ in range(LONGEST_RUN):
            conduct.check_time()
            moved = _moved(entries, cell, shift)
            trial = _retimed(follower, outcome, moved) if follower.allows(moved) else None
            if trial is None or trial.robustness <= outcome.robustness + GAIN:
                break
            outcome, entries = trial, moved
            conduct.reporter.robustness(outcome.robustness)
    return outcome, entries


def _retimed(
    follower: Follower, outcome: ControlOutcome, entries: Entries
) -> ControlOutcome | None:
    """The outcome with other entry steps, where that is feasible."""
    space = parameter_space(follower.model)
    box = None if space.is_point else space.free_box(outcome.trajectory.theta)
    trial = follower.solve(outcome.trajectory, entries, box, RETIMING, RETIMING_RADIUS)
    return trial if trial.feasible else None


def _moved(entries: Entries, cell: int, shift: int) -> Entries:
    """The entry steps with one of them shifted."""
    return (*entries[:cell], entries[cell] + shift, *entries[cell + 1 :])


def within_limits(follower: Follower, found: Configuration) -> tuple[Follower, Configuration]:
    """A configuration whose motion keeps the limits of joints and rates within its steps too.

    The limits that it passes there are narrowed and the motion is found anew, a few times.
    """
    for _ in range(NARROWINGS):
        narrowed = follower.narrowed(found.outcome.trajectory) if found.outcome.feasible else None
        if narrowed is None:
            break
        follower = narrowed
        found = resolved(follower, found)
    return follower, found


def resolved(follower: Follower, found: Configuration) -> Configuration:
    """A configuration under other margins; the parameters may move along with the motion."""
    trajectory = found.outcome.trajectory
    space = parameter_space(follower.model)
    box = None if space.is_point else space.free_box(trajectory.theta)
    return replace(found, outcome=follower.solve(trajectory, found.entries, box))
