"""All refutation scripts of the shipped families, by every SMT solver that is named.

Each specification is refuted structure by structure (`--no-lemmas`), within a limit of time, and
each script that is kept is given to each solver, in a process of its own.

    python benchmarks/smt_agreement.py --solvers z3 cvc5 --seconds 20
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from statistics import median

from timing import ROOT, SRGC, machine

sys.path.insert(0, str(ROOT))

WORDS = {"Holds": "sat", "Fails": "unsat", "Unknown": "none"}


def scripts(specs: list[Path], folder: Path, limit: float) -> list[tuple[str, str]]:
    """Names and texts of the scripts of some specifications, each text once."""
    found: dict[str, str] = {}
    for spec in specs:
        command = [*SRGC, "synth", str(spec), "-q", "--no-lemmas", "--time-limit", str(limit)]
        out = folder / spec.stem
        subprocess.run([*command, "-o", str(out)], capture_output=True, check=False)
        for path in sorted(out.glob("proofs/*.smt2")):
            found.setdefault(path.read_text(encoding="utf-8"), f"{spec.stem} {path.stem}")
    return [(name, text) for text, name in found.items()]


def main() -> None:
    from solvers.verifier.refutations.solver_process import smt_solver

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--solvers", nargs="+", default=["z3", "cvc5"])
    parser.add_argument("--specs", nargs="+", type=Path, default=sorted((ROOT / "specs").glob("*")))
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--limit", type=float, default=60.0, help="Seconds of each synthesis.")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print(machine())
    solvers = [smt_solver(name) for name in options.solvers]
    specs = [spec for spec in options.specs if spec.suffix == ".srg"]
    with tempfile.TemporaryDirectory() as scratch:
        asked = scripts(specs, Path(scratch), options.limit)
    times: dict[str, list[float]] = {solver.name: [] for solver in solvers}
    answers: Counter[tuple[str, ...]] = Counter()
    alone: dict[str, list[str]] = {}
    for name, text in asked:
        found = []
        for solver in solvers:
            started = time.perf_counter()
            answer = WORDS[type(solver.run(text, seconds=options.seconds)).__name__]
            times[solver.name].append(time.perf_counter() - started)
            found.append(answer)
        answers[tuple(found)] += 1
        if len(set(found)) > 1:
            alone[name] = found
    for solver in solvers:
        each = times[solver.name]
        print(f"{solver.name:8}{len(each):6} scripts, median {median(each):.3f} s, "
              f"largest {max(each):.2f} s")  # fmt: skip
    for found, count in answers.most_common():
        said = ", ".join(f"{s.name} {a}" for s, a in zip(solvers, found, strict=True))
        print(f"{count:6} {said}")
    for name, found in alone.items():
        print(f"  {name}: {' '.join(found)}")
    if options.json is not None:
        content = {
            "machine": machine(),
            "solvers": [solver.name for solver in solvers],
            "scripts": len(asked),
            "answers": [[list(found), count] for found, count in answers.most_common()],
            "apart": alone,
            "median_s": {name: round(median(each), 4) for name, each in times.items()},
            "largest_s": {name: round(max(each), 3) for name, each in times.items()},
        }
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
