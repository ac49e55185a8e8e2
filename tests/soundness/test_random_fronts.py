"""The front of ``synth --all`` against the definition of dominance, in random families."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from srgc.cli import run
from tests.oracles.priced_slides import Kinds, priced_slides
from tests.oracles.result_files import read
from tests.oracles.slides import least_force
from tests.oracles.some_cases import campaign

pytestmark = pytest.mark.usefixtures("without_pictures")

FORCE = 20
"""The bound on the force, in N."""
FEW = 3
BLOCKS, BLOCK = 10, 10


def family(draw: random.Random) -> Kinds:
    """Slides of random masses and prices, of which some are too heavy, and some equal."""
    masses = (*(1, 1.5, 2, 2.5, 4, 7), *(30, 60))
    count = draw.randint(2, 6)
    return {f"K{i}": (draw.choice(masses), draw.randint(1, 5)) for i in range(count)}


def effort(folder: Path) -> float:
    """The largest share of its bound that a force of the motion has, to four digits."""
    largest = max(abs(float(value)) for row in read(folder)["inputs"] for value in row)
    return float(f"{largest / FORCE:.4g}")


def check(seed: int, scratch: Path) -> None:
    """The designs of a random family are all robots that do it; its front, those not dominated."""
    draw = random.Random(seed)
    kinds = family(draw)
    asked = draw.sample(["sum(price)", "mass", "effort", "modules"], draw.randint(1, 4))
    spec, out = scratch / f"front{seed}.srg", scratch / f"out{seed}"
    spec.write_text(priced_slides(f"minimize {' then '.join(asked)};", kinds), encoding="utf-8")
    able = {k for k, (mass, _) in kinds.items() if least_force(mass, 0.8, 2, stops=True) < FORCE}
    status = run(["synth", str(spec), "-o", str(out), "-q", "--all"])
    assert status == (0 if able else 3), seed
    if not able:
        return
    table = read(out, "pareto.json")
    entries = {each["word"][2]: each for each in (*table["designs"], *table["dominated"])}
    # Slides of one mass are one robot, unless the task asks for prices and these differ.
    told = 2 if "sum(price)" in asked else 1
    every, different = [kinds[k][:told] for k in entries], {kinds[k][:told] for k in able}
    assert sorted(every) == sorted(different), seed
    points = {}
    for kind, entry in entries.items():
        mass, price = kinds[kind]
        used = effort(out / entry["folder"])
        known = {"sum(price)": price, "mass": mass, "effort": used, "modules": 3}
        points[kind] = tuple(known[each] for each in asked)
    front = {
        kind
        for kind, own in points.items()
        if not any(
            other != own and all(x <= y for x, y in zip(other, own, strict=True))
            for other in points.values()
        )
    }
    assert {each["word"][2] for each in table["designs"]} == front, (seed, points)
    first = entries[read(out)["word"][2]]
    assert first["structure"] == table["chosen"], seed
    assert points[first["word"][2]] == min(points.values()), (seed, points)


@pytest.mark.parametrize("seed", range(FEW))
def test_a_front(seed: int, tmp_path: Path) -> None:
    check(seed, tmp_path)


@pytest.mark.parametrize("block", campaign(range(BLOCKS), 4))
def test_a_hundred_fronts(block: int, tmp_path: Path) -> None:
    for seed in range(BLOCK * block, BLOCK * block + BLOCK):
        check(seed, tmp_path)
