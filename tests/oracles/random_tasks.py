"""Specs of small robots in random worlds, with what a brute force needs to know of them."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np

from compiler.arrays import Array
from tests.oracles.hand_arms import HandArm

MODULES = """\
module B {{ role base; }}
module JO {{ role joint; dof q: revolute z in [-{half}, {half}] deg; }}
module P {{ role joint; dof d: prismatic x in [0, {stroke}] m; }}
{module}module L {{ role link; param length in [{low}, {high}] m; const density = {density} kg/m; }}
module S {{ role link; param length in [{low}, {high}] m; const mass = {density} kg; }}
module K {{ role link; param length in [{short}, {short}] m; const density = 1 kg/m; }}
module EN {{ role effector; }}
edge eps;

grammar G {{
  start N;
  base: N -> B;
  joint: N -> N eps JO;
  slide: N -> N eps P;
{tilt}  link: N -> N eps L;
  solid: N -> N eps S;
  last: N -> N eps K;
  tool: N -> N eps EN;
  accept {accept};
}}

semantics G {{
  base {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, JO.q); }}
  slide {{
    this.frame = N.frame * move(x, P.d);
    {sled}
  }}
{tilted}  link {{
    this.frame = N.frame * move(x, L.length);
    {rod}
  }}
  solid {{
    this.frame = N.frame * move(x, S.length);
    {body}
  }}
  last {{
    this.frame = N.frame * move(x, K.length);
    {end}
  }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
"""
PLANE = {
    "module": "",
    "tilt": "",
    "tilted": "",
    "sled": "rod(frame: this.frame, axis: -x, length: 0.5 m, density: 2 kg/m);",
    "rod": "rod(frame: N.frame, axis: x, length: L.length, density: L.density);",
    "body": "rod(frame: N.frame, axis: x, length: S.length, density: 1 kg/m);",
    "end": "rod(frame: N.frame, axis: x, length: K.length, density: K.density);",
}
SOLID = "inertia: (0.01 kg*m^2, 0.03 kg*m^2, 0.035 kg*m^2, 0, 0, 0));"
SPACE = {
    "module": "module Y { role joint; dof q: revolute y in [-110, 110] deg; }\n",
    "tilt": "  tilt: N -> N eps Y;\n",
    "tilted": "  tilt { this.frame = N.frame * rot(y, Y.q); }\n",
    "sled": f"solid(frame: this.frame, mass: 1 kg, com: (0, 0, 0), {SOLID}",
    "rod": f"solid(frame: N.frame, mass: 1 kg, com: (L.length / 2, 0, 0), {SOLID}",
    "body": f"solid(frame: N.frame, mass: S.mass, com: (S.length / 2, 0, 0), {SOLID}",
    "end": f"solid(frame: N.frame, mass: 0.5 kg, com: (K.length / 2, 0, 0), {SOLID}",
}
TILT = radians(110)


@dataclass(frozen=True)
class RandomTask:
    """A spec and the numbers that it was made from; ``words`` are all of its family."""

    text: str
    words: tuple[tuple[str, ...], ...]
    low: float
    high: float
    short: float
    half: float
    stroke: float
    density: float
    space: bool
    effort: float

    def arm(self, word: Sequence[str], values: Mapping[int, float]) -> HandArm:
        """The robot of a word."""
        made, moments = HandArm(), (0.01, 0.03, 0.035)
        for index, symbol in enumerate(word):
            if symbol in ("JO", "Y"):
                axis, half = (2, self.half) if symbol == "JO" else (1, TILT)
                made.joint(index, axis, limits=(-half, half))
            elif symbol == "P":
                made.joint(index, 0, "slide", (0.0, self.stroke)).rod(0, 0.5, 2, start=-0.5)
            elif symbol in ("L", "S", "K"):
                length = self.short if symbol == "K" else values[index]
                if self.space:
                    mass = {"L": 1.0, "S": self.density, "K": 0.5}[symbol]
                    made.solid(mass, (length / 2, 0, 0), moments)
                else:
                    made.rod(0, length, {"L": self.density, "S": 1.0, "K": 1.0}[symbol])
                made.move(length)
            elif symbol == "EN":
                made.effector()
        return made

    def free_lengths(self, word: Sequence[str]) -> list[int]:
        return [i for i, symbol in enumerate(word) if symbol in ("L", "S")]


def placed(task: RandomTask, word: Sequence[str], lengths: Array, q: Array) -> Array:
    """The points from the base to the tool, (samples, points, 3); by turning vectors, no frames.

    Args:
        task: the task.
        word: one of its words.
        lengths: of the modules L and S in order, (samples, p).
        q: the coordinates, (samples, n).
    """
    count = len(q)
    at, x, y = np.zeros((count, 3)), *(np.tile(np.eye(3)[i], (count, 1)) for i in (0, 1))
    points, joint, link = [at], 0, 0
    for symbol in word:
        z = np.cross(x, y)
        if symbol in ("JO", "Y"):
            c, s = np.cos(q[:, joint])[:, None], np.sin(q[:, joint])[:, None]
            # About z the x-axis goes to y; about y it goes to -z.
            x, y = (c * x + s * y, c * y - s * x) if symbol == "JO" else (c * x - s * z, y)
            joint += 1
        elif symbol == "P":
            # The slide's rod begins half a metre behind it.
            at = at + q[:, joint][:, None] * x
            points += [at - 0.5 * x, at]
            joint += 1
        elif symbol in ("L", "S", "K"):
            length = np.full(count, task.short) if symbol == "K" else lengths[:, link]
            link += symbol != "K"
            at = at + length[:, None] * x
            points.append(at)
    return np.stack(points, axis=1)


def _box(name: str, centre: Sequence[float], half: Sequence[float], kind: str) -> str:
    sides = [f"[{c - h:.2f}, {c + h:.2f}]" for c, h in zip(centre, half, strict=True)]
    return f"  {kind} {name} box {' x '.join(sides)} m;"


def _hull(name: str, chance: random.Random, centre: Sequence[float]) -> str:
    count, turn = chance.randint(3, 5), chance.uniform(0, 6.28)
    corners = []
    for i in range(count):
        angle, radius = turn + 6.283 * i / count, chance.uniform(0.15, 0.5)
        corners.append((centre[0] + radius * cos(angle), centre[1] + radius * sin(angle)))
    listed = ", ".join(f"({x:.2f}, {y:.2f})" for x, y in corners)
    return f"  obstacle {name} hull {listed} m;"


SHAPES: Sequence[tuple[str, tuple[str, ...], bool]] = (
    ("matches B eps JO eps L eps EN", ("B JO L EN",), False),
    ("matches B eps JO eps L eps JO eps K eps EN", ("B JO L JO K EN",), False),
    ("matches B eps P eps JO eps L eps EN", ("B P JO L EN",), False),
    ("matches B eps JO eps L (eps JO eps K)? eps EN", ("B JO L EN", "B JO L JO K EN"), False),
    ("matches B eps JO eps P eps K eps EN", ("B JO P K EN",), False),
    ("matches B eps JO eps S eps Y eps K eps EN", ("B JO S Y K EN",), True),
)  # fmt: skip


def random_task(seed: int) -> RandomTask:
    """Start and target are about tips of random poses, mostly of one robot, and of one size."""
    chance = random.Random(f"task {seed}")
    accept, bare, space = SHAPES[chance.choices(range(6), (2, 3, 1, 2, 1, 1))[0]]
    words = tuple(tuple(" eps ".join(word.split()).split()) for word in bare)
    low = chance.randint(5, 10) / 10
    high = low + chance.choice((0, 0, 3, 6)) / 10
    short, half, stroke = chance.randint(3, 8) / 10, chance.choice((60, 120, 170)), 0.9
    density, effort = chance.randint(5, 20) / 10, chance.choice((0.2, 3, 10, 10, 10))
    numbers = {"low": low, "high": high, "short": short, "half": half, "stroke": stroke}
    head = MODULES.format(accept=accept, density=density, **numbers, **(SPACE if space else PLANE))
    task = RandomTask("", words, low, high, short, radians(half), stroke, density, space, effort)
    world = _world(task, chance, np.random.default_rng(seed))
    obstacles = [name for name in ("O1", "O2") if f"obstacle {name} " in world]
    return replace(task, text=head + world + _duties(task, chance, obstacles))


def _tips(task: RandomTask, rng: np.random.Generator) -> Array:
    """Where two random poses of one robot have the tool."""
    word = task.words[-1]
    lengths = np.tile(rng.uniform(task.low, task.high, len(task.free_lengths(word))), (2, 1))
    return placed(task, word, lengths, poses(task, word, rng, 2))[:, -1]


def poses(task: RandomTask, word: Sequence[str], rng: np.random.Generator, count: int) -> Array:
    """Coordinates within the limits of the joints, (count, n)."""
    within = limits(task)
    columns = [rng.uniform(*within[symbol], count) for symbol in word if symbol in within]
    return np.stack(columns, axis=1)


def limits(task: RandomTask) -> dict[str, tuple[float, float]]:
    """The ranges of the joints by their modules."""
    return {"JO": (-task.half, task.half), "Y": (-TILT, TILT), "P": (0.0, task.stroke)}


def _world(task: RandomTask, chance: random.Random, rng: np.random.Generator) -> str:
    d = 3 if task.space else 2
    start, end = (tip[:d] for tip in _tips(task, rng))
    if chance.random() < 0.35:
        end = np.clip(end * chance.choice((0.3, 1.4, 1.8)), -2.3, 2.3)
    size = chance.choice((0.05, 0.1, 0.15))
    lines = [
        f"\nworkspace W {{\n  {'space xyz' if task.space else 'plane xy'};",
        _box("", (0, 0, 0)[:d], (2.6,) * d, "bounds").replace("bounds  box", "bounds box"),
        _box("S0", start, (size,) * d, "region"),
        _box("T0", end, (size,) * d, "target"),
    ]
    for name in ("O1", "O2")[: 1 if task.space else chance.randint(0, 2)]:
        at = rng.uniform(-1.3, 1.3, d)
        at = at * chance.choice((1, 0)) + (start + end) / 2 * chance.choice((0, 1))
        if task.space:
            lines.append(_box(name, at, (0.1, 0.15, 0.2), "obstacle"))
        else:
            lines.append(_hull(name, chance, at))
    return "\n".join([*lines, "}\n"])


def _duties(task: RandomTask, chance: random.Random, obstacles: Sequence[str]) -> str:
    lines = ["\ntask Do {\n  robot G;\n  workspace W;\n  start in S0 at rest;\n  reach T0;"]
    if chance.random() < 0.3:
        pull = ["0", "-1.5", "-1"][: 3 if task.space else 2]
        lines.append(f"  gravity ({', '.join(pull)}) m/s^2;")
    lines.append(f"  effort <= {task.effort} N*m;\n  effort <= {task.effort} N;")
    lines.append(f"  horizon {chance.choice((6, 8, 10))} steps of 0.2 s;")
    subject = "effector" if task.space or chance.random() < 0.5 else "body"
    margin = chance.choice(("", " margin 0.02 m"))
    if obstacles:
        lines.append(f"  avoid {', '.join(obstacles)} with {subject}{margin};")
    return "\n".join([*lines, "}\n"])
