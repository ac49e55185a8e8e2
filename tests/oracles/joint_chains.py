"""Chains of joints that may merge or be idle: as models, as specs, and their points by hand."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import cos, sin

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import WORLD, RobotModel
from tests.oracles.robots import AXES, Builder, interval


@dataclass(frozen=True)
class Part:
    """A ``revolute`` or ``prismatic`` joint, a rigid ``turn``, a ``rod``, or a ``tool``.

    ``size`` is the angle or the length of a rigid part, ``limits`` the range of a joint.
    """

    kind: str
    axis: str = "x"
    size: Fraction = Fraction(0)
    limits: tuple[Fraction, Fraction] | None = None

    @property
    def moves(self) -> bool:
        return self.kind in ("revolute", "prismatic")


def model_of(parts: Sequence[Part], dimension: int = 3) -> RobotModel:
    """The robot of a chain, as its rules build it."""
    builder, frame = Builder(dimension=dimension), WORLD
    for part in parts:
        if part.moves:
            limits = None if part.limits is None else interval(*part.limits)
            frame = builder.joint(frame, part.axis, part.kind, limits)  # type: ignore[arg-type]
        elif part.kind == "turn":
            frame = builder.turn(frame, part.axis, builder.number(part.size))
        elif part.kind == "rod":
            frame = builder.link(frame, builder.number(part.size), part.axis)
        else:
            builder.effector(frame)
    return builder.build()


def points_of(parts: Sequence[Part], values: Sequence[Fraction]) -> tuple[Array, Array]:
    """Effectors (e, 3) and ends of rods (r, 3) in the world, with one value per joint."""
    turn, at, given = np.eye(3), np.zeros(3), iter(values)
    tools: list[Array] = []
    ends: list[Array] = []
    for part in parts:
        size = float(next(given) if part.moves else part.size)
        number, sign = AXES[part.axis]
        if part.kind in ("revolute", "turn"):
            turn = turn @ _rotation(number, sign * size)
        elif part.kind == "tool":
            tools.append(at)
        else:
            before, at = at, at + turn @ (sign * size * np.eye(3)[number])
            if part.kind == "rod":
                ends += [before, at]
    return np.array(tools).reshape(-1, 3), np.array(ends).reshape(-1, 3)


def _rotation(axis: int, angle: float) -> Array:
    """The matrix of a rotation about a coordinate axis, by the right-hand rule."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found = np.eye(3)
    found[i, i] = found[j, j] = cos(angle)
    found[j, i], found[i, j] = sin(angle), -sin(angle)
    return found


def random_chain(seed: int, dimension: int = 3) -> list[Part]:
    """Two to eight parts, a rod with a tool, and up to two joints behind it.

    Joints often follow one another about one line.
    """
    rng = random.Random(seed)

    def part(*kinds: str) -> Part:
        kind = rng.choice(kinds)
        turns = kind in ("revolute", "turn")
        axes = ("x", "z", "z", "-z")
        if dimension == 2:
            axes = ("z", "-z") if turns else ("x", "-x")
        low = Fraction(rng.randint(-4, 0), 2)
        limits = low, low + Fraction(rng.randint(1, 6), 2)
        size = Fraction(rng.randint(1, 9), 4)
        return Part(kind, rng.choice(axes), size, limits if rng.random() < 0.7 else None)

    joints = ("revolute", "prismatic")
    parts = [part("revolute", *joints, "rod", "turn", "tool") for _ in range(rng.randint(2, 8))]
    behind = [part(*joints) for _ in range(rng.randint(0, 2))]
    return [*parts, Part("rod", "x", Fraction(1)), Part("tool"), *behind]


# --- as a spec -----------------------------------------------------------------------------------

TOP = "[-0.3, 0.3] x [0.9, 1.1]"
"""Where a rod of 1 m points along y."""


def chain_spec(
    joints: dict[str, str],
    word: str,
    start: str,
    target: str = TOP,
    modules: int = 8,
    more: str = "",
) -> str:
    """A spec with one task, ``Go``: joints ``NAME: kind axis range``, rods ``L`` of 1 m along x.

    ``word`` is the ``matches`` of the family, with B first and E for the tool; ``more`` are further
    clauses.  With a target of three intervals the workspace is in space.
    """
    space = target.count(" x ") == 2
    where, box = ("space xyz", " x [-4, 4]") if space else ("plane xy", "")
    declared, rules, blocks = [], [], []
    for name, text in joints.items():
        kind, axis, _ = text.split(" ", 2)
        move = "rot" if kind == "revolute" else "move"
        declared.append(f"module {name} {{ role joint; dof q: {text}; }}")
        rules.append(f"on{name}: N -> N eps {name};")
        blocks.append(f"on{name} {{ this.frame = N.frame * {move}({axis}, {name}.q); }}")
    units = {"revolute": "effort <= 10 N*m;", "prismatic": "effort <= 10 N;"}
    efforts = dict.fromkeys(units[text.split()[0]] for text in joints.values())
    return f"""\
module B {{ role base; }}
{chr(10).join(declared)}
module L {{ role link; const length = 1 m; }}
module E {{ role effector; }}
edge eps;
grammar G {{
  start N;
  base: N -> B; link: N -> N eps L; tool: N -> N eps E;
  {" ".join(rules)}
  accept matches {word};
}}
semantics G {{
  base {{ this.frame = world; }}
  link {{ this.frame = N.frame * move(x, L.length);
         rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m); }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
  {chr(10).join(blocks)}
}}
workspace W {{ {where}; bounds box [-4, 4] x [-4, 4]{box} m; target T box {target} m; }}
task Go {{
  robot G; workspace W;
  start at ({start});
  reach T;
  {" ".join(efforts)}
  horizon 10 steps of 0.2 s;
  modules <= {modules};
  {more}
}}
"""
