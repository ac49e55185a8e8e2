"""What `benchmarks/verify.py` measures is what it says."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.verify_arms import claimed_arm, end_radius
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.hand_arms import HandArm, SimulatedArm
from tests.oracles.hand_motions import sampled_motion

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize(("links", "gravity"), [(1, True), (2, False)])
def test_claimed_arms_are_proved_and_move(tmp_path, links, gravity):
    folder = claimed_arm(tmp_path, links, 12, gravity=gravity)
    assert verify_directory(folder).outcome is Outcome.VALID
    assert 0 < end_radius(folder) < 1e-3
    claim = result_files.read(folder)
    arm = HandArm()
    for item in claim["parameters"]:
        arm.joint(item["symbol"] - 2, 2).rod(0, float(item["value"]), 1).move(float(item["value"]))
    assert len({item["value"] for item in claim["parameters"]}) == links
    made = SimulatedArm(arm.effector(), (0, -9.81) if gravity else ())
    start = np.array([float(x) for x in claim["start"]])
    inputs = [np.array([float(u) for u in row]) for row in claim["inputs"]]
    motion = sampled_motion(made, start, inputs, 0.1, 4)
    rates = np.abs(motion.states[:, links:])
    assert 0.1 < rates.max() < 20
    fours = np.array(inputs).reshape(3, 4, links)
    assert np.abs(fours.sum(axis=1)).max() < 1e-9


@pytest.mark.slow
def test_the_benchmark_runs():
    command = [sys.executable, "benchmarks/verify.py", "--rounds", "1", "--specs", "right_linear"]
    command += ["--links", "1", "2", "--steps", "8", "16"]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout.count("exponent") == 2
    line = next(x for x in ran.stdout.splitlines() if x.startswith("right_linear"))
    synth, verify, ratio, *_ = (float(x) for x in line.split()[1:])
    assert abs(ratio - verify / synth) < 1e-3


@pytest.mark.slow
def test_both_arithmetics_are_measured():
    command = [sys.executable, "benchmarks/proofs.py", "--rounds", "1", "--joints", "2", "4"]
    command += ["--arms", "timor"]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    arm = next(line.split() for line in ran.stdout.splitlines() if line.startswith("timor"))
    assert float(arm[1]) > float(arm[2]) > 0
    assert float(arm[4]) > float(arm[2])
    rows = [line.split() for line in ran.stdout.splitlines() if line[:6].strip().isdigit()]
    assert [row[0] for row in rows] == ["2", "4"]
    for _, arb, doubles, ratio, *_ in rows:
        assert abs(float(ratio) - float(arb) / float(doubles)) < 0.05


def test_spatial_arms_are_claimed_rightly(tmp_path, monkeypatch):
    """Their proofs go through in either arithmetic; torques add up to nothing in four steps."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import proofs

    folder = proofs.claimed_arm(tmp_path, 3)
    proofs.check(folder)
    with proofs.arb_alone():
        proofs.check(folder)
    inputs = np.array(result_files.read(folder)["inputs"], float)
    assert np.abs(inputs.reshape(-1, 4, 3).sum(axis=1)).max() == 0
    assert (np.abs(inputs).max(axis=0) > 0.2).all()
