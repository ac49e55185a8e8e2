"""Motions off their start, with drives that are not exact: none has less margin than was proved."""

from __future__ import annotations

from math import pi, radians

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.hand_arms import HandArm, SimulatedArm
from tests.oracles.hand_motions import SampledMotion, sampled_motion
from tests.oracles.spec_figures import Figures, figures_of

START, EFFORT = radians(0.1), 0.005
"""What the spec of the arm allows: rad and rad/s, and a fraction of every input."""
PIECES = 4
"""How often the drives' errors may change within a step."""


def flat_arm(claim: dict) -> HandArm:
    made, values = HandArm(), {p["symbol"]: float(p["value"]) for p in claim["parameters"]}
    for index, symbol in enumerate(claim["word"]):
        if symbol == "Joint":
            made.joint(index, 2, limits=(-pi * 160 / 180, pi * 160 / 180))
        elif symbol in ("Upper", "Fore"):
            made.rod(0, values[index], 4 if symbol == "Upper" else 2).move(values[index])
        elif symbol == "Hand":
            made.point(0.5).effector()
    return made


def disturbed(
    claim: dict, arm: SimulatedArm, figures: Figures, rng: np.random.Generator, size: float
) -> SampledMotion:
    """A motion at the corners of what may be off, or with errors that follow a sign; in SI."""
    start = np.array([float(x) for x in claim["start"]])
    start = start + size * START * rng.choice((-1.0, 1.0), len(start))
    rows = np.repeat([[float(u) for u in row] for row in claim["inputs"]], PIECES, axis=0)
    signs = rng.choice((-1.0, 1.0), rows.shape)
    if rng.random() < 0.5:
        signs[:] = rng.choice((-1.0, 1.0), rows.shape[1])
    inputs = list(rows * (1 + size * EFFORT * signs))
    return sampled_motion(arm, start, inputs, float(figures.dt) / PIECES, 6)


def rooms(motion: SampledMotion, figures: Figures) -> dict[str, float]:
    """The least distances to what the task asks, by words in the names of findings."""
    post = [
        figures.areas["Post"].distance(motion.bodies[:, i]).min()
        for i in range(motion.bodies.shape[1])
    ]
    return {
        "to Post": float(min(post)) - 0.01,
        "target Tray": float(figures.areas["Tray"].slack(motion.tips[-1, 0])),
        "bounds": float(figures.bounds.slack(motion.tips[:, 0]).min()),
    }


@pytest.mark.slow
def test_no_disturbed_motion_has_less_margin_than_was_proved(made):
    folder = made("robust_arm")
    report = verify_directory(folder / "out")
    assert report.outcome is Outcome.VALID
    text = (folder / "robust_arm.srg").read_text(encoding="utf-8")
    assert "robust start 0.1 deg, 0.1 deg/s;" in text
    assert "robust effort 0.5 %;" in text
    claim, figures = result_files.read(folder / "out"), figures_of(text)
    arm, rng = SimulatedArm(flat_arm(claim), ()), np.random.default_rng(0)
    found = [rooms(disturbed(claim, arm, figures, rng, 1.0), figures) for _ in range(100)]
    planned = rooms(disturbed(claim, arm, figures, rng, 0.0), figures)
    for name, margin in planned.items():
        least = min(item[name] for item in found)
        margins = [f.margin for f in report.conditions if name in f.name]
        assert margins, name
        assert least >= min(margins) - 1e-9, name
        # The disturbances are felt, and the proof allows for few times what a hundred corners show.
        assert least < margin - 1e-5, name
        assert margin - min(margins) < 6 * (margin - least), name
