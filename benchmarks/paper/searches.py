"""The searches of parameters on the case study: control syntheses themselves, seed by seed.

Every evaluation is the robustness of the arm with two links on the path that ``srgc plan`` finds,
as a synthesis evaluates it while it searches; of what cannot be followed it is minus the violation.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from math import comb
from pathlib import Path

import numpy as np
from search_methods import COMPARED
from search_runs import Saving, evaluations_to, saving, searched
from search_tables import arm, robustness

from compiler.arrays import Array
from paper.kept_records import digest, kept
from solvers.parameters.parameter_search import Cube

LINKS = 2
SHARE = 0.95
"""A search is to reach so much of the best value that any of them found."""
OURS, THEIRS = "gp-acb", "nelder-mead"
"""The paper's method, and the one that the paper compares it with."""


def search_runs(folder: Path, seeds: int, evaluations: int, jobs: int) -> list[Array]:
    """Per method, in the order of ``COMPARED``, the values (seeds, evaluations) in their order.

    Seeds that are in the folder are read, the others are searched and kept there.
    """
    asked = [(folder / f"seed-{seed:02d}.json", seed, evaluations) for seed in range(seeds)]
    if jobs == 1:
        records = [_record(*each) for each in asked]
    else:
        with ProcessPoolExecutor(jobs) as pool:
            records = list(pool.map(_record, *zip(*asked, strict=True)))
    return [np.array([record[method]["values"] for record in records]) for method in COMPARED]


def _record(path: Path, seed: int, evaluations: int) -> dict[str, dict[str, list[object]]]:
    of = {"spec": digest("planar_arm"), "evaluations": evaluations, "methods": [*COMPARED]}
    found: dict[str, dict[str, list[object]]] = kept(path, of, lambda: _searched(seed, evaluations))
    return found


def _searched(seed: int, evaluations: int) -> dict[str, dict[str, list[object]]]:
    """All methods with one seed; what two of them ask for is evaluated once."""
    known = dict[bytes, float]()
    began = time.process_time()

    def value(point: Array) -> float:
        key = point.tobytes()
        if key not in known:
            with np.errstate(all="ignore"):
                known[key] = robustness(LINKS, point)
        return known[key]

    found = dict[str, dict[str, list[object]]]()
    for method, make in COMPARED.items():
        points, values = searched(make(Cube((None,) * LINKS), seed), value, evaluations)
        lengths = [arm(LINKS).space.from_cube(point).tolist() for point in points]
        found[method] = {"lengths": lengths, "values": list(values)}
    took = time.process_time() - began
    print(f"seed {seed}: {len(known)} evaluations, {took:.1f} s", file=sys.stderr, flush=True)
    return found


@dataclass(frozen=True)
class Median:
    """The median of a sample, and an interval between two of its order statistics."""

    value: float
    low: float
    high: float


def median_of(values: Sequence[float] | Array) -> Median:
    """The median of a sample with its interval; ``coverage`` says how sure that is."""
    ordered = np.sort(np.asarray(values, dtype=np.float64))
    rank = order(len(ordered))[0]
    return Median(float(np.median(ordered)), float(ordered[rank - 1]), float(ordered[-rank]))


def order(count: int) -> tuple[int, float]:
    """The rank r of the interval from the r-th least to the r-th largest of so many values.

    The second is the probability with which it holds the median of the distribution, whatever that
    is: 95 % or more where so many values allow it, else that of the least and the largest.
    """

    def coverage(rank: int) -> float:
        return 1 - 2 * sum(comb(count, below) for below in range(rank)) / 2**count

    ranks = [rank for rank in range(1, (count + 1) // 2 + 1) if coverage(rank) >= SHARE]
    rank = max(ranks, default=1)
    return rank, coverage(rank)


@dataclass(frozen=True)
class Compared:
    """A method over all seeds: evaluations to the target, how many got there, the value at the end.

    ``saved`` is by which part GP-ACB's mean number of evaluations is smaller, None for itself.
    ``curve`` is the best value so far (seeds, evaluations).
    """

    method: str
    needed: Median
    reached: int
    best: Median
    saved: Saving | None
    curve: Array


def compared(runs: Sequence[Array]) -> tuple[float, list[Compared]]:
    """The best value of all runs, and the methods; ``runs`` (seeds, evaluations) by method."""
    best = max(float(values.max()) for values in runs)
    curves = dict(zip(COMPARED, (np.maximum.accumulate(v, axis=1) for v in runs), strict=True))
    counts = {
        method: [evaluations_to(SHARE * best, curve) for curve in curves[method]]
        for method in COMPARED
    }
    return best, [
        Compared(
            method,
            median_of(counts[method]),
            sum(count <= curve.shape[1] for count in counts[method]),
            median_of(curve[:, -1]),
            None if method == OURS else saving(counts[OURS], counts[method]),
            curve,
        )
        for method, curve in curves.items()
    ]
