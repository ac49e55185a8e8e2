"""Measure one evaluation of the robustness against IPOPT and against loops over cvxpy.

Everybody has the same problem: seed, cells by sample, half-planes, Runge-Kutta step with substeps,
bounds of inputs; and has to find the same optimum.  What is made once per robot is not counted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from timing import ROOT, machine, seconds

sys.path.insert(0, str(ROOT))

from control_cases import Case, case, quarter_turn, shared_problem
from control_competitors import (
    Competitor,
    Found,
    cvxpy,
    fatrop,
    ipopt,
    ours,
    ours_in_cvxpy,
)
from control_curves import Curve, draw, exponent
from control_cvxpy import Form
from solver_time import counted

PROBLEMS: tuple[tuple[tuple[float, ...], int], ...] = (
    ((2.23, 3.35), 81),
    ((1.5, 2.5, 1.8), 160),
)
"""Lengths in metres, of two links the paper's, and steps."""
SMALL = (((2.23, 3.35), 41),)
TIMES_IPOPT, TIMES_FATROP, TIMES_CVXPY, SHARE = (15.0, 40.0), 3.0, 30.0, 0.7
"""So many times faster we are to be (IPOPT: by problem), and so much of the time is to pass inside
the solver."""
AGREEMENT = 1e-4
"""The relative difference of rho."""
LIMIT = 20.0
"""Seconds after which a competitor is not asked again."""
HORIZONS = (41, 81, 161, 321, 641, 1281)
LINKS = (1, 2, 3, 4, 5, 6)


def measured(competitors: Sequence[Competitor], rounds: int) -> tuple[list[Found], list[float]]:
    """Print a line each, the first is ours; what each found, and median ratios to the first."""
    times: dict[str, list[float]] = {each.name: [] for each in competitors}
    found: dict[str, Found] = {}

    def asked(each: Competitor) -> None:
        found[each.name] = each.call()

    for _ in range(rounds):
        for each in competitors:
            if sum(times[each.name]) < LIMIT:
                times[each.name].append(seconds(lambda e=each: asked(e)))
    mine = times[competitors[0].name]
    ratios = []
    for each in competitors:
        own = times[each.name]
        ratios.append(median(t / m for t, m in zip(own, mine, strict=False)))
        rho, iterations = found[each.name]
        print(
            f"  {each.name:<42}{median(own):>9.4f}{ratios[-1]:>8.1f}x{iterations:>8}{rho:>11.6f}"
            f"{each.made:>9.2f}",
            flush=True,
        )
    return [found[each.name] for each in competitors], ratios


@dataclass(frozen=True)
class Ratios:
    """How many times as long the others take, and the share of our time in the solver."""

    ipopt: float
    fatrop: float
    cvxpy: float
    share: float


def evaluation(one: Case, rounds: int) -> Ratios:
    """The table of a problem."""
    problem, rows, outcome = shared_problem(one)
    print(f"{one.name}: {len(rows.sample)} half-planes")
    print(f"  {'':<42}{'wall s':>9}{'ratio':>9}{'rounds':>8}{'rho':>11}{'made s':>9}")
    least = (1 - AGREEMENT) * outcome.robustness
    competitors = [
        ours(one, problem),
        ours(one, one.problem, "ours, half-planes chosen afresh"),
        ipopt(one, problem, rows, least),
        fatrop(one, problem, rows, least),
        *(cvxpy(one, problem, rows, form) for form in Form),
        ours_in_cvxpy(one, problem),
    ]
    found, ratios = measured(competitors, rounds)
    bound = problem.scale
    # The second one has other half-planes on its way, and may end with others.
    others = [found[0], *found[2:]]
    gap = max(abs(rho / found[0][0] - 1) for rho, _ in others)
    peak = bound - max(rho for rho, _ in others)
    more = (bound - found[0][0]) / peak - 1
    print(f"  optima differ by {gap:.1e} of rho; our peak effort is {more:+.1e} of the least")
    if gap > AGREEMENT:
        raise SystemExit("the optima differ")
    inside = share(competitors[0], rounds)
    return Ratios(ratios[2], ratios[3], min(ratios[4 : 4 + len(Form)]), inside)


