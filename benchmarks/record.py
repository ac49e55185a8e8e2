"""Run the benchmarks and keep what they print, for docs/reference/benchmarks.md.

A file per benchmark: its title, what it shows, the command, the number of cores, the load, the day
and the lines that were printed, but for the one about the machine.

    python benchmarks/record.py                     # all, into out/bench
    python benchmarks/record.py verify -o benchmarks/results
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Benchmark:
    """A benchmark: what it is called, what it shows, and its command without the interpreter."""

    title: str
    says: str
    command: str


BENCHMARKS = {
    "front_end": Benchmark(
        "Reading and checking",
        "A cold `srgc check`, and the stages on large generated files, against lark's bare parse.",
        "benchmarks/front_end.py",
    ),
    "startup": Benchmark(
        "Start of the commands",
        "The cold start of each command, against `import click`, and the size of an installation.",
        "benchmarks/startup.py",
    ),
    "language": Benchmark(
        "Words of languages",
        "Membership, against other parsers and automata libraries.",
        "benchmarks/language.py",
    ),
    "dynamics": Benchmark(
        "Linearisation",
        "One linearisation of an arm over all steps, against CasADi and Pinocchio.",
        "benchmarks/dynamics.py",
    ),
    "planning": Benchmark(
        "Planning",
        "A path through a graph of cells, building included, against z3, python-sat and Drake.",
        "benchmarks/planning.py",
    ),
    "partition": Benchmark(
        "Partition of workspaces",
        "Random rectangles into cells with adjacency, against TuLiP's library of polytopes.",
        "benchmarks/partition.py",
    ),
    "outgrown": Benchmark(
        "What users may outgrow",
        "Whole processes on up to 1,000 obstacles, 20,000 pixels, 6,000 steps, 3,025 structures.",
        "benchmarks/outgrown.py",
    ),
    "search": Benchmark(
        "Search of parameters",
        "Evaluations until a good design, of six methods, with intervals over 20 seeds.",
        "benchmarks/search.py --grid 41 13",
    ),
    "control": Benchmark(
        "Control synthesis",
        "The robustness of one arm on one path, against IPOPT, FATROP and cvxpy.",
        "benchmarks/control.py -o out/control/growth.svg",
    ),
    "codesign": Benchmark(
        "Lengths and torques together",
        "Against IPOPT with the lengths as unknowns.",
        "benchmarks/codesign.py",
    ),
    "verify": Benchmark(
        "Verification",
        "Verification against synthesis, and how it grows with links and steps.",
        "benchmarks/verify.py",
    ),
    "proofs": Benchmark(
        "Arithmetic of proofs",
        "Proofs about arms in space, in balls of doubles in machine code and in Arb's balls alone.",
        "benchmarks/proofs.py",
    ),
    "apart": Benchmark(
        "Robots that keep out of themselves",
        "Synthesis and verification of three arms in space, with the clause and without it.",
        "benchmarks/apart.py",
    ),
    "disturbed": Benchmark(
        "Disturbed motions",
        "Motions with feedback in MuJoCo, under disturbances at random and at corners, against the "
        "certified tube.",
        "benchmarks/disturbed.py",
    ),
    "tube_tightening": Benchmark(
        "Motion and gains for the tube",
        "Motion and gains chosen in turn, against both optimised together for the estimate of the "
        "tube, up to the proof.",
        "benchmarks/tube_tightening.py",
    ),
    "arch_closed_loop": Benchmark(
        "Networks as controllers",
        "The pendulums of ARCH-COMP, whose controllers are neural networks: enclosures of all "
        "motions, against simulations and published times.",
        "benchmarks/arch_closed_loop.py",
    ),
    "lemmas": Benchmark(
        "Lemmas",
        "Arms that are all too short, refuted with lemmas and structure by structure.",
        "benchmarks/lemmas.py",
    ),
    "path_cores": Benchmark(
        "Cores of paths",
        "Paths that cannot be followed, explained by cores, by an IIS as in SMC-LTL, or not.",
        "benchmarks/path_cores.py",
    ),
    "shared_parameters": Benchmark(
        "One robot for two tasks",
        "Random pairs of tasks: the better robot of each, consensus, and one program for both.",
        "benchmarks/shared_parameters.py",
    ),
    "modular_search": Benchmark(
        "Fewest modules, then the least time",
        "Arms of Timor's modules for two goals, against a lexicographic genetic search.",
        "benchmarks/modular_search.py",
    ),
    "base_placement": Benchmark(
        "Modules, place and motion at once",
        "The same with a base that may stand elsewhere.",
        "benchmarks/modular_search.py --placed",
    ),
    "missions": Benchmark(
        "Missions",
        "Random families with missions: answers against brute force, and how few structures are "
        "looked at.",
        "benchmarks/missions.py",
    ),
    "smt_agreement": Benchmark(
        "Scripts by two solvers",
        "All scripts of refutations of shipped, small and random families, by z3 and by cvc5.",
        "benchmarks/smt_agreement.py",
    ),
    "srgc_bench": Benchmark(
        "The benchmark set",
        "71 tasks, a few of them open: verdicts, evidence, processor times, gaps.",
        "benchmarks/srgc_bench.py",
    ),
    "case_study": Benchmark(
        "The case study",
        "`specs/planar_arm.srg` from the command line, and the parts of it.",
        "benchmarks/run.py",
    ),
}


def printed(command: list[str]) -> list[str]:
    """The lines that a benchmark prints, shown as they come, without the one about the machine."""
    lines = []
    with subprocess.Popen(
        [sys.executable, *command], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as child:
        for line in child.stdout or ():
            print(line, end="", flush=True)
            if " cores, " not in line:
                lines.append(line.rstrip())
    if child.returncode:
        sys.exit(f"{' '.join(command)} ended with {child.returncode}")
    return lines


def record(name: str, extra: list[str], folder: Path) -> None:
    """Run one benchmark and write its file."""
    benchmark = BENCHMARKS[name]
    command = [*benchmark.command.split(), *extra]
    print(f"\n== {' '.join(command)}", flush=True)
    content = {
        "title": benchmark.title,
        "says": benchmark.says,
        "command": f"python {' '.join(command)}",
        "machine": f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start",
        "date": time.strftime("%Y-%m-%d"),
        "output": printed(command),
    }
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content, indent=1, ensure_ascii=False)
    (folder / f"{name}.json").write_text(f"{text}\n", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help=f"of {', '.join(BENCHMARKS)}; none: all")
    parser.add_argument("-o", type=Path, default=ROOT / "out" / "bench", help="the folder")
    parser.add_argument("--with", dest="extra", default="", help='more options, as "--rounds 3"')
    options = parser.parse_args()
    for name in options.names or BENCHMARKS:
        record(name, options.extra.split(), options.o)


if __name__ == "__main__":
    main()
