"""Closed loops, with disturbances at random and at corners, stay in the tubes proved of them.

The robot is MuJoCo's, the method of integration SciPy's, the law is applied by hand: nothing is
shared with the proof.
"""

from __future__ import annotations

from math import radians
from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.certified_tube import certified_tube
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.hand_arms import HandArm, SimulatedArm
from tests.oracles.hand_motions import sampled_motion
from tests.oracles.small_specs import replaced

ROOT = Path(__file__).parents[2]
BOUND, START, EFFORT, MASS, MEASURED = 10.0, 0.2, 0.001, 0.005, (0.02, 0.05)
"""N*m; degrees and degrees per second; parts of the bound, and of all masses; what is misread."""
CLAUSES = f"""\
  control feedback;
  robust start {START} deg, {START} deg/s;
  robust effort {100 * EFFORT} % of bound;
  robust mass {100 * MASS} %;
  robust measure {MEASURED[0]} deg, {MEASURED[1]} deg/s;
"""
PIECES, FINE = 4, 3
"""How often errors of inputs may change within a step, and how often a piece is looked at."""
ROUNDING = 0.005
"""N*m; much more than computers round, so that it is seen whether the tube has room for it."""
CLOSE = 1e-8
"""What the integration of the oracle may be off by, in SI."""


def spec(gravity: str) -> str:
    text = (ROOT / "specs" / "robust_arm.srg").read_text(encoding="utf-8")
    for line in [line for line in text.splitlines() if "robust " in line and ";" in line]:
        if line.strip().startswith("robust "):
            text = replaced(text, line + "\n", "")
    end = text.rindex("}")
    return text[:end] + CLAUSES + gravity + text[end:]


def flat_arm(claim: dict, factor: float) -> HandArm:
    """The arm of ``specs/robust_arm.srg`` with all masses times a factor."""
    made, values = HandArm(), {p["symbol"]: float(p["value"]) for p in claim["parameters"]}
    for index, symbol in enumerate(claim["word"]):
        if symbol == "Joint":
            made.joint(index, 2, limits=(-np.pi, np.pi))
        elif symbol in ("Upper", "Fore"):
            density = factor * (4 if symbol == "Upper" else 2)
            made.rod(0, values[index], density).move(values[index])
        elif symbol == "Hand":
            made.point(factor * 0.5).effector()
    return made


def signs(rng: np.random.Generator, shape: tuple[int, ...], *, corner: bool) -> np.ndarray:
    return rng.choice((-1.0, 1.0), shape) if corner else rng.uniform(-1, 1, shape)


def rounded(content: dict) -> None:
    for item in content["claims"]:
        item["rounding"] = [str(ROUNDING) for _ in item["rounding"]]


@pytest.mark.slow
@pytest.mark.parametrize("gravity", ["", "  gravity (0, -3) m/s^2;\n"], ids=["flat", "hanging"])
def test_no_disturbed_motion_leaves_the_tube(gravity: str, tmp_path: Path) -> None:
    path, folder = tmp_path / "arm.srg", tmp_path / "out"
    path.write_text(spec(gravity), encoding="utf-8")
    assert run(["synth", str(path), "-q", "-o", str(folder)]) == 0
    assert verify_directory(folder).outcome is Outcome.VALID
    claim = result_files.alter(folder, rounded, sign=True)
    tube = certified_tube(folder)
    (law,) = [item for item in claim["claims"] if item["kind"] == "controller"]
    planned, reference = np.array(claim["inputs"], float), np.array(law["reference"], float)
    gains, start = np.array(law["gains"], float), np.array(claim["start"], float)
    n, dt = len(start) // 2, float(tube.times[-1]) / len(planned)
    read = np.radians([MEASURED[0]] * n + [MEASURED[1]] * n)
    rng, most = np.random.default_rng(0), 0.0
    down = (0, -3, 0) if gravity else (0, 0, 0)
    for number in range(20):
        corner = number % 2 == 0
        factor = 1 + MASS * float(signs(rng, (1,), corner=corner)[0])
        arm = SimulatedArm(flat_arm(claim, factor), down)
        state = start + radians(START) * signs(rng, start.shape, corner=corner)
        effort = EFFORT * BOUND
        held = signs(rng, (planned.shape[1],), corner=True)
        for k, u in enumerate(planned):
            seen = state[: 2 * n] + read * signs(rng, state[: 2 * n].shape, corner=corner)
            commanded = u - gains[k] @ (seen - reference[k])
            commanded += ROUNDING * signs(rng, u.shape, corner=corner)
            most = max(most, float(np.abs(commanded).max()))
            for piece in range(PIECES):
                error = held if number % 4 == 0 else signs(rng, held.shape, corner=corner)
                applied = [commanded + effort * error]
                motion = sampled_motion(arm, state, applied, dt / PIECES, FINE)
                begun = (k + piece / PIECES) * dt
                for i, at in enumerate(motion.states[1:], 1):
                    time = min(begun + i * dt / PIECES / FINE, float(tube.times[-1]))
                    bounds = tube.at(time)
                    assert (at[: 2 * n] >= bounds[:, 0] - CLOSE).all(), (number, time)
                    assert (at[: 2 * n] <= bounds[:, 1] + CLOSE).all(), (number, time)
                state = motion.states[-1]
    # The oracle's feedback is at work: it commands what the plan does not.
    assert most > float(np.abs(planned).max()) + 0.01