def share(us: Competitor, rounds: int) -> float:
    """The part of our time that passes inside the convex solver; the median."""
    parts = []
    for _ in range(rounds):
        with counted() as counter:
            whole = seconds(us.call)
        parts.append(counter.seconds / whole)
    print(f"  inside the convex solver, its updates included: {100 * median(parts):.0f} %")
    return median(parts)


# --- growth -------------------------------------------------------------------------------------


def growth(what: str, cases: Sequence[tuple[int, Case]], rounds: int) -> Curve:
    """Times by size, with the exponents; half-planes are chosen afresh, as in a synthesis."""
    print(f"\n{what:<12}{'wall s':>9}{'rounds':>8}{'s a round':>11}{'rho':>11}")
    whole, each = [], []
    for size, one in cases:
        us = ours(one, one.problem)
        taken = median(seconds(us.call) for _ in range(rounds))
        rho, iterations = us.call()
        whole.append(taken)
        each.append(taken / iterations)
        print(f"{size:<12}{taken:>9.4f}{iterations:>8}{each[-1]:>11.5f}{rho:>11.6f}", flush=True)
    curve = Curve(what, tuple(size for size, _ in cases), tuple(whole), tuple(each))
    if len(cases) > 1:
        slopes = [exponent(curve.sizes, times)[0] for times in (curve.whole, curve.each)]
        print(f"exponent: {slopes[0]:.2f}, of the time a round {slopes[1]:.2f}")
    return curve


def main() -> None:
    """Measure and print tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--small", action="store_true", help="one small problem, no growth")
    parser.add_argument("--growth-only", action="store_true")
    parser.add_argument("--horizons", type=int, nargs="+", default=HORIZONS, help="steps")
    parser.add_argument("--links", type=int, nargs="+", default=LINKS)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.svg", help="growth as a picture")
    options = parser.parse_args()
    if options.rounds < 1 or min(*options.horizons, *options.links) < 1:
        parser.error("at least one round, step and link")
    print(machine())
    if not options.growth_only:
        print("one evaluation of the robustness; medians, and median ratios to the first line")
        problems = SMALL if options.small else PROBLEMS
        found = [evaluation(case(*problem), options.rounds) for problem in problems]
        if not options.small:
            required(found)
    if options.small:
        return
    lengths = PROBLEMS[0][0]
    curves = [
        growth("horizon", [(k, case(lengths, k)) for k in options.horizons], options.rounds),
        growth("links", [(n, quarter_turn(n)) for n in options.links], options.rounds),
    ]
    if options.output is not None:
        draw(curves, options.output)


def required(found: Sequence[Ratios]) -> None:
    """What is to be reached."""
    for times, (lengths, steps), each in zip(TIMES_IPOPT, PROBLEMS, found, strict=True):
        what = f"{len(lengths)} links, {steps} steps"
        _say(f"{what}: {times:.0f} times as fast as IPOPT", each.ipopt, times)
        _say(f"{what}: {TIMES_FATROP:.0f} times as fast as FATROP", each.fatrop, TIMES_FATROP)
    least = min(each.cvxpy for each in found)
    _say(f"{TIMES_CVXPY:.0f} times as fast as the quickest loop over cvxpy", least, TIMES_CVXPY)
    inside = min(each.share for each in found)
    reached = "reached" if inside >= SHARE else "MISSED"
    print(
        f"required: {100 * SHARE:.0f} % of the time inside the solver; {reached}, "
        f"{100 * inside:.0f} %"
    )


def _say(what: str, found: float, wanted: float) -> None:
    print(f"required: {what}; {'reached' if found >= wanted else 'MISSED'}, {found:.1f} times")


if __name__ == "__main__":
    main()
