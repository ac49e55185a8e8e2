"""Families of tasks in ``benchmarks/tasks`` that grow in one measure: links, cells, modules, steps.

python benchmarks/task_families.py            # write their files again
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Callable
from pathlib import Path

from timing import ROOT

sys.path.insert(0, str(ROOT))

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical

TASKS = Path(__file__).with_name("tasks")

ARM = """\
// {title}
module Base {{ role base; port out: Socket; frame out = in; }}

module Limb {{
  role link;
  dof q: revolute z in [-150, 150] deg;
  param length in [{low}, {high}] m;
  port in: Socket;
  frame joint = in * rot(z, q);
  port out: Socket;
  frame out = joint * move(x, length);
  rod(frame: joint, axis: x, length: length, density: 1 kg/m);
}}

module Hand {{
  role effector;
  port in: Socket;
  point(frame: in, mass: 200 g);
  effector(frame: in);
}}

grammar Arm from ports {{
  start Base;
  with Limb, Hand;
  accept count(Limb) == {links};
}}

workspace Table {{
  plane xy;
  bounds box [-2.5, 2.5] x [-2.5, 2.5] m;
  region Home box [1.2, 1.5] x [0, 0.3] m;
  target Shelf box [-0.3, 0] x [1.2, 1.5] m;
  obstacle Post hull (0.55, 0.75), (0.8, 0.7), (0.85, 0.9), (0.6, 0.95) m;
}}

task Fetch {{
  robot Arm;
  workspace Table;
  start in Home at rest;
  reach Shelf;
  avoid Post with effector margin 2 cm;
  effort <= 20 N*m;
  horizon {steps} steps of {step} s;
}}
"""

GANTRY = """\
// {title}
module Portal {{ role base; }}
module Bridge {{ role joint; dof d: prismatic x in [0, 10] m; }}
module Trolley {{ role joint; dof d: prismatic y in [0, 10] m; const mass = 3 kg; }}
module Hook {{ role effector; const mass = 2 kg; }}
edge bolt;

grammar Crane {{
  start N;
  portal: N -> Portal;
  bridge: N -> N bolt Bridge;
  trolley: N -> N bolt Trolley;
  hook: N -> N bolt Hook;
  accept matches Portal bolt Bridge bolt Trolley bolt Hook;
}}

semantics Crane {{
  portal {{ this.frame = world; }}
  bridge {{ this.frame = N.frame * move(x, Bridge.d); }}
  trolley {{
    this.frame = N.frame * move(y, Trolley.d);
    point(frame: this.frame, mass: Trolley.mass);
  }}
  hook {{ this.frame = N.frame; point(frame: N.frame, mass: Hook.mass); effector(frame: N.frame); }}
}}

workspace Yard {{
  plane xy;
  bounds box [0, 10] x [0, 10] m;
  region Dock box [0.1, 0.5] x [0.1, 0.5] m;
  target Gate box [9.5, 9.9] x [9.5, 9.9] m;
{obstacles}
}}

task Cross {{
  robot Crane;
  workspace Yard;
  start in Dock at rest;
  reach Gate;
  avoid {names} with effector;
  effort <= 40 N;
  horizon 40 steps of 0.25 s;
}}
"""

KIT = """\
// {title}
module Base {{ role base; port out: Socket; frame out = in; }}
{limbs}
module Hand {{ role effector; port in: Socket; effector(frame: in); }}

grammar Arm from ports {{
  start Base;
  with {names}, Hand;
}}

workspace Table {{
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region Home box [1.54, 1.58] x [-0.05, 0.05] m;
  target Bin box [-0.2, 0.1] x [1.2, 1.5] m;
  obstacle Post hull (0.5, 0.45), (0.75, 0.4), (0.7, 0.6) m;
}}

task Sort {{
  robot Arm;
  workspace Table;
  start in Home at rest;
  reach Bin;
  avoid Post with effector margin 1 cm;
  effort <= 10 N*m;
  modules <= 4;
  horizon 30 steps of 0.1 s;
}}
"""
LIMB = """
module Limb{number} {{
  role link;
  const length = {length} m;
  dof q: revolute z in [-160, 160] deg;
  port in: Socket;
  frame joint = in * rot(z, q);
  port out: Socket;
  frame out = joint * move(x, length);
  rod(frame: joint, axis: x, length: length, density: 1.5 kg/m);
}}
"""


def links(size: int) -> str:
    """An arm of so many limbs, which together are as long as those of any other size."""
    title = f"An arm of {size} limbs, whose lengths are free, takes its hand round a post."
    low, high = f"{1 / size:.3g}", f"{2 / size:.3g}"
    return ARM.format(title=title, low=low, high=high, links=size, steps=40, step="0.05")


def horizon(size: int) -> str:
    """The arm of two limbs with so many steps in eight seconds."""
    title = f"An arm of two limbs takes its hand round a post, in {size} steps."
    step = f"{8 / size:.6g}"
    return ARM.format(title=title, low="0.5", high="1", links=2, steps=size, step=step)


def cells(size: int) -> str:
    """A gantry among so many quadrilaterals, turned anyhow; a square number."""
    rng, side = random.Random(size), math.isqrt(size)
    pitch, hulls = 9.0 / side, list[str]()
    for number in range(size):
        row, column = divmod(number, side)
        x = 0.5 + pitch * (column + rng.uniform(0.4, 0.6))
        y = 0.5 + pitch * (row + rng.uniform(0.4, 0.6))
        first, radius = rng.uniform(0, math.tau), 0.3 * pitch
        corners = ", ".join(
            f"({x + radius * math.cos(angle):.2f}, {y + radius * math.sin(angle):.2f})"
            for angle in (first + math.tau * corner / 4 for corner in range(4))
        )
        hulls.append(f"  obstacle Crate{number + 1} hull {corners} m;")
    names = ", ".join(f"Crate{number + 1}" for number in range(size))
    title = f"A crane takes its hook through a yard with {size} crates."
    return GANTRY.format(title=title, obstacles="\n".join(hulls), names=names)


def modules(size: int) -> str:
    """A kit with so many limbs of different lengths, of which few pairs are long enough."""
    limbs = "".join(
        LIMB.format(number=number + 1, length=f"{0.4 + 0.4 * (number + 1) / size:.3f}")
        for number in range(size)
    )
    names = ", ".join(f"Limb{number + 1}" for number in range(size))
    title = f"Which two of {size} limbs make an arm that is long enough?"
    return KIT.format(title=title, limbs=limbs, names=names)


FAMILIES: dict[str, tuple[Callable[[int], str], tuple[int, ...]]] = {
    "links": (links, (1, 2, 3, 4, 5, 6, 7)),
    "cells": (cells, (4, 9, 16, 36, 64)),
    "modules": (modules, (2, 4, 8, 16)),
    "horizon": (horizon, (20, 40, 80, 160, 320)),
}
"""By name: the text of a task by its size, and the sizes of the set."""


def family_files() -> dict[str, str]:
    """The texts by the names of their files, formatted as `srgc fmt` does."""
    return {
        f"{name}_{size:03}.srg": formatted(text(size))
        for name, (text, sizes) in FAMILIES.items()
        for size in sizes
    }


def formatted(text: str) -> str:
    """The canonical form of a text without errors."""
    made = canonical(text, Sink())
    if made is None:
        raise SystemExit(f"a text has syntax errors: {text.splitlines()[0]}")
    return made


def main() -> None:
    for name, text in family_files().items():
        (TASKS / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
