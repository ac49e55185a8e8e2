"""Tasks that are feasible for certain, by `srgc synth` and by a script that a user would write.

The tasks are those of `completeness.py`.  The script (``user_script_motions.py`` and
``user_script_planner.py``) may use as much processor time as `synth`; it is given the robot as srgc
has compiled it, which is not counted.  What it finds is judged by a simulation that shares no code
with either.  Results by task are kept in the folder of ``-o``.

    python benchmarks/user_script.py --families "two links" --seeds 1 2
    pip install --target FOLDER ompl toppra
    python benchmarks/user_script.py --libraries FOLDER
    python benchmarks/user_script.py --libraries FOLDER --ways     # the planners alone
"""

from __future__ import annotations

import argparse
import json
import os
import pickle
import resource
import site
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from completeness import GRACE, digest
from gravity_tasks import VERDICTS, VERIFY_SECONDS, command_line, limited
from timing import ROOT, machine, process
from user_script_motions import chains, solve
from user_script_planner import Array, Planner, Scene, ompl_connect, rrt_connect
from user_script_task import CompiledRobot, fault, scene_of

sys.path.insert(0, str(ROOT))

from tests.oracles.feasible_tasks import KINDS, FeasibleTask, feasible_task

Told = dict[str, Any]
HERE = Path(__file__).resolve().parent
SIDES = ("own", "ompl")
"""The planners of the script."""
WAY_SECONDS = 5.0
"""For a way, where planners are compared."""


# --- processes ------------------------------------------------------------------------------------


def peer(folder: Path, side: str, limit: float) -> Told:
    """The script in this process: what it finds, its seconds, and what the judge says."""
    task: FeasibleTask = pickle.loads((folder / "task.pickle").read_bytes())
    begun = time.process_time()
    steps = len(task.references[0].inputs)
    robot = CompiledRobot(folder / "task.srg", task.step, task.bound, steps)
    compiled, begun = time.process_time() - begun, time.process_time()
    scene = scene_of(task, robot.bounds)
    if side == "ways":
        return {"ways": ways(scene, task.seed)}
    planner = ompl_connect() if side == "ompl" else rrt_connect
    loaded = time.process_time() - begun
    answer = solve(scene, robot, planner, task.seed, limit - loaded)
    wrong = fault(task, answer)
    return {
        "found": not wrong,
        "reason": wrong,
        "cpu_seconds": round(answer.seconds + loaded, 3),
        "planning_cpu_seconds": round(answer.geometry, 3),
        "planned": answer.planned,
        "rounds": answer.rounds,
        "by": answer.by,
        "compiled_cpu_seconds": round(compiled, 3),
    }


def ways(scene: Scene, seed: int) -> list[Told]:
    """Planners on the same pairs of poses, between which straight ways are not clear."""
    rng, pairs = np.random.default_rng(seed), list[tuple[Array, Array, Array]]()
    for _ in range(10):
        for chain in chains(scene, rng):
            one, other = chain.nodes[:-1], chain.nodes[1:]
            hit = scene.clear(one, other, chain.lengths) < 1.0
            pairs += [(chain.lengths, *both) for both in zip(one[hit], other[hit], strict=True)]
    planners: dict[str, Planner] = {
        "own": rrt_connect,
        "ompl": ompl_connect(),
        "ompl by states": ompl_connect(edges=False),
    }
    found = list[Told]()
    for lengths, one, other in pairs[:5]:
        told: Told = {}
        for name, planner in planners.items():
            begun = time.process_time()
            way = planner(scene, lengths, one, other, rng, WAY_SECONDS)
            told[name] = None if way is None else round(time.process_time() - begun, 4)
        found.append(told)
    return found


