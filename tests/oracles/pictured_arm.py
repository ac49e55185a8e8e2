"""A planar arm of two links of different lengths with a mesh of every kind, seen where by hand."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import trimesh

from tests.oracles import result_files
from tests.oracles.found_folders import claim_found
from tests.oracles.mesh_files import WEDGE, text_stl, tube

SPEC = """\
module B { role base; port out: T; frame out = in;
  visual(frame: in * move(x, -10 cm), file: "seen/foot.dae", scale: 2 m);
  box(frame: in, size: (6, 6) cm); }
module J { role joint; dof q: revolute z; port in: T; port out: U;
  frame turned = in * rot(z, q); frame out = turned * move(x, 40 cm);
  visual(frame: turned * move((10, 2) cm) * rot(z, 30 deg), file: "seen/tube.stl", scale: 1 mm);
  box(frame: turned * move(x, 20 cm), size: (40, 4) cm);
  solid(frame: turned, mass: 2 kg, com: (10, 0) cm, inertia: 0.02 kg*m^2); }
module K { role joint; dof q: revolute z; port in: U; port out: V;
  frame turned = in * rot(z, q); frame out = turned * move(x, 25 cm);
  visual(frame: turned, file: "seen/wedge.obj", scale: 2 mm);
  box(frame: turned * move(x, 12 cm), size: (24, 4) cm);
  solid(frame: turned, mass: 1 kg, com: (12, 0) cm, inertia: 0.01 kg*m^2); }
module E { role effector; port in: V; effector(frame: in);
  visual(frame: in * rot(z, 90 deg), file: "seen/hand.glb", scale: 10 cm); }
grammar G from ports { start B; with J, K, E; }
workspace W {
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region S box [-1, 1] x [-1, 1] m;
  target T box [-1.5, 1.5] x [-1.5, 1.5] m;
}
task Go { robot G; workspace W; start in S at rest; reach T;
  effort <= 5 N*m; horizon 6 steps of 0.125 s; }
"""
WORD, JOINTS, EFFECTORS = "B J K E", ("J_1", "K_2"), ("E_3",)
LINKS = ("B_0", "J_1_link", "K_2_link")
START = (0.3, -0.5)
FOOT = trimesh.creation.box((0.03, 0.05, 0.07))
HAND = trimesh.creation.cone(radius=0.3, height=0.8, sections=9)


def files() -> dict[str, bytes]:
    """Meshes by their names beside the spec, those in other formats as trimesh writes them."""
    foot = FOOT.export(file_type="dae")
    assert b"<up_axis>Y_UP<" in foot
    return {
        "seen/foot.dae": foot.replace(b"<up_axis>", b'<unit meter="0.5"/><up_axis>'),
        "seen/tube.stl": text_stl(tube()),
        "seen/wedge.obj": WEDGE.encode(),
        "seen/hand.glb": HAND.export(file_type="glb"),
    }


def pictured_arm(
    folder: Path, changed: Mapping[str, bytes] | None = None, text: str = SPEC
) -> Path:
    """A result folder that claims a random motion of it."""
    rng = Random(5)

    def drive(content: dict[str, Any]) -> None:
        content["start"] = [*(str(q) for q in START), "0.4", "-0.2"]
        content["inputs"] = [[f"{rng.uniform(-0.1, 0.1):.6f}" for _ in JOINTS]
                             for _ in range(content["steps"])]  # fmt: skip

    made = claim_found(folder, text, WORD, [], {**files(), **(changed or {})})
    result_files.alter(made, drive, sign=True)
    return made


def turn(angle: float) -> np.ndarray:
    """About z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def seen(q: np.ndarray) -> dict[str, np.ndarray]:
    """The vertices of each link's visuals in the world, by the coordinates of the joints."""
    stl = np.array(tube()).reshape(-1, 3) / 1000
    wedge = np.array([[float(x) for x in line.split()[1:]] for line in WEDGE.splitlines()
                      if line.startswith("v ")]) / 500  # fmt: skip
    elbow = turn(q[0]) @ (0.4, 0, 0)
    fore = turn(q[0] + q[1])
    # One of the file is half a metre, by the file, and its scale says twice that.
    foot = FOOT.vertices * 0.5 * 2 + (-0.1, 0, 0)
    hand = elbow + (0.1 * HAND.vertices @ turn(np.pi / 2).T + (0.25, 0, 0)) @ fore.T
    return {
        "B_0": foot,
        "J_1_link": (stl @ turn(np.pi / 6).T + (0.1, 0.02, 0)) @ turn(q[0]).T,
        "K_2_link": np.concatenate([elbow + wedge @ fore.T, hand]),
    }
