"""An arm on one joint whose link can be made longer, and the best that mechanics lets it do.

From rest, with a torque of at most u about a fixed axis, an arm of moment of inertia I turns by no
more than u T^2 / (2 I) within T; a constant torque does.  In steps of constant torque it is the
same.  Start and target are boxes, so that the angle between them depends on the reach alone.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from grammar_lang.load import load
from solvers.run_context import RunContext
from solvers.search.synthesis import Synthesis, synthesise
from tests.oracles.small_specs import TURNER, replaced

HORIZON = 2.0
BOUND = 1.0
LONGEST = 3.0
NEAR, FAR, HALF = 1.2, 1.9, 0.3


def extended_arm(extension: str, modules: int = 5) -> str:
    """A link of 1 to 2 m, then any number of links with lengths in ``extension``, all 1 kg/m."""
    text = replaced(
        TURNER, "module EN", f"module Z  {{ role link; param length in {extension} m; }}\nmodule EN"
    )
    text = replaced(text, "  tool:  N", "  more:  N -> N eps Z;\n  tool:  N")
    rule = (
        "  more  { this.frame = N.frame * move(x, Z.length);\n"
        "          rod(frame: N.frame, axis: x, length: Z.length, density: 1 kg/m); }\n"
    )
    text = replaced(text, "  tool  {", f"{rule}  tool  {{")
    text = replaced(
        text,
        "accept contains EN and starts with B eps JO;",
        "accept matches B eps JO eps L (eps Z)* eps EN;",
    )
    return replaced(text, "effort <= 10 N*m;", f"effort <= 1 N*m;\n  modules <= {modules};")


def all_designs(folder: Path, extension: str) -> Synthesis:
    """The best designs of the arm with one link and of the longer ones."""
    path = folder / "arm.srg"
    path.write_text(extended_arm(extension), encoding="utf-8")
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    return synthesise(program, task, RunContext(), every=True)


def best_robustness(least: float, most: float = LONGEST) -> float:
    """The largest rho with any reach from ``least`` to ``most`` metres."""
    reach = np.linspace(max(least, NEAR), min(most, np.hypot(FAR, HALF)), 20001)
    # The tip is in the start box at angles up to this, and in the target at as much below 90 deg.
    aside = np.minimum(np.arcsin(HALF / reach), np.arccos(np.minimum(1.0, NEAR / reach)))
    angle = np.pi / 2 - 2 * aside
    inertia = reach**3 / 3
    return BOUND - float(np.min(2 * inertia * angle / HORIZON**2))
