"""Tasks that are feasible for certain: how many are found and verified, in which processor time.

The tasks are those of `tests/oracles/feasible_tasks.py`, each with a motion that does it by an
independent simulation; whatever is not found is a shortcoming of the search, and *impossible* is a
fault. `synth` ends after `--limit` seconds of processor time; what it finds is verified. Every task
has a file under the folder of ``-o``, and what is there is not run again unless the text has
changed: a run goes on where the last one ended, ``--part 1/2`` and ``--part 2/2`` may run side by
side, and ``--tree`` runs the code of another checkout on the same tasks.

    python benchmarks/completeness.py --families "two links" motors --seeds 1 2 3
    python benchmarks/completeness.py --tree ../parent -o out/parent --record parent.json
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterable
from pathlib import Path
from statistics import median
from typing import Any

from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from gravity_tasks import VERDICTS, VERIFY_SECONDS, command_line, limited, record

from tests.oracles.feasible_tasks import KINDS, FeasibleTask, feasible_task

Told = dict[str, Any]
GRACE = 10
"""Seconds."""
SYNTH = Path(__file__).with_name("synth_by_processor_time.py")
"""`srgc synth` with a limit of processor time."""


def digest(task: FeasibleTask) -> str:
    """Of all files of a task."""
    parts = (f"{name}\0".encode() + content for name, content in sorted(task.files.items()))
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def result(task: FeasibleTask, tree: Path, folder: Path, limit: int) -> Told:
    """What a checkout makes of a task."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in task.files.items():
        (folder / name).write_bytes(content)
    out = folder / "out"
    command = [str(folder / "task.srg"), "-q", "--force", "-o", str(out)]
    command += ["--time-limit", str(limit)]
    # The search ends itself, with what it has; a little later the system ends it.
    program = str(SYNTH), str(folder / "times.json")
    status, seconds = limited(command, tree, limit + GRACE, folder / "synth.log", program)
    told: Told = {
        "family": task.family,
        "seed": task.seed,
        "sha256": digest(task),
        "verdict": VERDICTS.get(status, "out of time" if status < 0 else f"exit status {status}"),
        "cpu_seconds": round(seconds, 1),
    }
    if status == 0:
        checked, spent = limited(["verify", str(out)], tree, VERIFY_SECONDS, folder / "verify.log")
        told["verified"] = checked == 0
        told["verify_cpu_seconds"] = round(spent, 1)
    elif status > 0:
        log = (folder / "synth.log").read_text(encoding="utf-8")
        told["reason"] = " ".join(log.split())[:400]
    return told


def known(file: Path, task: FeasibleTask) -> Told | None:
    """What an earlier run made of the same files."""
    if not file.exists():
        return None
    told: Told = json.loads(file.read_text(encoding="utf-8"))
    return told if told["sha256"] == digest(task) else None


def is_wrong(told: Told) -> bool:
    """Whether an answer is none that a feasible task may have."""
    return told["verdict"] not in ("found", "unknown", "out of time") or (
        told["verdict"] == "found" and not told["verified"]
    )


def print_table(results: Iterable[Told]) -> None:
    """A line per family, then what was not found."""
    every = list(results)
    print(f"\n{'family':<26}{'found':>9}{'wrong':>7}{'median s':>10}{'verify s':>10}")
    for family in [kind for kind in KINDS if any(told["family"] == kind for told in every)]:
        own = [told for told in every if told["family"] == family]
        good = [told for told in own if told.get("verified")]
        wrong = sum(map(is_wrong, own))
        times = [
            f"{median(told[key] for told in good):>10.1f}" if good else f"{'-':>10}"
            for key in ("cpu_seconds", "verify_cpu_seconds")
        ]
        print(f"{family:<26}{len(good):>5}/{len(own):<3}{wrong:>7}{''.join(times)}")
    good_count, wrong = sum(bool(t.get("verified")) for t in every), sum(map(is_wrong, every))
    print(f"{'all':<26}{good_count:>5}/{len(every):<3}{wrong:>7}")
    for told in every:
        if not told.get("verified"):
            why = told.get("reason", "")
            print(
                f"{told['family']} {told['seed']}: {told['verdict']}, {told['cpu_seconds']} s {why}"
            )


def main() -> None:
    title = __doc__.split("\n", maxsplit=1)[0]
    parser = command_line(title, 40, 60, "completeness")
    parser.add_argument("--families", nargs="*", choices=KINDS, default=list(KINDS))
    options = parser.parse_args()
    folder, tree = options.o.resolve(), options.tree.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    first, parts = map(int, options.part.split("/"))
    print(machine(), flush=True)
    results = list[Told]()
    # A seed of every family before the next: a run that is cut short knows something of all.
    pairs = [(family, seed) for seed in options.seeds for family in options.families]
    for place, (family, seed) in enumerate(pairs):
        if place % parts != first - 1:
            continue
        task = feasible_task(family, seed)
        own = folder / f"{family.replace(' ', '_')}-{seed:02}"
        file = own.with_suffix(".json")
        told = known(file, task)
        if told is None:
            told = result(task, tree, own, options.limit)
            file.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
        results.append(told)
        print(
            f"{family:<26}{seed:>4}  {told['verdict']:<12}{told['cpu_seconds']:>7.1f}", flush=True
        )
    print_table(results)
    record(options.record, tree, options.limit, results)


if __name__ == "__main__":
    main()
