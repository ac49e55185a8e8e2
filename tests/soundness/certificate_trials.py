"""Spoilt certificates before the verifier and before an oracle that shares nothing with it."""

from __future__ import annotations

import json
import random
import shutil
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.hand_arms import SimulatedArm
from tests.oracles.spec_figures import figures_of
from tests.soundness.judged_claims import (
    InputRange,
    Judgement,
    Original,
    Truth,
    input_ranges,
    judged,
)
from tests.soundness.known_families import FAMILIES
from tests.soundness.spoilt_claims import spoilt

SHARES = {
    "turner": 26, "slider": 20, "motor": 14, "planar_arm_paper": 10, "right_linear": 8,
    "nested": 8, "spatial": 4, "planar_arm": 3, "planar_arm_body": 3, "two_arm": 2, "prismatic": 1,
    "motor_arm": 1,
}  # fmt: skip
"""How often the results are spoilt, of a hundred times; those that are quick to verify more."""


@dataclass(frozen=True)
class Trial:
    """One spoilt certificate: what was done to it, and what was said of it."""

    name: str
    seed: int
    how: str
    judgement: Judgement
    outcome: Outcome
    reason: str

    def __str__(self) -> str:
        said = f"{self.outcome.value} ({self.reason})"
        truth = f"{self.judgement.truth.value} ({self.judgement.why})"
        return f"{self.name}, seed {self.seed}, {self.how}: {said}; oracle: {truth}"


class Trials:
    """Spoils one result again and again, in a folder of its own."""

    def __init__(self, name: str, made: Path, scratch: Path) -> None:
        self.name, self.folder = name, scratch / f"spoilt-{name}"
        self.folder.mkdir(parents=True, exist_ok=True)
        shutil.copytree(made / "spec", self.folder / "spec", dirs_exist_ok=True)
        (self.spec,) = (self.folder / "spec").iterdir()
        text = self.spec.read_text(encoding="utf-8")
        design = result_files.read(made, "design.json")
        self.original = Original(result_files.read(made), text, design["cells"])
        self.family = FAMILIES[name]

    def ranges(self) -> list[InputRange]:
        """Those of the inputs of the result as it was made."""
        claim = self.original.certificate
        word = tuple(claim["word"])
        values = {p["symbol"]: float(p["value"]) for p in claim["parameters"]}
        figures = figures_of(self.original.text)
        arm = SimulatedArm(self.family.arm(word, values), figures.gravity)
        return input_ranges(word, arm, figures, self.family)

    def judge(self, seed: int) -> Trial:
        """One trial; what is not signed anew must be refused on the way."""
        chance = random.Random(f"{self.name} {seed}")
        good = self.original.certificate
        done = spoilt(chance, dict(good), self.original.text, self.ranges())
        content, another_spec = done.content, done.text != self.original.text
        self.spec.write_text(done.text, encoding="utf-8")
        result_files.write(self.folder, content)
        if another_spec or json.dumps(content) != json.dumps(good):
            bare = verify_directory(self.folder)
            assert bare.outcome is Outcome.REFUTED, (self.name, seed, done.how)
            assert "altered" in str(bare.reason), (self.name, seed, done.how, bare.reason)
        if another_spec:
            files = {self.spec.name: self.spec.read_bytes()}
            content["spec_sha256"] = result_files.spec_digest(files)
        content["digest"] = result_files.digest(content)
        result_files.write(self.folder, content)
        report = verify_directory(self.folder)
        if not another_spec and content.get("spec_sha256") != good["spec_sha256"]:
            truth = Judgement(Truth.FALSE, "another digest of the spec")
        else:
            truth = judged(content, done.text, self.original, self.family)
        return Trial(self.name, seed, done.how, truth, report.outcome, str(report.reason))


def drawn(count: int, seed: int, names: dict[str, int]) -> list[tuple[str, int]]:
    """Names of results, by their shares, each with a seed."""
    chance = random.Random(seed)
    chosen = chance.choices(list(names), list(names.values()), k=count)
    return [(name, 1000 * seed + i) for i, name in enumerate(chosen)]


def unsound(trial: Trial) -> bool:
    """A false claim that was accepted."""
    return trial.judgement.truth is Truth.FALSE and trial.outcome is Outcome.VALID


def unjust(trial: Trial) -> bool:
    """A true claim that was not."""
    errors = trial.reason.startswith("the spec has errors")
    return trial.judgement.truth is Truth.TRUE and trial.outcome is not Outcome.VALID and not errors


def tally(trials: list[Trial]) -> Counter[tuple[str, str]]:
    """How often which truth met which outcome."""
    return Counter((trial.judgement.truth.value, trial.outcome.value) for trial in trials)
