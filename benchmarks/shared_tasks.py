"""Random pairs of tasks for one robot: arms whose links have free lengths, tilted obstacles.

Both tasks have the same modules and the same word, so that their parameters correspond one to one.
Places, obstacles, gravity, payloads, efforts and times differ.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, replace

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.words.structures import structures
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load_text
from solvers.planner import Planner
from solvers.run_context import RunContext
from solvers.search.path_task import PathTask
from solvers.trajectory.path_following import PathProblem
from solvers.verdict import Holds

GRAVITY = 9.81
SHORT, LONG = 0.4, 1.6
"""m: the range of lengths."""
STEPS = 24
SPATIAL = 10
"""Every so many pairs, one is of arms in space."""

ROBOT = """\
module Base {{ role base; }}
{turn}module Limb {{
  role link; dof q: revolute {axis} in [-160, 160] deg; param length in [{short}, {long}] m;
}}
module Hand {{ role effector; }}
grammar Arm {{ start Robot; hand: Robot -> Limbs Hand; limb: Limbs -> Limbs Limb;
  base: Limbs -> Base{turns}; accept count(Limb) == {count}; }}
semantics Arm {{
  base {{ this.tip = {based}; }}
  hand {{ point(frame: Limbs.tip, mass: 0.2 kg); effector(frame: Limbs.tip); }}
  limb {{ this.tip = Limbs.tip * rot({axis}, Limb.q) * move(x, Limb.length);
    rod(frame: this.tip, axis: -x, length: Limb.length, density: {density} kg/m); }}
}}
workspace Place {{
  {plane};
  bounds {bounds} m;
  region Home {home} m;
  target Goal {goal} m;
{obstacles}}}
task T {{
  robot Arm; workspace Place; start in Home; reach Goal;
{avoid}  effort <= {effort:.2f} N*m; horizon {steps} steps of {step} s;
{more}  modules <= {modules};
}}
"""


@dataclass(frozen=True)
class Pair:
    """Two specifications of the same robot, from a seed."""

    seed: int
    links: int
    space: bool
    texts: tuple[str, str]


def pair_of(seed: int) -> Pair:
    """The pair of a seed; the same seed has the same one."""
    rng = random.Random(seed)
    space, links = seed % SPATIAL == SPATIAL - 1, 2 + seed % 2
    links = 2 if space else links
    density = round(rng.uniform(0.5, 2.0), 2)
    lengths = [rng.uniform(SHORT + 0.1, LONG - 0.1) for _ in range(links)]
    # Each task is drawn for lengths of its own, so that they want different robots.
    texts = [
        _task(rng, space, density, [x * rng.uniform(0.75, 1.3) for x in lengths]) for _ in range(2)
    ]
    return Pair(seed, links, space, (texts[0], texts[1]))


def _task(rng: random.Random, space: bool, density: float, lengths: list[float]) -> str:  # noqa: FBT001
    links, reach = len(lengths), LONG * len(lengths)
    while True:
        first, last = (_tip(rng, lengths, space) for _ in range(2))
        if math.dist(first, last) > 0.3 * sum(lengths):
            break
    side = 0.08 * sum(lengths)
    obstacles = [] if space else _obstacles(rng, first, last, sum(lengths))
    weighs, payload = rng.random() < 0.5, rng.choice((0.0, 0.0, round(rng.uniform(0.2, 1.5), 2)))
    step = rng.choice((0.05, 0.075, 0.1))
    effort = _effort(lengths, density, 0.2 + payload, STEPS * step, weighs) * rng.uniform(0.25, 0.7)
    down = f"  gravity ({'0, 0' if space else '0'}, -{GRAVITY}) m/s^2;\n" if weighs else ""
    box = f"[{-reach:g}, {reach:g}]"
    return ROBOT.format(
        turn="module Turn { role joint; dof q: revolute z in [-170, 170] deg; }\n" if space else "",
        turns=" Turn" if space else "",
        based="world * move(z, 0.5 m) * rot(z, Turn.q)" if space else "world",
        axis="y" if space else "z", short=SHORT, long=LONG, count=links, density=density,
        plane="space xyz" if space else "plane xy",
        bounds=f"box {' x '.join([box] * (3 if space else 2))}",
        home=_box(first, side), goal=_box(last, side),
        obstacles="".join(f"  obstacle O{i} hull {each} m;\n" for i, each in enumerate(obstacles)),
        avoid="".join(f"  avoid O{i} with effector;\n" for i in range(len(obstacles))),
        effort=effort, steps=STEPS, step=step,
        more=down + (f"  payload {payload} kg;\n" if payload else ""), modules=links + 2 + space,
    )  # fmt: skip


def _tip(rng: random.Random, lengths: list[float], space: bool) -> list[float]:  # noqa: FBT001
    """Where the hand is in a pose that is bent somewhat."""
    angle, radius, height = rng.uniform(-2.4, 2.4), 0.0, 0.0
    for i, length in enumerate(lengths):
        angle += 0.0 if i == 0 else rng.choice((-1, 1)) * rng.uniform(0.3, 1.6)
        radius += length * math.cos(angle)
        height += length * math.sin(angle)
    if not space:
        return [radius, height]
    turn = rng.uniform(-1.5, 1.5)
    return [abs(radius) * math.cos(turn), abs(radius) * math.sin(turn), 0.5 + 0.5 * height]


def _effort(lengths: list[float], density: float, load: float, time: float, weighs: bool) -> float:  # noqa: FBT001
    """The torque (N m) that holds the arm stretched out, or turns it so by 1.5 rad in the time."""
    reach = sum(lengths)
    if weighs:
        return GRAVITY * reach * (density * reach / 2 + load)
    return 4 * 1.5 / time**2 * reach**2 * (density * reach / 3 + load)


def _box(at: list[float], side: float) -> str:
    return "box " + " x ".join(f"[{x - side:.3f}, {x + side:.3f}]" for x in at)


def _obstacles(
    rng: random.Random, first: list[float], last: list[float], reach: float
) -> list[str]:
    """Up to two quadrilaterals, turned anyhow, between the ends and clear of them."""
    found = list[str]()
    for _ in range(rng.choice((0, 1, 1, 2))):
        part, size = rng.uniform(0.3, 0.7), rng.uniform(0.06, 0.14) * reach
        x, y = (
            a + part * (b - a) + rng.uniform(-0.15, 0.15) * reach
            for a, b in zip(first, last, strict=True)
        )
        if min(math.dist((x, y), first), math.dist((x, y), last)) < size + 0.2 * reach:
            continue
        turn = rng.uniform(0, math.tau)
        corners = (
            (
                x + size * math.cos(turn + k * math.tau / 4),
                y + size * math.sin(turn + k * math.tau / 4),
            )
            for k in range(4)
        )
        found.append(", ".join(f"({a:.3f}, {b:.3f})" for a, b in corners))
    return found


def path_problem(text: str) -> PathProblem | None:
    """The first path of the first robot of a specification; only its ends bind to cells."""
    loaded = load_text(text, "pair.srg")
    program = loaded.program
    if program is None:
        raise SystemExit(f"not valid: {loaded.diagnostics}\n{text}")
    task = program.tasks["T"]
    family = family_of(program, task)
    model = family.robot(next(iter(structures(family.language, 12))))
    cells = abstract(program.workspaces[task.workspace])
    found = Planner(planning_problem(cells, task, 0)).next_plan()
    if not isinstance(found, Holds):
        return None
    numeric = NumericRobot(robot_graph(model, task.gravity))
    given = PathTask(program, task, numeric, None, RunContext().seed)
    return replace(given.path_problem(cells, 0, 0, found.witness.paths[0].cells), bound=False)
