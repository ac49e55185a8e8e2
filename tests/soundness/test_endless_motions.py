"""Motions that go on for ever stay in the tube of one round, and begin each in the loop's set.

The robot is MuJoCo's, the method of integration SciPy's, the law is applied by hand.
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
from tests.soundness.test_closed_loops import signs

ROOT = Path(__file__).parents[2]
BOUND, START, EFFORT = 10.0, 0.5, 0.003
"""N*m; degrees and degrees per second; parts of the bound."""
ROUNDS, CLOSE = 5, 1e-8


def flat_arm(claim: dict) -> HandArm:
    """The arm of ``specs/patrol_forever.srg``."""
    made, values = HandArm(), {p["symbol"]: float(p["value"]) for p in claim["parameters"]}
    for index, symbol in enumerate(claim["word"]):
        if symbol == "Joint":
            made.joint(index, 2, limits=(-np.pi, np.pi))
        elif symbol in ("Upper", "Fore"):
            made.rod(0, values[index], 4 if symbol == "Upper" else 2).move(values[index])
        elif symbol == "Hand":
            made.point(1.0).effector()
    return made


@pytest.mark.slow
def test_no_round_leaves_the_tube(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    assert run(["synth", str(ROOT / "specs" / "patrol_forever.srg"), "-q", "-o", str(folder)]) == 0
    assert verify_directory(folder).outcome is Outcome.VALID
    tube, claim = certified_tube(folder), result_files.read(folder)
    claims = {item["kind"]: item for item in claim["claims"]}
    law, loop = claims["controller"], claims["loop"]
    planned, reference = np.array(claim["inputs"], float), np.array(law["reference"], float)
    gains, start = np.array(law["gains"], float), np.array(claim["start"], float)
    first, centre = loop["first"], np.array(loop["centre"], float)
    into = np.linalg.inv(np.array(loop["generators"], float))
    dt, count = float(tube.times[-1]) / len(planned), len(planned)
    rng, farthest = np.random.default_rng(0), 0.0
    arm = SimulatedArm(flat_arm(claim), (0, 0, 0))
    for number in range(4):
        corner = number % 2 == 0
        state = start + radians(START) * signs(rng, start.shape, corner=corner)
        held = signs(rng, (planned.shape[1],), corner=True)
        for k in [*range(count), *list(range(first, count)) * (ROUNDS - 1)]:
            if k == first:
                inside = np.abs(into @ (state - centre))
                assert (inside <= 1).all(), (number, inside)
                farthest = max(farthest, float(inside.max()))
            commanded = planned[k] - gains[k] @ (state - reference[k])
            error = held if number < 2 else signs(rng, held.shape, corner=corner)
            applied = [commanded + EFFORT * BOUND * error]
            motion = sampled_motion(arm, state, applied, dt, 2)
            for i, at in enumerate(motion.states[1:], 1):
                bounds = tube.at(min(k * dt + i * dt / 2, float(tube.times[-1])))
                assert (at >= bounds[:, 0] - CLOSE).all(), (number, k)
                assert (at <= bounds[:, 1] + CLOSE).all(), (number, k)
            state = motion.states[-1]
    assert farthest > 0.1
