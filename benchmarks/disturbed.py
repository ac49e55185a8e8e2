"""Many disturbed motions of designs with feedback in MuJoCo: how many leave the certified tube.

Every case is synthesised, verified, and simulated with its controller: starts, masses, measurements
and inputs are off at random and at corners (`srgc replay --disturbed`). Motions are done in shards,
a file each, under the folder of ``-o``; what is there is not done again unless the certificate has
changed. So a run goes on where the last one ended, and ``--part 1/2`` and ``--part 2/2`` may run
side by side.

    python benchmarks/disturbed.py --motions 1000
    python benchmarks/disturbed.py --motions 20 --cases planar_arm --timestep 0.001
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from timing import ROOT, SRGC, machine

sys.path.insert(0, str(ROOT))

from srgc.replays.disturbed_replay import USUAL_STEP, DisturbedRequest, disturbed_replay
from srgc.replays.replay_report import KINDS, disturbed_json
from tests.oracles.small_specs import replaced

SEED = 1
"""Of the disturbances."""
SHARD = 50
"""So many motions are a file."""


@dataclass(frozen=True)
class Case:
    """A specification with disturbances, and what they are, for people."""

    name: str
    text: str
    says: str


def shipped(name: str) -> str:
    """The text of a specification that comes with srgc."""
    return (ROOT / "specs" / f"{name}.srg").read_text(encoding="utf-8")


def cases() -> tuple[Case, ...]:
    """The cases, all without states of the modules' own, which MuJoCo does not have."""
    arm = replaced(
        shipped("planar_arm"),
        "  effort <= 10 N*m;\n",
        "  effort <= 10 N*m;\n  robust start 1 deg, 1 deg/s;\n  robust effort 1 % of bound;\n",
    )
    every = (
        "  control feedback;\n"
        "  robust start 0.2 deg, 0.2 deg/s;\n"
        "  robust effort 0.1 % of bound;\n"
        "  robust mass 0.5 %;\n"
        "  robust measure 0.02 deg, 0.05 deg/s;\n"
    )
    lines = shipped("robust_arm").splitlines(keepends=True)
    calm = "".join(line for line in lines if not line.strip().startswith("robust "))
    end = calm.rindex("}")
    flat = calm[:end] + every + calm[end:]
    hanging = calm[:end] + every + "  gravity (0, -3) m/s^2;\n" + calm[end:]
    all_kinds = (
        "start 0.2 deg, 0.2 deg/s; effort 0.1 % of bound; mass 0.5 %; measure 0.02 deg, 0.05 deg/s"
    )
    return (
        Case("planar_arm", arm, "start 1 deg, 1 deg/s; effort 1 % of bound"),
        Case("robust_arm", flat, all_kinds),
        Case("robust_arm-hanging", hanging, all_kinds),
    )


def chosen(options: argparse.Namespace) -> list[Case]:
    """Those of the options."""
    if options.specs:
        return [
            Case(path.stem, path.read_text(encoding="utf-8"), str(path)) for path in options.specs
        ]
    return [case for case in cases() if not options.cases or case.name in options.cases]


def found(case: Case, folder: Path, seconds: float) -> bool:
    """Whether a design is in the folder, after a search unless there is a certificate."""
    folder.mkdir(parents=True, exist_ok=True)
    result, spec = folder / "result", folder / "spec.srg"
    if (result / "certificate.json").exists() and spec.read_text(encoding="utf-8") == case.text:
        return True
    spec.write_text(case.text, encoding="utf-8")
    command = [*SRGC, "synth", str(spec), "-o", str(result), "-q", "--force"]
    command += ["--time-limit", str(seconds)]
    ran = subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL, check=False)
    return ran.returncode == 0


def shards(case: Case, folder: Path, options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """What is known of each shard, simulated if it is not known yet."""
    result = folder / "result"
    digest = hashlib.sha256((result / "certificate.json").read_bytes()).hexdigest()
    first, parts = map(int, options.part.split("/"))
    step = Fraction(repr(options.timestep))
    for place, begin in enumerate(range(0, options.motions, SHARD)):
        numbers = range(begin, min(begin + SHARD, options.motions))
        asked = {"certificate_sha256": digest, "seed": SEED, "first": begin, "step": str(step)}
        asked["motions"] = len(numbers)
        file = folder / f"motions-{begin:06}.json"
        known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        if known.get("asked") != asked:
            if place % parts != first - 1:
                continue
            begun = time.process_time()
            replayed = disturbed_replay(result, DisturbedRequest(numbers, SEED, step))
            known = {
                "asked": asked,
                "seconds": time.process_time() - begun,
                "found": json.loads(disturbed_json(replayed)),
            }
            file.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
            done = f"{case.name}: motions {begin} to {numbers[-1]}"
            print(f"{done}, {len(replayed.left)} left", file=sys.stderr, flush=True)
        yield known


def line(case: Case, known: Sequence[dict[str, Any]]) -> str:
    """A case in a line of the table."""
    motions = sum(each["asked"]["motions"] for each in known)
    left = sum(len(each["found"]["left"]) for each in known)
    shares = [max(each["found"][kind]["share"] for each in known) for kind in KINDS]
    error = max(each["found"][kind]["error"] for each in known for kind in KINDS)
    seconds = sum(each["seconds"] for each in known)
    shown = "".join(f"{100 * share:>10.1f} %" for share in shares)
    return f"{case.name:<24}{motions:>8}{left:>7}{shown}{error:>10.1e}{seconds:>9.0f}"


HEAD = (
    f"{'case':<24}{'motions':>8}{'left':>7}{'coordinates':>12}{'rates':>12}{'inputs':>12}"
    f"{'error':>10}{'cpu s':>9}"
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--motions", type=int, default=100, help="of each case")
    parser.add_argument("--cases", nargs="*", help="names; default all")
    parser.add_argument("--specs", nargs="*", type=Path, help="files, instead of the cases")
    parser.add_argument("--timestep", type=float, default=float(USUAL_STEP), help="s")
    parser.add_argument("--part", default="1/1", help="K/N: every Nth shard, from the Kth on")
    parser.add_argument("--synth-limit", type=float, default=900.0, help="s, for each design")
    parser.add_argument("-o", type=Path, default=ROOT / "out" / "disturbed", help="the folder")
    options = parser.parse_args()
    print(f"{machine()}\n\n{HEAD}", flush=True)
    left = 0
    asked = chosen(options)
    for case in asked:
        folder = options.o / case.name
        if not found(case, folder, options.synth_limit):
            print(f"{case.name:<24} no design was found", flush=True)
            continue
        known = list(shards(case, folder, options))
        if known:
            print(line(case, known), flush=True)
            left += sum(len(each["found"]["left"]) for each in known)
    print("\nlargest distances from the middle of the tube, as parts of those of its faces")
    for case in asked:
        print(f"{case.name}: {case.says}")
    if left:
        sys.exit(f"motions that left their tubes: {left}")


if __name__ == "__main__":
    main()
