"""Measure the verifier: against the time of synthesis, and as arms and horizons grow."""

from __future__ import annotations

import argparse
import contextlib
import io
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from control_curves import exponent
from timing import ROOT, SRGC, machine, process, seconds
from verify_arms import claimed_arm, end_radius

SPECS = ("planar_arm", "planar_arm_paper", "right_linear", "nested")
"""Shipped specs whose synthesis takes seconds."""
STEPS_OF_LINKS, LINKS_OF_STEPS = 20, 2


@dataclass(frozen=True)
class Compared:
    """Seconds of whole processes, then of calls in one process that has everything imported."""

    synth: float
    verify: float
    synth_call: float
    verify_call: float


def compared(spec: Path, scratch: Path) -> Compared:
    """One round: synthesis and verification of a spec, as processes and as calls.

    What a process needs for its start is in the difference.
    """
    from solvers.verifier.verification import Outcome, verify_directory
    from srgc.cli import run

    first, second = scratch / f"{spec.stem}-process", scratch / f"{spec.stem}-call"
    synth = process([*SRGC, "synth", str(spec), "-o", str(first), "--force"]).wall
    verify = process([*SRGC, "verify", str(first)]).wall

    def call() -> None:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            if run(["synth", str(spec), "-o", str(second), "--force"]):
                raise SystemExit(f"{spec}: nothing found")

    def check() -> None:
        if verify_directory(second).outcome is not Outcome.VALID:
            raise SystemExit(f"{second}: not valid")

    return Compared(synth, verify, seconds(call), seconds(check))


def print_comparison(specs: Sequence[Path], rounds: int, scratch: Path) -> None:
    """Medians and the medians of the ratios of the rounds; one call to warm up."""
    print(f"\n{'':<22}{'whole processes':^27}{'calls, all imported':^27}")
    heads = ("synth s", "verify s", "ratio")
    print(f"{'spec':<22}" + "".join(f"{head:>9}" for head in heads * 2), flush=True)
    compared(specs[0], scratch)
    for spec in specs:
        found = [compared(spec, scratch) for _ in range(rounds)]
        whole = median(r.verify / r.synth for r in found)
        inner = median(r.verify_call / r.synth_call for r in found)
        numbers = (
            median(r.synth for r in found), median(r.verify for r in found), whole,
            median(r.synth_call for r in found), median(r.verify_call for r in found), inner,
        )  # fmt: skip
        print(f"{spec.stem:<22}" + "".join(f"{number:>9.3f}" for number in numbers), flush=True)


def measured(links: int, steps: int, *, gravity: bool, rounds: int, scratch: Path) -> float:
    """Verify one arm, print its line, and give the median time."""
    from solvers.verifier.verification import Outcome, verify_directory

    folder = claimed_arm(scratch, links, steps, gravity=gravity)
    radius = end_radius(folder)

    def check() -> None:
        report = verify_directory(folder)
        if report.outcome is not Outcome.VALID:
            raise SystemExit(f"{links} links, {steps} steps: {report.outcome.value}")

    time = median(seconds(check) for _ in range(rounds))
    print(
        f"{links:>6}{steps:>7}{time:>10.3f}{1000 * time / steps:>12.2f}{radius:>12.1e}", flush=True
    )
    return time


def print_growth(
    what: str, pairs: Sequence[tuple[int, int]], options: argparse.Namespace, scratch: Path
) -> None:
    """One line per arm, and how the time grows."""
    gravity = options.gravity
    pull = "under gravity" if gravity else "without gravity"
    print(f"\nverification against the number of {what}, {pull}")
    print(f"{'links':>6}{'steps':>7}{'verify s':>10}{'ms a step':>12}{'radius':>12}", flush=True)
    times = [
        measured(links, steps, gravity=gravity, rounds=options.rounds, scratch=scratch)
        for links, steps in pairs
    ]
    sizes = [links if what == "links" else steps for links, steps in pairs]
    if len(set(sizes)) > 1:
        print(f"exponent {exponent(sizes, times)[0]:.2f}")


def main() -> None:
    """Measure and print tables."""
    options = _options()
    print(machine())
    with tempfile.TemporaryDirectory() as made:
        scratch = Path(made)
        if options.specs:
            files = [ROOT / "specs" / f"{name}.srg" for name in options.specs]
            print_comparison(files, options.rounds, scratch)
        if options.links:
            pairs = [(links, STEPS_OF_LINKS) for links in options.links]
            print_growth("links", pairs, options, scratch)
        if options.steps:
            pairs = [(LINKS_OF_STEPS, steps) for steps in options.steps]
            print_growth("steps", pairs, options, scratch)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--specs", nargs="*", default=SPECS, help="of specs/; none: leave out")
    parser.add_argument("--links", nargs="*", type=int, default=[1, 2, 3, 4, 5])
    parser.add_argument("--steps", nargs="*", type=int, default=[20, 40, 80, 160, 320, 640])
    parser.add_argument("--gravity", action="store_true", help="for the growth")
    options = parser.parse_args()
    if options.rounds < 1 or min([*options.links, *options.steps], default=1) < 1:
        parser.error("at least one round, one link and one step")
    return options


if __name__ == "__main__":
    main()
