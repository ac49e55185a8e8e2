"""The scripts of refutations of many families, by every SMT solver that is named.

The families are those of `specs/`, those of the small specs of the tests, and random ones
(`tests/oracles/reaching_families.py`).  Each is refuted structure by structure (`--no-lemmas`),
within a limit of time, and each script that is kept is given to each solver, in a process of its
own.  Of a family with very many scripts, so many are taken at even distances.  All structures
that have a script are refuted, so an answer `sat` ends the benchmark with an error.

    python benchmarks/smt_agreement.py --solvers z3 cvc5 --seconds 60
    python benchmarks/smt_agreement.py --specs specs/walled_arm.srg --random 0 --no-small
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from timing import ROOT, SRGC, machine

sys.path.insert(0, str(ROOT))

from solvers.verifier.refutations.solver_process import SmtSolver, smt_solver
from tests.oracles import small_specs
from tests.oracles.reaching_families import reaching_family

WORDS = {"Holds": "sat", "Fails": "unsat", "Unknown": "none"}
GRACE = 60.0
"""Seconds beyond its limit after which a synthesis is ended."""
SMALL = ("BEYOND_REACH", "TOO_SHORT", "WITHOUT_LINK", "LOOPED", "WINDING")
"""Of the specs of the tests, those with robots that are refuted."""


@dataclass(frozen=True)
class Script:
    """The text of a script, the family that it is of, and its name there."""

    family: str
    name: str
    text: str


@dataclass(frozen=True)
class Asked:
    """What each solver answers to a script, and after how many seconds."""

    script: Script
    answers: tuple[str, ...]
    seconds: tuple[float, ...]


def families(options: argparse.Namespace, folder: Path) -> Iterator[tuple[str, Path]]:
    """Names of the families and the files of their specs."""
    for spec in sorted(options.specs):
        if spec.suffix == ".srg":
            yield spec.stem, spec.resolve()
    texts = {name.lower(): getattr(small_specs, name) for name in SMALL if not options.no_small}
    texts |= {f"random_{seed}": reaching_family(seed) for seed in range(options.random)}
    for name, text in texts.items():
        file = folder / f"{name}.srg"
        file.write_text(text, encoding="utf-8")
        yield name, file


def scripts(name: str, spec: Path, folder: Path, limit: float) -> list[Script]:
    """The scripts of one family, synthesised where that is not done."""
    out = folder / name
    if not out.exists():
        command = [*SRGC, "synth", str(spec), "-q", "--no-lemmas", "--time-limit", str(limit)]
        subprocess.run(
            [*command, "-o", str(out)],
            cwd=ROOT, capture_output=True, check=False, timeout=limit + GRACE,
        )  # fmt: skip
    found = sorted(out.glob("proofs/*.smt2"))
    return [Script(name, path.stem, path.read_text(encoding="utf-8")) for path in found]


def some(found: Sequence[Script], most: int) -> list[Script]:
    """At most so many, at even distances."""
    if len(found) <= most:
        return list(found)
    return [found[i * len(found) // most] for i in range(most)]


def asked(script: Script, solvers: Sequence[SmtSolver], seconds: float) -> Asked:
    """The answers of all solvers, one after the other."""
    answers, times = [], []
    for solver in solvers:
        started = time.perf_counter()
        answer = solver.run(script.text, seconds=seconds)
        times.append(time.perf_counter() - started)
        answers.append(WORDS[type(answer).__name__])
    return Asked(script, tuple(answers), tuple(times))


def collected(options: argparse.Namespace, folder: Path) -> tuple[Counter[str], list[Script]]:
    """How many different scripts each family has, and those that are asked about."""
    made: Counter[str] = Counter()
    chosen: list[Script] = []
    known: set[str] = set()
    for name, spec in families(options, folder):
        new = {s.text: s for s in scripts(name, spec, folder, options.limit) if s.text not in known}
        known.update(new)
        made[name] = len(new)
        chosen += some(list(new.values()), options.most)
    return made, chosen


# --- The report -----------------------------------------------------------------------------------


def group(family: str) -> str:
    """Random families share a line, as the small ones of the tests do."""
    if family.startswith("random_"):
        return "random families"
    return "small specs of the tests" if family.upper() in SMALL else family


def print_answers(made: Mapping[str, int], found: Sequence[Asked], names: Sequence[str]) -> None:
    """A line per family: scripts there are, scripts asked about, and who answers."""
    kinds = ["all", *(f"{name} alone" for name in names), "none"]
    lines: dict[str, Counter[str]] = defaultdict(Counter)
    for name, number in made.items():
        lines[group(name)]["made"] += number
    for each in found:
        lines[group(each.script.family)]["asked"] += 1
        lines[group(each.script.family)][kind(each, names)] += 1
    lines = {name: line for name, line in lines.items() if line["made"]}
    lines["all"] = sum(lines.values(), Counter())
    columns = ["made", "asked", *kinds]
    print(f"{'family':<26}" + "".join(f"{column:>12}" for column in columns))
    for name, line in lines.items():
        print(f"{name:<26}" + "".join(f"{line[column]:>12}" for column in columns))


def kind(each: Asked, names: Sequence[str]) -> str:
    """All solvers say unsat, one alone does, some do, or none."""
    said = [n for n, answer in zip(names, each.answers, strict=True) if answer == "unsat"]
    if len(said) == len(names):
        return "all"
    return "none" if not said else f"{said[0]} alone" if len(said) == 1 else "some"


def print_times(found: Sequence[Asked], names: Sequence[str]) -> dict[str, object]:
    """Seconds of each solver where all answer, and ratios to the first."""
    both = [each.seconds for each in found if set(each.answers) == {"unsat"}]
    figures: dict[str, object] = {}
    if not both:
        return figures
    print(f"\n{'where all answer':<26}{'median s':>12}{'largest s':>12}{'ratio':>12}")
    for number, name in enumerate(names):
        each = [seconds[number] for seconds in both]
        ratio = median(seconds[number] / seconds[0] for seconds in both)
        print(f"{name:<26}{median(each):12.3f}{max(each):12.2f}{ratio:12.2f}")
        figures[name] = {"median_s": median(each), "largest_s": max(each), "ratio": ratio}
    return figures


def print_apart(found: Sequence[Asked], names: Sequence[str]) -> dict[str, list[str]]:
    """The names of the scripts that not all solvers answer."""
    apart: dict[str, list[str]] = defaultdict(list)
    for each in found:
        if set(each.answers) != {"unsat"}:
            apart[f"{kind(each, names)}: {each.script.family}"].append(each.script.name)
    if apart:
        print("\nnot answered by all")
    for place, numbers in sorted(apart.items()):
        print(f"{place} {' '.join(numbers)}")
    return dict(apart)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--solvers", nargs="+", default=["z3", "cvc5"])
    parser.add_argument("--specs", nargs="*", type=Path, default=list((ROOT / "specs").glob("*")))
    parser.add_argument("--no-small", action="store_true", help="without specs of the tests")
    parser.add_argument("--random", type=int, default=12, help="how many random families")
    parser.add_argument("--most", type=int, default=1000, help="scripts of one family")
    parser.add_argument("--seconds", type=float, default=60.0, help="of each solver and script")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds of each synthesis")
    parser.add_argument("--scripts", type=Path, help="folder that keeps what is synthesised")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print(machine())
    solvers = [smt_solver(name) for name in options.solvers]
    names = [solver.name for solver in solvers]
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.scripts or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        made, chosen = collected(options, folder)
    found = [asked(script, solvers, options.seconds) for script in chosen]
    wrong = [each for each in found if "sat" in each.answers]
    print_answers(made, found, names)
    times = print_times(found, names)
    apart = print_apart(found, names)
    if options.json is not None:
        content = {
            "machine": machine(),
            "seconds": options.seconds,
            "solvers": names,
            "made": dict(made),
            "answers": Counter(" ".join(each.answers) for each in found),
            "times": times,
            "apart": apart,
        }
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    for each in wrong:
        said = ", ".join(f"{n} {a}" for n, a in zip(names, each.answers, strict=True))
        print(f"WRONG {each.script.family} {each.script.name}: {said}")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
