"""Two tasks for one robot: the better robot of each alone, consensus, and one program for both.

Of random pairs of tasks (`shared_tasks.py`) the first are taken of which each task has a motion.

- *apart*: parameters are searched for each task, and polished; both tasks are done by the one
  robot and by the other, the other motion found anew, and the better of the two robots counts.
- *consensus* (`shared_consensus.py`) and *block* (`solvers/trajectory/shared_parameters.py`) start
  at both of these robots, with the same motions; the better end counts.

The value is the least share, the margin of the inputs as a part of what it can be at most.  Every
seed has a file in the folder of ``-o``, and what is there is not run again unless a text has
changed: a run goes on where the last one ended, and ``--part 1/2`` and ``--part 2/2`` may run side
by side.

    python benchmarks/shared_parameters.py --pairs 20
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from shared_consensus import by_consensus
from shared_tasks import Pair, pair_of, path_problem

from compiler.arrays import Array
from solvers.parameters.parameter_search import parameter_space
from solvers.search.evaluation import evaluate
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.shared_control import SharedOutcome, SharedTask, shared_control
from solvers.trajectory.shared_parameters import parameter_box
from solvers.trajectory.trajectory import Trajectory

SAMPLES = 4
"""2 to this power robots are evaluated for each task."""
POLISHED = 3
"""So many of them are polished."""
EQUAL = 1e-3
"""Values that differ by no more, relatively, are equal."""
WAYS = ("apart", "consensus", "block")
Start = tuple[Trajectory, Trajectory]
Shared = Callable[[Sequence[SharedTask], Any], SharedOutcome | None]


@dataclass(frozen=True)
class Apart:
    """The robots of both tasks, each with the motions for both, and their least shares."""

    starts: tuple[Start, ...]
    share: float


def best(outcomes: Sequence[ControlOutcome]) -> ControlOutcome:
    """The most robust outcome."""
    return max(outcomes, key=lambda each: each.robustness)


def alone(path: PathProblem) -> ControlOutcome | None:
    """The best robot and motion for a task: evaluated all over the ranges, and polished."""
    found = [
        each
        for theta in parameter_space(path.model).samples(SAMPLES, 0)
        if (each := at(path, theta)) is not None
    ]
    ranked = sorted(found, key=lambda each: -each.robustness)[:POLISHED]
    polished = [
        path.solve(each.trajectory, box=parameter_box(path, each.trajectory.theta))
        for each in ranked
    ]
    return best([*ranked, *polished]) if ranked else None


def at(path: PathProblem, theta: Array) -> ControlOutcome | None:
    """The best motion at given parameters, if there is a seed of one."""
    try:
        return evaluate(path, theta)
    except ValueError:
        return None


def share_of(path: PathProblem, outcome: ControlOutcome) -> float:
    """Robustness as a part of what it can be at most."""
    return outcome.robustness / path.problem(path.waypoints()[1]).scale


def apart(paths: Sequence[PathProblem], own: Sequence[ControlOutcome]) -> Apart:
    """Each task's robot in both tasks."""
    starts, shares = list[Start](), list[float]()
    for each in own:
        theta = each.trajectory.theta
        motions = list[ControlOutcome]()
        for path, mine in zip(paths, own, strict=True):
            if mine is each:
                motions.append(each)
                continue
            tried = at(path, theta)
            seeds = [mine.trajectory] if tried is None else [mine.trajectory, tried.trajectory]
            motions.append(best([path.solve(Trajectory(s.x, s.u, theta)) for s in seeds]))
        starts.append((motions[0].trajectory, motions[1].trajectory))
        values = [share_of(path, m) for path, m in zip(paths, motions, strict=True)]
        shares.append(min(values))
    return Apart(tuple(starts), max(shares))


def together(
    paths: Sequence[PathProblem], starts: Sequence[Start], way: Shared
) -> tuple[float, SharedOutcome | None]:
    """The best end from any start, by its least share."""
    count = len(paths[0].model.parameters)
    links = [[(0, i), (1, i)] for i in range(count)]
    found = list[SharedOutcome]()
    for start in starts:
        tasks = [
            SharedTask(path.problem(path.waypoints()[1]), motion, parameter_box(path, motion.theta))
            for path, motion in zip(paths, start, strict=True)
        ]
        outcome = way(tasks, links)
        if outcome is not None:
            found.append(outcome)
    top = max(found, key=lambda each: each.share, default=None)
    return (-1.0 if top is None else top.share), top


