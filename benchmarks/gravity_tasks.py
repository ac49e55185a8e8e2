"""Generated tasks under gravity: how many are found and verified, in which processor time.

The tasks are those of `tests/oracles/generated_gravity_tasks.py`, each feasible by an independent
simulation. `synth` ends after `--limit` seconds of processor time; what it finds is verified. Every
seed has a file under the folder of ``-o``, and what is there is not run again unless the text has
changed. So a run goes on where the last one ended, ``--part 1/2`` and ``--part 2/2`` may run side
by side, and ``--tree`` runs the code of another checkout on the same tasks.

    python benchmarks/gravity_tasks.py --seeds 1 2 3
    python benchmarks/gravity_tasks.py --tree ../parent -o out/gravity/parent --record parent.json
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from tests.oracles.generated_gravity_tasks import GravityTask, gravity_task

VERDICTS = {0: "found", 3: "impossible", 4: "unknown"}
"""By the exit status of `synth`."""
VERIFY_SECONDS = 300
"""The limit of a verification, in processor time."""


def limited(
    command: list[str],
    tree: Path,
    seconds: int,
    log: Path,
    program: tuple[str, ...] = ("-m", "srgc"),
) -> tuple[int, float]:
    """Exit status and processor seconds of a command of srgc that may use so many of them."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(tree)}
    with log.open("w", encoding="utf-8") as out:
        child = subprocess.Popen(
            [sys.executable, *program, *command],
            cwd=tree, stdout=out, stderr=subprocess.STDOUT, env=environment,
        )  # fmt: skip
        resource.prlimit(child.pid, resource.RLIMIT_CPU, (seconds, seconds + 5))
        _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, usage.ru_utime + usage.ru_stime


def result(task: GravityTask, tree: Path, folder: Path, limit: int) -> dict[str, Any]:
    """What a checkout makes of a task."""
    name = f"{task.seed:02}"
    spec, out = folder / f"{name}.srg", folder / name
    spec.write_text(task.text, encoding="utf-8")
    command = ["synth", str(spec), "-q", "--force", "-o", str(out)]
    status, seconds = limited(command, tree, limit, folder / f"{name}.log")
    told: dict[str, Any] = {
        "seed": task.seed,
        "text_sha256": hashlib.sha256(task.text.encode()).hexdigest(),
        "links": sum(length > 0 for length in task.arm.lengths),
        "space": task.arm.base[2] > 0,
        "verdict": VERDICTS.get(status, "out of time" if status < 0 else f"exit status {status}"),
        "cpu_seconds": round(seconds, 1),
    }
    if status == 0:
        claim = json.loads((out / "certificate.json").read_text(encoding="utf-8"))
        kinds = {item["kind"] for item in claim.get("claims", [])}
        status, seconds = limited(
            ["verify", str(out)], tree, VERIFY_SECONDS, folder / f"{name}-verify.log"
        )
        told["control"] = "feedback" if "controller" in kinds else "open loop"
        told["verified"] = status == 0
        told["verify_cpu_seconds"] = round(seconds, 1)
    return told


def known(file: Path, task: GravityTask) -> dict[str, Any] | None:
    """What an earlier run made of the same text."""
    if not file.exists():
        return None
    told: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return told if told["text_sha256"] == hashlib.sha256(task.text.encode()).hexdigest() else None


def line(told: dict[str, Any]) -> str:
    """A seed in a line of the table."""
    arm = f"{told['links']} links{', space' if told['space'] else ''}"
    proof = {True: "verified", False: "NOT VERIFIED", None: ""}[told.get("verified")]
    control = told.get("control", "")
    return (
        f"{told['seed']:>4}  {arm:<15}{told['verdict']:<14}{control:<11}{proof:<14}"
        f"{told['cpu_seconds']:>8.1f}"
    )


def command_line(title: str, seeds: int, limit: int, folder: str) -> argparse.ArgumentParser:
    """The options of a benchmark that runs a checkout on generated tasks."""
    parser = argparse.ArgumentParser(description=title)
    parser.add_argument("--seeds", nargs="*", type=int, default=list(range(1, seeds + 1)))
    parser.add_argument("--limit", type=int, default=limit, help="seconds of a synthesis")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the checkout whose code is run")
    parser.add_argument("--part", default="1/1", help="K/N: every Nth task, from the Kth on")
    parser.add_argument("--record", type=Path, help="write all that is known to this file")
    parser.add_argument("-o", type=Path, default=ROOT / "out" / folder, help="the folder")
    return parser


def record(file: Path | None, tree: Path, limit: int, results: list[dict[str, Any]]) -> None:
    """Write what is known of a checkout, if a file is named."""
    if file is None:
        return
    commit = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=tree, capture_output=True, text=True, check=True
    ).stdout.strip()
    content = {"commit": commit, "limit_cpu_seconds": limit, "tasks": results}
    file.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    options = command_line(str(__doc__), 20, 90, "gravity").parse_args()
    folder, tree = options.o.resolve(), options.tree.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    first, parts = map(int, options.part.split("/"))
    print(f"{machine()}\n\nseed  arm            verdict       control    proof            cpu s")
    results = list[dict[str, Any]]()
    for place, seed in enumerate(options.seeds):
        task, file = gravity_task(seed), folder / f"{seed:02}.json"
        told = known(file, task)
        if told is None and place % parts == first - 1:
            told = result(task, tree, folder, options.limit)
            file.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
        if told is not None:
            results.append(told)
            print(line(told), flush=True)
    good = sum(told.get("verified", False) for told in results)
    print(f"{good} of {len(results)} found and verified")
    record(options.record, tree, options.limit, results)


if __name__ == "__main__":
    main()
