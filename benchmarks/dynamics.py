"""Measure one linearisation of an arm over all steps, against what a Python user would do instead.

Value and Jacobians of the Runge-Kutta step at 81 samples, for arms of 2, 3, 4 and 6 links.
"""

from __future__ import annotations

import argparse
import sys
from statistics import median
from typing import Any

from timing import ROOT, machine

sys.path.insert(0, str(ROOT))  # the builder of arms is among the tests' oracles

from linearisations import (
    Competitor,
    best_expansion,
    disagreement,
    duration,
    ours,
    pinocchio_loop,
    samples,
)

from tests.oracles.robots import rod_chain

LINKS, STEPS = (2, 3, 4, 6), 81
LEAST = 3.0
"""So many times faster than the expansion we are to be, at every size."""
AGREEMENT = 1e-9


def compared(us: Competitor, other: Competitor, rounds: int) -> tuple[float, float, float]:
    """Median seconds of both, measured in turn, and the median of the ratios."""
    gap = disagreement(us.call(), other.call())
    if not gap <= AGREEMENT:
        raise SystemExit(f"the answers differ by {gap:.1e}")
    pairs = [(duration(us.call), duration(other.call)) for _ in range(rounds)]
    return median(a for a, _ in pairs), median(b for _, b in pairs), median(b / a for a, b in pairs)


def _pinocchio() -> Any:
    try:
        import pinocchio
    except ImportError:
        return None
    return pinocchio


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--links", type=int, nargs="+", default=LINKS)
    parser.add_argument("--steps", type=int, default=STEPS)
    options = parser.parse_args()
    if min(options.rounds, options.steps, *options.links) < 1:
        parser.error("at least one round, step and link")
    pin = _pinocchio()
    print(machine())
    print(f"one linearisation over {options.steps} steps; ours has the Jacobian in theta always")
    print(f"{'':<46}{'ours ms':>9}{'theirs ms':>11}{'ratio':>8}{'made ms':>10}{'theirs':>9}")
    least = float("inf")
    for links in options.links:
        model, at = rod_chain(links), samples(links, options.steps)
        us = ours(model, at)
        others = [
            ("CasADi, expanded, x and u", best_expansion(model, at, theta=False)),
            ("CasADi, expanded, x, u and theta", best_expansion(model, at, theta=True)),
        ]
        if pin is not None:
            others.append(("Pinocchio in a loop, x and u", pinocchio_loop(pin, at)))
        for what, other in others:
            mine, theirs, ratio = compared(us, other, options.rounds)
            if what.startswith("CasADi"):
                least = min(least, ratio)
            print(
                f"{links} links, {what:<37}{1e3 * mine:>9.3f}{1e3 * theirs:>11.3f}{ratio:>7.1f}x"
                f"{1e3 * us.built:>10.0f}{1e3 * other.built:>9.0f}",
                flush=True,
            )
    if pin is None:
        print("Pinocchio is not installed: make .venv/oracles")
    if options.steps != STEPS:
        return
    verdict = "reached" if least >= LEAST else "MISSED"
    print(
        f"required: {LEAST:.0f} times as fast as CasADi's expansion; {verdict}, {least:.1f} times"
    )


if __name__ == "__main__":
    main()
