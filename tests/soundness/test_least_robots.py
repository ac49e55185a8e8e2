"""The least robots of random families are those that brute force and algebra say."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.priced_arms import PricedArms
from tests.oracles.result_files import read
from tests.oracles.some_cases import campaign

pytestmark = pytest.mark.usefixtures("without_pictures")

QUICK = ("--paths", "2", "--evaluations", "2")
FEW = (0, 1, 3, 5)
BLOCK = 5
BLOCKS = 10
SHARE = 5
"""The search tries at most one part of so many of all robots."""


def tried(seed: int, scratch: Path) -> tuple[int, int]:
    """How many robots a search has tried, and how many there are; it has found the least one."""
    arms = PricedArms(seed)
    spec, folder = scratch / f"arms{seed}.srg", scratch / f"out{seed}"
    spec.write_text(arms.text, encoding="utf-8")
    assert run(["synth", str(spec), "-o", str(folder), "-q", *QUICK]) == 0, seed
    assert verify_directory(folder).outcome is Outcome.VALID, seed
    (claim,) = (c for c in read(folder)["claims"] if c["kind"] == "objectives")
    stated = [(Fraction(each["value"]), Fraction(each["least"])) for each in claim["values"]]
    robot = tuple(name for name in read(folder)["word"] if name in arms.kinds)
    assert arms.does(robot), seed
    assert tuple(value for value, _ in stated) == arms.values(robot), seed
    assert tuple(least for _, least in stated) == arms.least, seed
    for wish, (value, least) in zip(arms.wishes, stated, strict=True):
        assert value <= wish.most(least), seed
    assert stated[-1][0] == stated[-1][1], seed
    return len(read(folder, "design.json")["structures_tried"]), len(arms.robots)


@pytest.mark.parametrize("seed", FEW)
def test_a_least_robot(seed: int, tmp_path: Path) -> None:
    count, every = tried(seed, tmp_path)
    assert SHARE * count <= every


@pytest.mark.parametrize("block", campaign(range(BLOCKS), 4))
def test_fifty_least_robots(
    block: int, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    counts = [tried(seed, tmp_path) for seed in range(BLOCK * block, BLOCK * block + BLOCK)]
    record_property("tried", counts)
    assert SHARE * sum(count for count, _ in counts) <= sum(every for _, every in counts)