def measured(pair: Pair) -> dict[str, Any] | None:
    """The shares and processor times of all ways; None where a task has no motion of its own."""
    paths = [each for text in pair.texts if (each := path_problem(text)) is not None]
    if len(paths) < 2:
        return None
    began = time.process_time()
    own = [each for path in paths if (each := alone(path)) is not None and each.feasible]
    if len(own) < 2:
        return None
    searched = time.process_time() - began
    began = time.process_time()
    known = apart(paths, own)
    ways: dict[str, Any] = {"apart": {"share": known.share, "seconds": time.process_time() - began}}
    for name, way in (("consensus", by_consensus), ("block", shared_control)):
        began = time.process_time()
        share, top = together(paths, known.starts, way)
        theta = [] if top is None else [round(float(x), 4) for x in top.trajectories[0].theta]
        ways[name] = {"share": share, "seconds": time.process_time() - began, "theta": theta}
    return {
        "own": [share_of(path, each) for path, each in zip(paths, own, strict=True)],
        "own_theta": [[round(float(x), 4) for x in each.trajectory.theta] for each in own],
        "search_seconds": searched,
        "ways": ways,
    }


def told_of(seed: int, file: Path, *, mine: bool) -> dict[str, Any] | None:
    """What is known of a seed, measured if it is not known yet and ``mine``."""
    pair = pair_of(seed)
    digest = hashlib.sha256("".join(pair.texts).encode()).hexdigest()
    if file.exists():
        told: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        if told["texts_sha256"] == digest:
            return told
    if not mine:
        return None
    told = {"seed": seed, "links": pair.links, "space": pair.space, "texts_sha256": digest,
            "result": measured(pair)}  # fmt: skip
    file.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    return told


# --- tables -------------------------------------------------------------------------------------


def line(told: dict[str, Any]) -> str:
    """A pair in a line of the table."""
    result = told["result"]
    arm = f"{told['links']} links{', space' if told['space'] else ''}"
    own = " ".join(f"{each:6.3f}" for each in result["own"])
    shares = "".join(f"{result['ways'][way]['share']:>11.4f}" for way in WAYS)
    times = "".join(f"{result['ways'][way]['seconds']:>10.2f}" for way in WAYS)
    return f"{told['seed']:>4}  {arm:<15}{own}{shares}{times}"


def better(one: float, other: float) -> bool:
    """Whether one share is greater than another by more than counts as equal."""
    return one - other > EQUAL * max(abs(one), abs(other))


def compared(results: Sequence[dict[str, Any]], way: str, other: str) -> str:
    """How often one way is better than another, by how much in the middle, in which time."""
    pairs = [(each["ways"][way], each["ways"][other]) for each in results]
    # By how much a way fails says nothing.
    shares = [(max(0.0, a["share"]), max(0.0, b["share"])) for a, b in pairs]
    wins = sum(better(a, b) for a, b in shares)
    losses = sum(better(b, a) for a, b in shares)
    gains = [a - b for a, b in shares]
    slower = [a["seconds"] / b["seconds"] for a, b in pairs]
    only = sum(a["share"] >= 0 > b["share"] for a, b in pairs)
    return (
        f"{way} against {other}: better {wins}, equal {len(pairs) - wins - losses}, worse {losses} "
        f"of {len(pairs)}; alone in having motions {only}; median gain {median(gains):+.4f} of a "
        f"share; median time {median(slower):.2f} times"
    )


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--part", default="1/1", help="K/N: every Nth seed, from the Kth on")
    parser.add_argument("-o", type=Path, default=ROOT / "out" / "shared_parameters")
    options = parser.parse_args()
    if options.pairs < 1:
        parser.error("at least one pair")
    np.seterr(all="ignore")
    options.o.mkdir(parents=True, exist_ok=True)
    first, parts = map(int, options.part.split("/"))
    print(f"{machine()}\n\n{'':21}{'own shares':>13}{'least share of both':>33}{'cpu s':>25}")
    print(f"seed  {'arm':<15}{'':13}" + "".join(f"{w:>11}" for w in WAYS)
          + "".join(f"{w:>10}" for w in WAYS))  # fmt: skip
    found, skipped, seed = list[dict[str, Any]](), 0, 0
    while len(found) < options.pairs:
        mine = seed % parts == first - 1
        told = told_of(seed, options.o / f"{seed:03}.json", mine=mine)
        seed += 1
        if told is None:
            # Another part has it; it counts, so that all parts end at the same seed or later.
            skipped += 1
            if skipped + len(found) >= options.pairs * 3:
                break
        elif told["result"] is not None:
            found.append(told["result"])
            print(line(told), flush=True)
    for way, other in (("block", "apart"), ("consensus", "apart"), ("block", "consensus")):
        print(compared(found, way, other))


if __name__ == "__main__":
    main()
