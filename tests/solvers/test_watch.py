"""A verification says how far it has come, and can be ended from outside."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from solvers.verifier.proofs.scene import Watch
from solvers.verifier.verification import Outcome, verify_directory

Made = Callable[[str], Path]


class EnoughError(Exception):
    pass


def watched(folder: Path) -> tuple[list[tuple[int, int]], Outcome]:
    parts: list[tuple[int, int]] = []
    report = verify_directory(folder, watch=Watch(part=lambda done, of: parts.append((done, of))))
    return parts, report.outcome


@pytest.mark.parametrize("spec", ["turner", "closed"])
def test_the_steps_of_a_motion(made: Made, spec: str) -> None:
    parts, outcome = watched(made(spec) / "out")
    steps = len(json.loads((made(spec) / "out" / "certificate.json").read_text())["inputs"])
    assert outcome is Outcome.VALID
    # Every pass goes from the first step to the last; a disturbed motion has a pass of its own.
    begun = [number for number, (done, _) in enumerate(parts) if done == 1]
    assert len(begun) >= (2 if spec == "closed" else 1)
    for first, end in pairwise([*begun, len(parts)]):
        assert parts[first:end] == [(done, steps) for done in range(1, steps + 1)]


def test_the_structures_of_a_family(made: Made) -> None:
    parts, outcome = watched(made("beyond_reach") / "out")
    claim = json.loads((made("beyond_reach") / "out" / "certificate.json").read_text())
    count = len(claim["structures"])
    assert outcome is Outcome.VALID
    assert count > 0
    assert parts == [(done, count) for done in range(count)]


def test_what_a_tick_raises_ends_the_proof(made: Made) -> None:
    ticks = 0

    def tick() -> None:
        nonlocal ticks
        ticks += 1
        if ticks == 3:
            raise EnoughError

    with pytest.raises(EnoughError):
        verify_directory(made("turner") / "out", watch=Watch(tick))
