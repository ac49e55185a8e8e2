"""The benchmark set: tasks from the plane to seven joints, what solvers make of them, as a table.

Each task has a limit of processor time; what is found or refuted is verified.  Every answer has a
file under the folder of ``-o``, and what is there is not run again unless the task, the limit or
the command has changed: a run goes on where the last one ended, and ``--part 1/2`` and ``--part
2/2`` may run side by side.  At the end come the tables, and `index.md` and curves beside them.

    python benchmarks/srgc_bench.py                              # srgc on all tasks
    python benchmarks/srgc_bench.py --solvers srgc without_cores --tasks cells logic_key
    python benchmarks/srgc_bench.py --file mine.toml --solvers mine srgc
    python benchmarks/srgc_bench.py --ablation                   # srgc, and without each part
"""

from __future__ import annotations

import argparse
import hashlib
import json
from pathlib import Path
from typing import Any

from bench_solvers import TASKS, Solver, Task, run, solvers, tasks
from bench_tables import draw_curves, page
from timing import ROOT, machine

Told = dict[str, Any]


def digest(task: Task, solver: Solver, limit: int) -> str:
    """Of all that an answer depends on but the solver's code."""
    parts = task.path.read_bytes(), solver.command.encode(), str(limit).encode()
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def answered(solver: Solver, task: Task, folder: Path, limit: int, *, may_run: bool) -> Told | None:
    """The answer of a solver, from its file or from a run."""
    own = folder / solver.name / task.name
    file, key = own.with_suffix(".json"), digest(task, solver, limit)
    if file.exists():
        told: Told = json.loads(file.read_text(encoding="utf-8"))
        if told["digest"] == key:
            return told
    if not may_run:
        return None
    told = {"digest": key} | run(solver, task, own, limit)
    file.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    print(f"{solver.name:<20}{task.name:<26}{told['verdict']:<14}{told['cpu_seconds']:>8.1f} s"
          f"  {told.get('evidence', '')}", flush=True)  # fmt: skip
    return told


def chosen(names: list[str]) -> list[Task]:
    """The tasks of some names or families; all without any."""
    every = list(tasks().values())
    if unknown := set(names) - {name for each in every for name in (each.name, each.family)}:
        raise SystemExit(f"no task or family: {', '.join(sorted(unknown))}")
    return [each for each in every if not names or {each.name, each.family} & set(names)]


def command_line() -> argparse.ArgumentParser:
    """The options."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--solvers", nargs="+", default=["srgc"], help="by name")
    parser.add_argument("--ablation", action="store_true", help="all solvers of the file")
    parser.add_argument("--file", type=Path, action="append", default=[], help="more solvers")
    parser.add_argument("--tasks", nargs="*", default=[], help="names or families")
    parser.add_argument("--limit", type=int, default=60, help="seconds of processor time")
    parser.add_argument("--part", default="1/1", help="K/N: every Nth run, from the Kth on")
    parser.add_argument("--record", type=Path, help="write all answers to this file")
    parser.add_argument("-o", type=Path, default=ROOT / "out" / "srgc-bench", help="the folder")
    return parser


def main() -> None:
    options = command_line().parse_args()
    known = solvers(TASKS / "solvers.toml")
    for file in options.file:
        known |= solvers(file)
    names = list(known) if options.ablation else options.solvers
    if unknown := [name for name in names if name not in known]:
        raise SystemExit(f"no solver: {', '.join(unknown)}; there are {', '.join(known)}")
    folder, every = options.o.resolve(), chosen(options.tasks)
    for name in names:
        (folder / name).mkdir(parents=True, exist_ok=True)
    first, parts = map(int, options.part.split("/"))
    print(machine(), flush=True)
    answers: dict[str, dict[str, Told]] = {name: {} for name in names}
    for place, (task, name) in enumerate((task, name) for task in every for name in names):
        mine = place % parts == first - 1
        told = answered(known[name], task, folder, options.limit, may_run=mine)
        if told is not None:
            answers[name][task.name] = told
    content = {"machine": machine(), "limit_cpu_seconds": options.limit, "answers": answers}
    text = page(content)
    print(f"\n{text}")
    (folder / "index.md").write_text(text, encoding="utf-8")
    draw_curves(content, folder / "curves.svg")
    if options.record is not None:
        for told in (told for own in answers.values() for told in own.values()):
            told.pop("digest")
        options.record.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
