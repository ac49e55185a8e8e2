"""Measure whole processes on what users may outgrow: obstacles, maps, long motions, structures.

Each kind is generated in several sizes and given to `srgc`; times are those of the processes.

    python benchmarks/outgrown.py obstacles --sizes 30 100 300
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from control_curves import exponent
from timing import machine

CART = """\
module Rail {{ role base; dof s: prismatic x in [0, {side}] m; }}
module Cross {{ role joint; dof s: prismatic y in [0, {side}] m; }}
module Cart {{ role effector; const mass = 4 kg; }}
grammar Mobile {{ start R; r: R -> Rail Cross Cart; }}
semantics Mobile {{
  r {{
    this.tip = world * move(x, Rail.s) * move(y, Cross.s);
    point(frame: this.tip, mass: Cart.mass);
    effector(frame: this.tip);
  }}
}}
workspace Hall {{
  plane xy;
  bounds box [0, {side}] x [0, {side}] m;
{obstacles}
  region Dock box [0.1, 0.6] x [0.1, 0.6] m;
  target Desk box [{near}, {far}] x [{near}, {far}] m;
}}
task Drive {{
  robot Mobile; workspace Hall;
  start in Dock at rest; reach Desk at rest;
  avoid {names} with effector;
  effort <= 400 N; horizon 60 steps of 0.25 s;
}}
"""
ARM = """\
module B { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module L { role link; param length in [0.5, 5] m; const density = 1 kg/m; }
module EN { role effector; }
grammar Arm {
  start N; base: N -> B; joint: N -> N JO; link: N -> N L; tool: N -> N EN;
  accept contains EN and starts with B JO;
}
semantics Arm {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Bench {
  plane xy; bounds box [0, %(side)s] x [0, %(side)s] m;
  region S box [0.8, 1.2] x [1.0, 1.4] m;
  obstacle O box [1.7, 3] x [2, 3] m;
  target T box %(target)s m;
}
task Reach {
  robot Arm; workspace Bench;
  start in S at rest; reach T; avoid O with effector;
  effort <= 10 N*m; modules <= %(modules)s;
  horizon %(steps)s steps of 0.1 s;
}
"""


def obstacles(size: int, folder: Path) -> Path:
    """A cart in a hall with so many boxes, one to a square metre."""
    rows = math.ceil(math.sqrt(size))
    rng, lines = np.random.default_rng(size), list[str]()
    for number in range(size):
        x, y = 1.2 + number % rows, 1.2 + number // rows
        low = rng.uniform(0, 0.4, 2) + np.array([x, y])
        high = low + rng.uniform(0.2, 0.4, 2)
        sides = " x ".join(f"[{a:.3f}, {b:.3f}]" for a, b in zip(low, high, strict=True))
        lines.append(f"  obstacle O{number} box {sides} m;")
    return _cart(folder, rows + 2.5, "\n".join(lines), ", ".join(f"O{i}" for i in range(size)))


def pixels(size: int, folder: Path) -> Path:
    """A cart on a map of so many pixels of 5 cm, a twentieth of them in boxes."""
    side = math.isqrt(size)
    rng, image = np.random.default_rng(size), np.full((side, side), 254, dtype=np.uint8)
    margin = 16
    for _ in range(max(1, size // 1200)):
        row, column = rng.integers(margin, max(margin + 1, side - margin), 2)
        height, width = rng.integers(4, 12, 2)
        image[row : row + height, column : column + width] = 0
    (folder / "hall.pgm").write_bytes(f"P5\n{side} {side}\n255\n".encode() + image.tobytes())
    (folder / "hall.yaml").write_text(
        "image: hall.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
        encoding="utf-8",
    )
    return _cart(folder, side * 0.05, '  obstacles from "hall.yaml";', "hall")


def _cart(folder: Path, side: float, lines: str, names: str) -> Path:
    spec = folder / "hall.srg"
    near, far = f"{side - 0.6:.3f}", f"{side - 0.1:.3f}"
    text = CART.format(side=f"{side:.3f}", obstacles=lines, names=names, near=near, far=far)
    spec.write_text(text, encoding="utf-8")
    return spec


def steps(size: int, folder: Path) -> Path:
    """An arm that takes so many steps of a tenth of a second."""
    return _arm(folder, side=5, target="[3.5, 4.2] x [3.8, 4.5]", modules=6, steps=size)


def modules(size: int, folder: Path) -> Path:
    """A target that no arm of so many modules reaches, however its joints and links follow."""
    return _arm(folder, side=60, target="[50, 51] x [50, 51]", modules=size, steps=40)


def _arm(folder: Path, **values: object) -> Path:
    spec = folder / "arm.srg"
    spec.write_text(ARM % values, encoding="utf-8")
    return spec


@dataclass(frozen=True)
class Kind:
    """What is generated, in which sizes, and what is run on it."""

    make: Callable[[int, Path], Path]
    sizes: tuple[int, ...]
    commands: tuple[tuple[str, ...], ...]


SYNTH = ("synth", "{spec}", "-o", "{folder}/result", "--quiet")
VERIFY = ("verify", "{folder}/result")
KINDS: Mapping[str, Kind] = {
    "obstacles": Kind(obstacles, (30, 100, 300, 1000), (("check", "{spec}"), SYNTH, VERIFY)),
    "pixels": Kind(pixels, (1000, 5000, 20000), (("check", "{spec}"), SYNTH, VERIFY)),
    "steps": Kind(steps, (60, 200, 600, 2000, 6000), (SYNTH, VERIFY)),
    "modules": Kind(modules, (6, 7, 8, 9), (SYNTH, VERIFY)),
}


@dataclass(frozen=True)
class Run:
    """A process: exit status, processor seconds, peak memory in MiB, and its first line."""

    status: int
    seconds: float
    mebibytes: float
    line: str


def run(arguments: list[str], limit: float) -> Run:
    """Run a command of srgc; status -1 where it takes longer than the limit."""
    with tempfile.TemporaryFile() as out:
        started = time.perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-m", "srgc", *arguments], stdout=out, stderr=subprocess.STDOUT
        )
        while True:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.perf_counter() - started > limit:
                process.kill()
                _, status, used = os.wait4(process.pid, 0)
                status = -1
                break
            time.sleep(0.01)
        out.seek(0)
        first = out.read().decode("utf-8", "replace").strip().split("\n")[0]
    code = -1 if status == -1 else os.waitstatus_to_exitcode(status)
    return Run(code, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, first)


def main() -> None:
    """Measure and print a table per kind."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", choices=[[], *KINDS], default=[])
    parser.add_argument("--sizes", type=int, nargs="+")
    parser.add_argument("--seconds", type=float, default=300.0, help="for one process")
    options = parser.parse_args()
    print(machine())
    for name in options.kinds or KINDS:
        kind = KINDS[name]
        print(f"\n{name}: {kind.make.__doc__}")
        times: dict[str, list[tuple[int, float]]] = {}
        for size in options.sizes or kind.sizes:
            with tempfile.TemporaryDirectory() as scratch:
                spec = kind.make(size, Path(scratch))
                for command in kind.commands:
                    filled = [part.format(spec=spec, folder=scratch) for part in command]
                    found = run(filled, options.seconds)
                    took = f"{found.seconds:.2f}" if found.status >= 0 else f"> {found.seconds:.0f}"
                    print(f"  {size:>6} {command[0]:<7}{took:>9} s {found.mebibytes:>6.0f} MiB  "
                          f"{found.line.replace(f'{scratch}/', '')[:90]}", flush=True)  # fmt: skip
                    if found.status < 0:
                        break
                    times.setdefault(command[0], []).append((size, found.seconds))
        for command, pairs in times.items():
            if len(pairs) > 1:
                slope, _ = exponent(*map(list, zip(*pairs, strict=True)))
                print(f"  exponent of {command}: {slope:.2f}")


if __name__ == "__main__":
    main()