def child(folder: Path, side: str, options: argparse.Namespace) -> Told:
    """The same in a process of its own."""
    out = folder / f"{side}.json"
    out.unlink(missing_ok=True)
    command = [sys.executable, str(HERE / "user_script.py"), "--child", side, "-o", str(folder)]
    command += ["--limit", str(options.limit)]
    command += ["--libraries", str(options.libraries)] if options.libraries else []
    with (folder / f"{side}.log").open("w", encoding="utf-8") as log:
        subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, env=ENVIRONMENT, check=False)
    if not out.exists():
        raise SystemExit((folder / f"{side}.log").read_text(encoding="utf-8"))
    told: Told = json.loads(out.read_text(encoding="utf-8"))
    return told


ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def ours(folder: Path, limit: int, tree: Path) -> Told:
    """`synth` and `verify`, and when the first motion and the first design were there."""
    times, out = folder / "ours_times.json", folder / "out"
    times.unlink(missing_ok=True)
    command = [sys.executable, str(HERE / "synth_by_processor_time.py"), str(times)]
    command += [str(folder / "task.srg"), "-q", "--force", "-o", str(out)]
    with (folder / "ours.log").open("w", encoding="utf-8") as log:
        run = subprocess.Popen(
            [*command, "--time-limit", str(limit)], cwd=tree, stdout=log,
            stderr=subprocess.STDOUT, env={**ENVIRONMENT, "PYTHONPATH": str(tree)},
        )  # fmt: skip
        resource.prlimit(run.pid, resource.RLIMIT_CPU, (limit + GRACE, limit + GRACE + 5))
        _, status, usage = os.wait4(run.pid, 0)
    run.returncode = os.waitstatus_to_exitcode(status)
    at = json.loads(times.read_text(encoding="utf-8")) if times.exists() else {}
    if "design" in at:
        at.setdefault("motion", at["design"])
    told: Told = {
        "found": False,
        "reason": VERDICTS.get(run.returncode, "out of time"),
        "cpu_seconds": round(usage.ru_utime + usage.ru_stime, 3),
        **{
            f"{key}_cpu_seconds": round(at[key], 3)
            for key in ("loaded", "motion", "design")
            if key in at
        },
    }
    if run.returncode == 0:
        checked, spent = limited(["verify", str(out)], tree, VERIFY_SECONDS, folder / "verify.log")
        told |= {"found": checked == 0, "reason": "", "verify_cpu_seconds": round(spent, 3)}
    return told


# --- the table ------------------------------------------------------------------------------------


def start_up() -> float:
    """Processor seconds of the start and the imports of the script, which every run of it has."""
    line = f"import sys; sys.path.insert(0, {str(HERE)!r}); import user_script_motions"
    return median(process([sys.executable, "-c", line]).cpu for _ in range(5))


def table(results: Sequence[Told]) -> list[str]:
    """A line per family: what is found, and medians over what both ours and own find."""
    heads = ["ours", *SIDES, "motion", "design", "synth", "verify", *SIDES]
    heads += ["motion", "synth", "ompl", "work"]
    lines = [
        f"{'':<26}{'found':^18}{'median cpu s where both find':^48}{'times own':>18}",
        f"{'family':<26}" + "".join(f"{head:>{6 + 2 * (i > 2)}}" for i, head in enumerate(heads)),
    ]
    for family in [*KINDS, "all"]:
        every = [told for told in results if family in (told["family"], "all")]
        if not every:
            continue
        line = f"{family:<26}"
        for side in ("ours", *SIDES):
            known = [told[side]["found"] for told in every if side in told]
            line += f"{f'{sum(known)}/{len(known)}':>6}" if known else f"{'-':>6}"
        both = [told for told in every if all(told[side]["found"] for side in ("ours", "own"))]
        columns = [[columns_of(told)[k] for told in both] for k in range(len(heads) - 3)]
        for k, column in enumerate(columns):
            known = [value for value in column if value is not None]
            line += f"{median(known):>8.{2 if k < 6 else 1}f}" if known else f"{'-':>8}"
        lines.append(line)
    lines += [
        f"{told['family']} {told['seed']}, {side}: {told[side]['reason']}"
        for told in results
        for side in ("ours", *SIDES)
        if side in told and not told[side]["found"]
    ]
    kinds = Counter(told["own"]["by"] for told in results).most_common()
    compiled = median(told["own"]["compiled_cpu_seconds"] for told in results)
    start = median(told["own"]["start_cpu_seconds"] for told in results)
    return [
        *lines,
        f"own's motions: {', '.join(f'{count} {name}' for name, count in kinds)}",
        f"start of the script {start:.2f} s, counted; to compile its robot {compiled:.2f} s, not",
    ]


def columns_of(told: Told) -> list[float | None]:
    """Seconds of ours and of the script, and ratios to the script with our own planner."""
    mine, own, ompl = told["ours"], told["own"], told.get("ompl", {"found": False})
    seconds = [mine[f"{key}cpu_seconds"] for key in ("motion_", "design_", "", "verify_")]
    spent, other = own["cpu_seconds"], ompl["cpu_seconds"] if ompl["found"] else None
    work = mine["motion_cpu_seconds"] - mine["loaded_cpu_seconds"]
    ratios = [each / spent for each in (seconds[0], seconds[2])]
    return [
        *seconds, spent, other, *ratios, None if other is None else other / spent,
        work / (spent - own["start_cpu_seconds"]),
    ]  # fmt: skip


