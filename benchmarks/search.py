"""Measure how many evaluations the parameter searches need, on functions and on robustness.

An evaluation of the robustness takes far longer than any search thinks, so evaluations are counted
and no time.  The robustness is tabulated once, and searched by multilinear interpolation.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from search_curves import draw
from search_functions import (
    NOISE,
    SHARE,
    Objective,
    ackley,
    lifted,
    rastrigin,
    robustness_table,
)
from search_methods import COMPARED
from search_runs import CLAIM, Saving, evaluations_to, mean_saving, saving, searched
from search_tables import table
from timing import ROOT, machine

from compiler.arrays import Array
from solvers.parameters.parameter_search import Cube

SMALL = (13, 5)
"""Lengths per link of the tables that are made unless others are asked for."""
FUNCTIONS = (("Rastrigin", rastrigin), ("Ackley", ackley))


@dataclass(frozen=True)
class Run:
    """One search: a function, a method and a seed."""

    objective: Objective
    method: str
    seed: int


def values_of(run: Run) -> Array:
    """The best value so far, without noise, after each evaluation; evaluations one by one."""
    objective = run.objective.of_seed(run.seed)
    search = COMPARED[run.method](Cube((None,) * objective.dimension), run.seed)
    rng = np.random.default_rng(run.seed)
    _, found = searched(
        search, objective.value, objective.budget, lambda: objective.noise * rng.normal()
    )
    return np.maximum.accumulate(found)


def report(objective: Objective, curves: Mapping[str, Array]) -> dict[str, Saving]:
    """Print the lines of a function; GP-ACB's saving of evaluations by the other method."""
    counts = {
        method: [evaluations_to(objective.target, run) for run in runs]
        for method, runs in curves.items()
    }
    print(f"\n{objective.name}: best {objective.best:.4g}, to reach {objective.target:.4g}")
    saved: dict[str, Saving] = {}
    for method, needed in counts.items():
        low, middle, high = (_count(q, objective.budget, needed) for q in (25, 50, 75))
        reached = sum(count <= objective.budget for count in needed)
        regret = float(np.median(objective.best - curves[method][:, -1]))
        note = ""
        if method != "gp-acb" and "gp-acb" in counts:
            saved[method] = saving(counts["gp-acb"], needed)
            note = f"{saved[method].text:>18} %"
        share = f"{reached}/{len(needed)}"
        print(f"  {method:<22}{low:>6}{middle:>8}{high:>6}{share:>9}{regret:>12.4g}{note}")
    return saved


def _count(quantile: float, budget: int, needed: list[int]) -> str:
    value = float(np.percentile(needed, quantile, method="higher"))
    return f"> {budget}" if value > budget else f"{value:.0f}"


def objectives(options: argparse.Namespace) -> list[Objective]:
    """What is searched."""
    found = []
    if options.only != "functions":
        for links, side in zip((2, 3), options.grid, strict=True):
            name = f"robustness, {links} links, table {' x '.join([str(side)] * links)}"
            values = table(links, side, options.tables)
            found.append(robustness_table(name, values, 30 * links))
    for p in (2, 4) if options.only != "robustness" else ():
        found += [lifted(name, function, p, 20 * p + 20) for name, function in FUNCTIONS]
    return found


def main() -> None:
    """Measure and print tables."""
    options = _options()
    print(machine())
    print(
        f"evaluations to {100 * SHARE:.0f} % of the best known value. Functions are lifted so that "
        "their worst value is 0, their optimum\nlies elsewhere for every seed, and their noise has "
        f"a deviation of {100 * NOISE:.0f} % of it. {options.seeds} seeds: the quartiles of the\n"
        "evaluations, how many runs got there, the median regret at the end, and by how much the "
        "mean number of\nevaluations of gp-acb is smaller, where a run that does not get there "
        "counts as its length."
    )
    if options.only != "functions":
        print("The robustness is the multilinear interpolation of a table of real evaluations.")
    head = f"{'25 %':>6}{'median':>8}{'75 %':>6}{'there':>9}{'regret':>12}{'acb fewer':>20}"
    print(f"  {'':<22}{head}")
    methods = [name for name in COMPARED if not options.methods or name in options.methods]
    asked = objectives(options)
    runs = [Run(o, m, s) for o in asked for m in methods for s in range(options.seeds)]
    with ProcessPoolExecutor(options.jobs) as pool:
        curves = list(pool.map(values_of, runs))
    regrets: dict[str, dict[str, Array]] = {}
    savings: list[dict[str, Saving]] = []
    for objective in asked:
        by_method = {
            method: np.array(
                [
                    curve
                    for run, curve in zip(runs, curves, strict=True)
                    if run.objective is objective and run.method == method
                ]
            )
            for method in methods
        }
        savings.append(report(objective, by_method))
        regrets[objective.name] = {m: objective.best - c for m, c in by_method.items()}
    _claim(savings)
    if options.curves is not None:
        draw(regrets, options.curves)


def _claim(savings: list[dict[str, Saving]]) -> None:
    """What is true of the paper's comparison."""
    print()
    for other in ("nelder-mead", "gp-ucb"):
        found = [saved[other] for saved in savings if other in saved]
        if found:
            print(f"gp-acb against {other}, fewer evaluations in %, and 95 % intervals: ", end="")
            print(", ".join(each.text for each in found), end="; ")
            print(f"mean {mean_saving(found).text}")
    found = [saved["nelder-mead"] for saved in savings if "nelder-mead" in saved]
    if found:
        low, high = (100 * part for part in CLAIM)
        lows, highs = zip(*(each.interval for each in found), strict=True)
        print(
            f"the paper claims {low:.0f} to {high:.0f} % fewer than Nelder-Mead. Of {len(found)} "
            f"intervals {sum(x > CLAIM[1] for x in lows)} lie above that, "
            f"{sum(x < CLAIM[0] for x in highs)} below, "
            f"{sum(x <= CLAIM[1] and y >= CLAIM[0] for x, y in zip(lows, highs, strict=True))} "
            f"meet it; {sum(x > 0 for x in lows)} lie above 0"
        )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--methods", nargs="*", choices=list(COMPARED), default=[])
    parser.add_argument("--grid", type=int, nargs=2, default=SMALL, metavar=("TWO", "THREE"),
                        help="lengths per link in the tables of 2 and of 3 links")  # fmt: skip
    parser.add_argument("--tables", type=Path, default=ROOT / "out" / "search", metavar="DIR",
                        help="where tables are kept; what is not there is made")  # fmt: skip
    parser.add_argument("--only", choices=["robustness", "functions"], help="of the two kinds")
    parser.add_argument("--curves", type=Path, metavar="FILE.svg", help="regret as a picture")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    if options.seeds < 1 or options.jobs < 1 or min(options.grid) < 2:
        parser.error("at least one seed, one job, and two lengths per link")
    return options


if __name__ == "__main__":
    main()
