"""Robots of the fewest modules, then the least time: `srgc synth` beside a lexicographic search.

The peer is ``genetic_search.py``, Timor's genetic search on Timor's modules, in an environment of
its own (``make .venv/timor/installed``).  The first task is that of Timor's tutorial; others are
random: two goals of 2 cm, pillars and a floor.  Robots are of Timor's revolute joints and tubes.
With ``--placed`` tasks are random and the base may stand anywhere on a square of 80 cm; the genetic
search chooses between 25 places of it.

Each task is given to ours once, found results to `srgc verify`, and to the peer with some seeds;
times are processor times of whole processes.  An answer of the peer with fewer modules than ours
are proved to need ends the benchmark.

    python benchmarks/modular_search.py --tasks 6 --seeds 3
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import tempfile
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from timing import ROOT, SRGC, machine

FOUND, IMPOSSIBLE, UNKNOWN = 0, 3, 4
VERDICTS = {FOUND: "found", IMPOSSIBLE: "impossible", UNKNOWN: "unknown"}
STEP, STEPS = "0.05 s", 40
TIMOR = ROOT / ".venv" / "timor" / "bin" / "python"
Box = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Scene:
    """Two goals, and boxes to keep clear of, in metres.

    The base stands ``height`` above the origin, turned about z by ``turn`` degrees, or up to
    ``free`` to either side of that.
    """

    name: str
    goals: tuple[Box, Box]
    walls: tuple[Box, ...]
    modules: int
    free: float = 0.0
    height: float = 0.0
    turn: float = 0.0

    @property
    def spec(self) -> str:
        """The task in the language; the floor module puts the base where the peer has it."""
        names = [f"Wall{number}" for number in range(len(self.walls))]
        walls = "".join(
            f"  obstacle {name} box {sides(box)};\n"
            for name, box in zip(names, self.walls, strict=True)
        )
        value = f"in [-{self.free}, {self.free}] m" if self.free else "= 0 m"
        kind = "param" if self.free else "const"
        place = f"{kind} east {value}; {kind} north {value};"
        return f"""include std "timor.srg";
module Floor {{
  role base; {place}
  port out: Std_Timor_Ground male;
  frame out = in * move((east, north, {self.height} m)) * rot(z, {self.turn} deg);
}}
grammar Arms from ports {{
  start Floor;
  with Std_Timor_Base, Std_Timor_J2, Std_Timor_I, Std_Timor_L, Std_Timor_Eef;
}}
workspace Hall {{
  space xyz;
  bounds box [-3, 3] x [-3, 3] x [-1, 3] m;
  region Pick box {sides(self.goals[0])};
  target Place box {sides(self.goals[1])};
{walls}}}
task Move {{
  robot Arms;
  workspace Hall;
  start in Pick at rest;
  reach Place at rest;
  avoid self with body, margin 1 mm;
  avoid {", ".join(names)} with body;
  gravity (0, 0, -9.81) m/s^2;
  horizon at most {STEPS} steps of {STEP};
  modules <= {self.modules + 1};
  minimize modules then time;
}}
"""

    def for_peer(self, seed: int, generations: int) -> dict[str, Any]:
        """What ``genetic_search.py`` reads."""
        along = np.linspace(-self.free, self.free, 5) if self.free else np.zeros(1)
        return {
            "seed": seed,
            "goals": self.goals,
            "obstacles": self.walls,
            "placements": [[float(x), float(y), self.height] for x, y in product(along, repeat=2)],
            "turn": self.turn,
            "modules": self.modules,
            "minimize": ["modules", "time"],
            "hyperparameters": {"num_genes": self.modules, "num_generations": generations},
            "seconds": 3600,
        }


GROUND: Box = ((-2.5, -2.5, -0.5), (2.5, 2.5, -0.001))


def sides(box: Box) -> str:
    """A box as the language writes it."""
    return " x ".join(f"[{low}, {high}]" for low, high in zip(*box, strict=True)) + " m"


def scene(seed: int, modules: int, free: float) -> Scene:
    """Goals 35 to 70 cm from the base and at least a sixth of a turn apart, and three pillars."""
    rng = np.random.default_rng([seed, 28])
    turns = rng.uniform(-np.pi, np.pi) + np.array([0.0, rng.uniform(np.pi / 3, np.pi)])
    middles = [
        np.round([r * np.cos(turn), r * np.sin(turn), z], 3)
        for turn, r, z in zip(
            turns, rng.uniform(0.35, 0.7, 2), rng.uniform(0.2, 0.7, 2), strict=True
        )
    ]
    goals = tuple(around(middle, np.full(3, 0.01)) for middle in middles)
    pillars: list[Box] = []
    while len(pillars) < 3:
        middle = np.round(rng.uniform(-0.8, 0.8, 2), 2)
        half = np.round(rng.uniform(0.03, 0.12, 2), 2)
        height = float(np.round(rng.uniform(0.2, 1.2), 2))
        apart = min(float(np.max(np.abs(m[:2] - middle) - half)) for m in middles)
        if apart > 0.12 and np.max(np.abs(middle) - half) > free + 0.15:
            low, high = middle - half, middle + half
            pillars.append(
                ((round(low[0], 3), round(low[1], 3), 0.0),
                 (round(high[0], 3), round(high[1], 3), height))
            )  # fmt: skip
    return Scene(str(seed), goals, (GROUND, *pillars), modules, free)


def desk(modules: int) -> Scene:
    """The task of Timor's tutorial ``solve_a_task.ipynb``; its legs are boxes around cylinders."""
    goals = [
        around(np.array([x, 0.2, z]), np.full(3, 0.001)) for x, z in ((0.55, 0.49), (-0.55, 0.45))
    ]
    top: Box = ((-0.8, -0.4, 0.375), (0.8, 0.4, 0.425))
    plateau: Box = ((0.33, 0.06, 0.425), (0.63, 0.26, 0.465))
    legs = [
        around(np.array([x * 0.75, y * 0.35, 0.2]), np.array([0.05, 0.05, 0.2]))
        for x, y in product((-1, 1), repeat=2)
    ]
    return Scene("desk", (goals[0], goals[1]), (top, plateau, *legs), modules, 0.0, 0.426, 90.0)