def ways_table(results: Sequence[Told]) -> list[str]:
    """Median times of ways that all find, by planner, and how many each finds, by family."""
    names = ("own", "ompl", "ompl by states")
    lines = [f"{'family':<26}{'pairs':>6}" + "".join(f"{name:>22}" for name in names)]
    for family in [*KINDS, "all"]:
        own = [told for told in results if family in (told["family"], "all")]
        every = [way for told in own for way in told["ways"]]
        common = [way for way in every if None not in way.values()]
        if every:
            line = f"{family:<26}{len(every):>6}"
            for name in names:
                known = sum(way[name] is not None for way in every)
                middle = f"{1000 * median(way[name] for way in common):.1f} ms" if common else "-"
                line += f"{f'{middle} ({known})':>22}"
            lines.append(line)
    return lines


def record(options: argparse.Namespace, lines: list[str], results: list[Told]) -> None:
    """As `record.py` does, with what became of every task."""
    commit = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=options.tree, capture_output=True, text=True, check=True
    ).stdout.strip()
    more = f"{' --libraries FOLDER' * bool(options.libraries)}{' --ways' * options.ways}"
    content = {
        "title": "A script in place of srgc",
        "says": "Tasks that are feasible for certain, by `srgc synth`, and without a proof by a "
        "script of inverse kinematics, RRT-Connect and computed torques.",
        "command": f"python benchmarks/user_script.py{more}",
        "machine": f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the end",
        "date": time.strftime("%Y-%m-%d"),
        "output": lines,
        "commit": commit,
        "limit_cpu_seconds": options.limit,
        "tasks": results,
    }
    text = json.dumps(content, indent=1)
    options.record.write_text(f"{text}\n", encoding="utf-8")


def main() -> None:
    parser = command_line(__doc__.split("\n", maxsplit=1)[0], 4, 60, "user_script")
    parser.add_argument("--families", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument("--libraries", type=Path, help="a folder of packages: ompl, toppra")
    parser.add_argument("--ways", action="store_true", help="compare planners alone")
    parser.add_argument("--child", choices=(*SIDES, "ways"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.ways and not options.libraries:
        parser.error("--ways needs --libraries")
    folder = options.o.resolve()
    if options.libraries:
        site.addsitedir(str(options.libraries))
    if options.child:
        told = peer(folder, options.child, options.limit)
        (folder / f"{options.child}.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
        return
    print(machine(), flush=True)
    first, parts = map(int, options.part.split("/"))
    results, start = list[Told](), start_up()
    pairs = [(family, seed) for seed in options.seeds for family in options.families]
    for family, seed in pairs[first - 1 :: parts]:
        own = folder / f"{family.replace(' ', '_')}-{seed:02}"
        own.mkdir(parents=True, exist_ok=True)
        task, file = drawn(own, family, seed), own / ("ways" if options.ways else "told")
        if not file.exists():
            file.write_text(json.dumps(told_of(task, own, start, options)), encoding="utf-8")
        results.append(json.loads(file.read_text(encoding="utf-8")))
        print(family, seed, flush=True)
    lines = ways_table(results) if options.ways else table(results)
    print("\n" + "\n".join(lines))
    if options.record:
        record(options, lines, results)


def told_of(task: FeasibleTask, own: Path, start: float, options: argparse.Namespace) -> Told:
    """What both sides make of a task, or planners of its ways."""
    told: Told = {"family": task.family, "seed": task.seed, "sha256": digest(task)}
    if options.ways:
        return told | child(own, "ways", options)
    told["ours"] = ours(own, options.limit, options.tree.resolve())
    for side in SIDES[: 2 if options.libraries else 1]:
        found = told[side] = child(own, side, options)
        found["start_cpu_seconds"] = round(start, 3)
        found["cpu_seconds"] = round(found["cpu_seconds"] + start, 3)
    return told


def drawn(folder: Path, family: str, seed: int) -> FeasibleTask:
    """A task, from the folder if it is there, with its files in it."""
    file = folder / "task.pickle"
    if not file.exists():
        file.write_bytes(pickle.dumps(feasible_task(family, seed)))
    task: FeasibleTask = pickle.loads(file.read_bytes())
    for name, content in task.files.items():
        (folder / name).write_bytes(content)
    return task


if __name__ == "__main__":
    main()
