"""Random tasks, synthesised, and their verdicts judged by MuJoCo and by brute force."""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from solvers.verifier.certified_tube import certified_tube
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.exported_motions import Replay, replay
from tests.oracles.hand_arms import SimulatedArm
from tests.oracles.hand_motions import SampledMotion
from tests.oracles.random_sweeps import counterexample, drives_reach, flooded
from tests.oracles.random_tasks import RandomTask, random_task
from tests.oracles.spec_figures import Figures, figures_of
from tests.soundness.judged_claims import along, at_ends

INFLATED = 1e-6
POSES = 1_000_000
FOUND, IMPOSSIBLE, UNKNOWN, REFUSED = 0, 3, 4, 5


@dataclass(frozen=True)
class Verdict:
    """The exit status of a synthesis, and what contradicts it, or None."""

    seed: int
    status: int
    objection: str | None
    confirmed_by: str


def _quiet(*arguments: object) -> tuple[int, str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = run([str(argument) for argument in arguments])
    return status, out.getvalue() + err.getvalue()


def tried(seed: int, scratch: Path, count: int = POSES) -> Verdict:
    """One random task, and the judgement of its verdict."""
    task = random_task(seed)
    spec, folder = scratch / f"task{seed}.srg", scratch / f"out{seed}"
    spec.write_text(task.text, encoding="utf-8")
    status, said = _quiet("synth", spec, "-o", folder, "--force")
    if status == REFUSED and ("SRG0603" in said or "SRG0604" in said):
        return Verdict(seed, status, None, "check")  # an obstacle happens to cover an end
    assert status in (FOUND, IMPOSSIBLE, UNKNOWN), (seed, status, said)
    assert "Traceback" not in said, (seed, said)
    figures = figures_of(task.text)
    if status == FOUND:
        return Verdict(seed, status, _driven(task, figures, folder), "MuJoCo")
    if status == IMPOSSIBLE:
        objection, by = _contradicted(task, figures, folder, count, seed)
        return Verdict(seed, status, objection, by)
    return Verdict(seed, status, None, "")


def farthest(folder: Path, seen: Replay) -> float:
    """By how much a motion leaves the certified tube at most, in SI units; 0 if never."""
    tube, every = certified_tube(folder), slice(None, None, 5)
    times = np.minimum(seen.times[every], tube.times[-1])
    outside, _ = tube.distances(times, seen.states[every])
    return float(outside.max(initial=0.0))


def _driven(task: RandomTask, figures: Figures, folder: Path) -> str | None:
    """What a motion in MuJoCo contradicts, or None."""
    exported = folder.with_suffix(".xml")
    status, said = _quiet("export", folder, "--to", "mjcf", "-o", exported)
    if status:
        return f"no export: {said}"
    claim = result_files.read(folder)
    seen = replay(exported.read_text(encoding="utf-8"), claim)
    report = verify_directory(folder)
    if report.outcome is not Outcome.VALID:
        return f"not verified: {report.reason}"
    gap = farthest(folder, seen)
    if gap > INFLATED:
        return f"{gap:.3g} outside of the tube"
    values = {p["symbol"]: float(p["value"]) for p in claim["parameters"]}
    arm = SimulatedArm(task.arm(claim["word"], values), figures.gravity)
    tips, bodies = arm.points(seen.states[:, : len(arm.joints)])
    if np.abs(tips - seen.tips).max() > 1e-9:
        return "the exported robot has its effector elsewhere"
    motion = SampledMotion(seen.substeps, float(figures.dt), seen.states, tips, bodies)
    least, what = min([*along(motion, arm, figures), *at_ends(motion, arm, figures, 0)])
    return None if least > 0 else f"{what}: {least:.3g}"


def _contradicted(
    task: RandomTask, figures: Figures, folder: Path, count: int, seed: int
) -> tuple[str | None, str]:
    """Why a task may be possible after all, or None; and what shows that it is not."""
    if verify_directory(folder).outcome not in (Outcome.VALID, Outcome.UNCHECKED):
        return "not verified", ""
    lengths = counterexample(task, figures, count, seed)
    if lengths is None:
        return None, "no poses"
    free = [len(task.free_lengths(word)) for word in task.words]
    pairs = zip(task.words, free, strict=True)
    ways = [word for word, n in pairs if flooded(task, figures, word, lengths[:n], 300)]
    if not ways:
        return None, "no way"
    if drives_reach(task, figures, lengths, seed):
        return f"lengths {lengths} reach the target", ""
    return None, "weak drives"