def around(middle: np.ndarray, half: np.ndarray) -> Box:
    """A box with exact decimals."""
    return (
        tuple(round(float(x), 3) for x in middle - half),
        tuple(round(float(x), 3) for x in middle + half),
    )


def timed(command: list[str]) -> tuple[int, str, float]:
    """The exit status of a process, what it printed and its processor seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return ran.returncode, ran.stdout, spent


def ours(given: Scene, folder: Path) -> dict[str, Any]:
    """What `srgc synth` and `srgc verify` say."""
    spec, out = folder / "move.srg", folder / "out"
    spec.write_text(given.spec, encoding="utf-8")
    status, _, cpu = timed([*SRGC, "synth", str(spec), "--force", "-q", "-o", str(out)])
    if status not in VERDICTS:
        raise SystemExit(f"scene {given.name}: exit status {status}")
    found: dict[str, Any] = {"verdict": VERDICTS[status], "cpu": cpu}
    design = json.loads((out / "design.json").read_text(encoding="utf-8"))
    found["looked at"] = design["iterations"]["structures"]
    if status == FOUND:
        values = {entry["objective"]: entry for entry in design["objectives"]}
        found |= {
            "modules": int(values["modules"]["value"]) - 1,
            "least": int(values["modules"]["least"]) - 1,
            "undecided": values["modules"]["undecided"],
            "time": values["time"]["value"],
        }
    if status != UNKNOWN:
        status, _, found["verify"] = timed([*SRGC, "verify", str(out), "-q"])
        if status:
            raise SystemExit(f"scene {given.name}: verify ended with {status}")
    return found


def peers(given: Scene, python: Path, seeds: int, generations: int, folder: Path) -> list[Any]:
    """What the genetic search finds, by seed."""
    found = []
    for seed in range(seeds):
        task = folder / "task.json"
        task.write_text(json.dumps(given.for_peer(seed, generations)), encoding="utf-8")
        script = str(ROOT / "benchmarks" / "genetic_search.py")
        status, printed, cpu = timed([str(python), script, str(task)])
        if status:
            raise SystemExit(f"scene {given.name}: the genetic search ended with {status}")
        found.append({**json.loads(printed.splitlines()[-1]), "cpu": cpu})
    return found


def line(given: Scene, own: dict[str, Any], theirs: list[Any]) -> str:
    """A line of the table, and the check of proofs by the peer's answers."""
    good = [each for each in theirs if each["found"]]
    fewest = min((len(each["modules"]) for each in good), default=None)
    if fewest is not None and (own["verdict"] == "impossible" or fewest < own.get("least", 0)):
        raise SystemExit(f"scene {given.name}: a robot of {fewest} modules contradicts the proof")
    times = [each["time"] for each in good if len(each["modules"]) == fewest]
    least = ""
    if own["verdict"] == "found":
        known = own["least"] == own["modules"]
        least = "proved" if known else f"{own['undecided']} open"
    left = [
        f"{given.name:>5}  {own['verdict']:<10}{own.get('modules', ''):>8} {least:<8}",
        f"{own.get('time', ''):>6}{own['looked at']:>7}{own['cpu']:>8.0f}",
        f"{own.get('verify', 0):>8.1f}   {len(good):>2}/{len(theirs)}{fewest or '':>8}",
        f"{f'{min(times):.2f}' if times else '':>7}{f'{median(times):.2f}' if times else '':>7}",
        f"{median(each['looked at'] for each in theirs):>7.0f}",
        f"{median(each['cpu'] for each in theirs):>8.0f}",
    ]
    return "".join(left)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=6)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--generations", type=int, default=100, help="100: Timor's default")
    parser.add_argument("--modules", type=int, default=7)
    parser.add_argument("--placed", action="store_true", help="the base may stand elsewhere")
    parser.add_argument("--timor", type=Path, default=TIMOR, help="a Python that has Timor")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    if not options.timor.exists():
        raise SystemExit(f"{options.timor}: no such file; make .venv/timor/installed makes it")
    scenes = [
        scene(seed, options.modules, 0.4 if options.placed else 0.0)
        for seed in range(options.first, options.first + options.tasks)
    ]
    if not options.placed:
        scenes.insert(0, desk(options.modules))
    print(machine())
    print(f"{'':52}srgc   {'genetic search':>39}")
    print(" scene  verdict   modules           time looked   cpu s  verify"
          "   found modules   best median looked   cpu s")  # fmt: skip
    lines = []
    with tempfile.TemporaryDirectory() as scratch:
        for given in scenes:
            own = ours(given, Path(scratch))
            theirs = peers(given, options.timor, options.seeds, options.generations, Path(scratch))
            print(line(given, own, theirs), flush=True)
            lines.append({"scene": given.name, "ours": own, "peer": theirs})
    if options.json is not None:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        content = {"machine": machine(), "placed": options.placed, "scenes": lines}
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
