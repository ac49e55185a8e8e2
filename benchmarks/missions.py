"""How few structures missions look at: random families whose answers brute force and algebra say.

Each family has all its robots in a layer for every task; lazy evaluation refutes and searches only
those on a cheapest way.  `looked` is how many structures were examined in all layers, `all` how
many there are.  The answers are compared with those of `tests/oracles/mission_families.py`: a wrong
one ends the run, a least cost that is not proved is told.

    python benchmarks/missions.py --first 0 --count 100 --json out/missions.json
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import tempfile
import time
from contextlib import redirect_stdout
from fractions import Fraction
from pathlib import Path
from statistics import median
from typing import Any

from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from solvers.verifier.missions.mission_check import verify_mission
from solvers.verifier.report import Outcome
from srgc.cli import run
from srgc.render import result_pictures
from tests.oracles.mission_families import MissionFamily

SHARE = 3
"""Lazy evaluation is to look at most at one part of so many of all structures."""


def measured(seed: int, folder: Path) -> dict[str, Any]:
    """What `srgc synth --mission` and the verifier say of a family."""
    family = MissionFamily(seed)
    spec, out = folder / f"mission{seed}.srg", folder / f"out{seed}"
    spec.write_text(family.text, encoding="utf-8")
    started = time.process_time()
    with redirect_stdout(io.StringIO()):
        run(["synth", str(spec), "--mission", "M", "-o", str(out), "-q"])
    seconds = time.process_time() - started
    design = json.loads((out / "design.json").read_text(encoding="utf-8"))
    log = json.loads((out / "log.json").read_text(encoding="utf-8"))
    started = time.process_time()
    if design["verdict"] != "unknown" and verify_mission(out).report.outcome is not Outcome.VALID:
        raise SystemExit(f"family {seed}: the result is not valid")
    checked = time.process_time() - started
    return {
        "seed": seed,
        "style": family.style,
        "kind": "one robot" if family.one_robot else "reconfigure",
        "tasks": len(family.tasks),
        "verdict": design["verdict"],
        "true": family.answer.verdict,
        "answer": judged(family, design["verdict"], out),
        "all": family.robots,
        "looked": log["examined"],
        "motions": log["motion searches"],
        "synth": seconds,
        "verify": checked,
    }


def judged(family: MissionFamily, verdict: str, out: Path) -> str:
    """Whether an answer is right, and its least proved; a wrong one ends the run."""
    true = family.answer
    if verdict == "unknown":
        return "unknown"
    if verdict != true.verdict:
        raise SystemExit(f"family {family.seed}: {verdict}, and it is {true.verdict}")
    if true.least is None:
        return "right"
    claim = json.loads((out / "mission.json").read_text(encoding="utf-8"))
    stated = claim["objectives"] or [{"value": claim["cost"], "least": claim["least"]}]
    least = [Fraction(each["least"]) for each in stated]
    if any(a > b for a, b in zip(least, true.least, strict=True)):
        raise SystemExit(f"family {family.seed}: {least} is claimed to be the least")
    if [Fraction(each["value"]) for each in stated] != list(true.least):
        return "dearer"
    return "right" if least == list(true.least) else "open"


def line(name: str, some: list[dict[str, Any]]) -> str:
    """A line of the table."""
    ratios = [each["looked"] / each["all"] for each in some]
    total = sum(each["looked"] for each in some) / sum(each["all"] for each in some)
    counts = [sum(each["answer"] == answer for each in some) for answer in ANSWERS]
    found = sum(each["verdict"] == "found" for each in some)
    return (
        f"{name:<24}{len(some):>5}{found:>7}{''.join(f'{count:>8}' for count in counts)}"
        f"{sum(each['all'] for each in some):>7}{sum(each['looked'] for each in some):>8}"
        f"{median(ratios):>8.2f}{total:>7.2f}{median(each['synth'] for each in some):>9.1f}"
        f"{median(each['verify'] for each in some):>8.2f}"
    )


ANSWERS = ("right", "open", "dearer", "unknown")
"""Open: the robots cost the least, which is not proved. Dearer: others cost less."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    for name in ("workspace_figure", "input_figure"):
        setattr(result_pictures, name, lambda *_: "<svg/>")
    print(machine())
    every = list[dict[str, Any]]()
    with tempfile.TemporaryDirectory() as scratch:
        for seed in range(options.first, options.first + options.count):
            every.append(measured(seed, Path(scratch)))
            print(f"{seed} {every[-1]['verdict']} {every[-1]['synth']:.1f} s", file=sys.stderr)
    print(
        f"{'families':<24}{'':>5}{'found':>7}{''.join(f'{answer:>8}' for answer in ANSWERS)}"
        f"{'all':>7}{'looked':>8}{'median':>8}{'total':>7}{'synth s':>9}{'verify':>8}"
    )
    for kind in ("one robot", "reconfigure"):
        print(line(kind, [each for each in every if each["kind"] == kind]))
    for style in dict.fromkeys(each["style"] for each in every):
        print(line(f"  {style}", [each for each in every if each["style"] == style]))
    for low, high in ((1, 11), (12, 31), (32, 10_000)):
        some = [each for each in every if low <= each["all"] <= high]
        label = f"  {low} to {high} robots" if high < 10_000 else f"  {low} robots and more"
        print(line(label, some) if some else f"{label:<24}{0:>5}")
    print(line("all", every))
    total = sum(each["looked"] for each in every) / sum(each["all"] for each in every)
    print(f"at most a part of {SHARE}: {'yes' if SHARE * total <= 1 else 'no'}")
    if options.json is not None:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        content = {"machine": machine(), "families": every}
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
