"""Certificates of closed loops, altered at random in one number, before verifier and oracle."""

from __future__ import annotations

import json
import random
import re
import shutil
from collections import Counter
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.closed_chains import ClosedChain
from tests.soundness.spoilt_claims import exact_text

Content = dict[str, Any]
CORNERS = 8
CLOSE = 1e-8
"""What the oracle may be off by, in SI."""
PLANNED = 1e-13
"""The accuracy of the planned motion, of which nine digits are stated in a certificate."""
TINY = Fraction(1, 10**10)
KINDS = ("gain", "reference", "sample", "noise", "mass", "allowance", "start")


@dataclass(frozen=True)
class Altered:
    """What was done to a certificate and the text of its spec; ``size`` is relative, or absolute.

    ``is_tiny``: what holds with room to spare holds still.
    """

    kind: str
    size: Fraction
    content: Content
    text: str

    @property
    def is_tiny(self) -> bool:
        return abs(self.size) <= TINY


@dataclass(frozen=True)
class Trial:
    """What was said of an altered certificate, and the least margins that an oracle has seen."""

    name: str
    seed: int
    altered: Altered
    outcome: Outcome
    reason: str
    room: dict[str, float]

    @property
    def broken(self) -> bool:
        return min(self.room.values()) < -CLOSE

    def __str__(self) -> str:
        worst = min(self.room, key=self.room.__getitem__)
        what = f"{self.altered.kind} by {float(self.altered.size):.3g}"
        return (
            f"{self.name}, seed {self.seed}, {what}: "
            f"{self.outcome.value} ({self.reason}); oracle: {worst} {self.room[worst]:.3g}"
        )


def law(content: Content) -> Content:
    (found,) = [item for item in content["claims"] if item["kind"] == "controller"]
    assert isinstance(found, dict)
    return found


def altered(content: Content, text: str, seed: int) -> Altered:
    """One number changed: by a relative amount of any size, or by as much in its own unit."""
    chance = random.Random(seed)
    content = deepcopy(content)
    kind = KINDS[seed % len(KINDS)]
    exponent = chance.choice((-12, -11, -6, -4, -3, -2, -2, -1, -1, 0, 0, 1))
    size = chance.choice((-1, 1)) * Fraction(chance.randint(1, 9)) * Fraction(10) ** exponent

    def moved(old: str) -> str:
        value = Fraction(old)
        return exact_text(value + size * (abs(value) or 1))

    k = chance.randrange(len(content["inputs"]))
    if kind == "gain":
        row = chance.choice(law(content)["gains"][k])
        place = chance.randrange(len(row))
        row[place] = moved(row[place])
        if exponent >= 0:  # All the gains of a kind, so that the loop is another one.
            for step in law(content)["gains"]:
                for each in step:
                    each[place] = moved(each[place])
    elif kind == "reference":
        row = law(content)["reference"][k]
        place = chance.randrange(len(row))
        row[place] = moved(row[place])
    elif kind == "sample":
        row = content["inputs"][k]
        place = chance.randrange(len(row))
        row[place] = moved(row[place])
    elif kind == "start":
        place = chance.randrange(len(content["start"]) // 2)
        content["start"][place] = moved(content["start"][place])
    else:
        word = {"noise": "measure", "mass": "mass", "allowance": "effort"}[kind]
        found = chance.choice(list(re.finditer(rf"robust {word} ([\d.e-]+)", text)))
        # A radius or a percentage stays above zero, and a percentage below a hundred.
        value = Fraction(found[1]) * (1 + abs(size))
        value = min(value, Fraction(99)) if word != "measure" else value
        text = text[: found.start(1)] + exact_text(value) + text[found.end(1) :]
        size = abs(size)
    return Altered(kind, size, content, text)


class Loops:
    """Alters the certificate of one result again and again, in a folder of its own."""

    def __init__(
        self,
        name: str,
        made: Path,
        scratch: Path,
        densities: tuple[float, ...],
        links: str,
        corners: int = CORNERS,
    ) -> None:
        self.corners = corners
        self.name, self.folder = name, scratch / f"altered-{name}"
        self.densities, self.links = densities, links
        self.folder.mkdir(parents=True, exist_ok=True)
        shutil.copytree(made / "spec", self.folder / "spec", dirs_exist_ok=True)
        (self.spec,) = (self.folder / "spec").iterdir()
        self.text = self.spec.read_text(encoding="utf-8")
        self.content = result_files.read(made)

    def lengths(self, content: Content) -> list[float]:
        stated = [float(p["value"]) for p in content["parameters"] if p["name"] == "length"]
        return stated or [float(x) for x in re.findall(r"const length = ([\d.]+) m", self.text)]

    def loop(self, content: Content, text: str) -> ClosedChain:
        return ClosedChain(content, text, self.lengths, self.densities, self.links)

    def judge(self, seed: int) -> Trial:
        made = altered(self.content, self.text, seed)
        loop = self.loop(made.content, made.text)
        # A motion that explodes is none that keeps anything.
        with np.errstate(all="ignore"):
            states, commanded = loop.motion(loop.still(), PLANNED)
            peak = float(np.abs(commanded).max())
            room = loop.room(states, commanded) | loop.planned_room(states)
            rng = np.random.default_rng(seed)
            for corner in loop.corners(rng, self.corners):
                seen = loop.room(*loop.motion(corner))
                room |= {name: min(room[name], margin) for name, margin in seen.items()}
                if min(room.values()) < -CLOSE:
                    break
        # What is stated of the planned motion follows, so that the loop alone is judged; what is
        # too little to matter changes no digit of it.
        if not made.is_tiny:
            made.content["effort_peak"] = f"{peak:.12f}"
            made.content["robustness"] = f"{loop.bound - peak:.12f}"
        self.write(made)
        report = verify_directory(self.folder)
        return Trial(self.name, seed, made, report.outcome, report.reason or "", room)

    def write(self, made: Altered) -> None:
        self.spec.write_text(made.text, encoding="utf-8")
        value = result_files.spec_digest({self.spec.name: self.spec.read_bytes()})
        content = made.content | {"spec_sha256": value}
        content["digest"] = result_files.digest(content)
        result_files.write(self.folder, json.loads(json.dumps(content)))


def unsound(trial: Trial) -> bool:
    """Valid, though the oracle has seen a violation."""
    return trial.outcome is Outcome.VALID and trial.broken


def unjust(trial: Trial) -> bool:
    """Refuted, though what was done is too little to matter."""
    return trial.outcome is Outcome.REFUTED and trial.altered.is_tiny


def tally(trials: Iterable[Trial]) -> Counter[tuple[str, str]]:
    """How often the oracle saw a violation or none, and what was said."""
    return Counter(("broken" if t.broken else "kept", t.outcome.value) for t in trials)
