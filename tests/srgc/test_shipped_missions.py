"""The missions that come with srgc: what they cost, against the arms' geometry on a grid of angles.

Robots are written here as the lengths of their links; every link turns about its own joint.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy.ndimage import label

from tests.oracles import result_files
from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
Box = tuple[float, float, float, float]
Arm = tuple[float, ...]
Array = npt.NDArray[np.float64]
LIMIT = 160
SCENE = ROOT / "specs" / "changing_scene.srg"


@cache
def is_able(arm: Arm, source: Box, target: Box, bounds: Box | None, column: Box | None) -> bool:
    """Whether a way leads from one box to another, on a grid of the angles of all joints.

    Elbows and hand stay within bounds, the hand outside of a column.
    """
    angles = np.deg2rad(np.arange(-LIMIT, LIMIT + 1, 1.0))
    turns = np.meshgrid(*[angles] * len(arm), indexing="ij")
    heading, x, y = np.zeros_like(turns[0]), np.zeros_like(turns[0]), np.zeros_like(turns[0])
    allowed = np.ones(heading.shape, dtype=bool)
    for turn, length in zip(turns, arm, strict=True):
        heading = heading + turn
        x, y = x + length * np.cos(heading), y + length * np.sin(heading)
        if bounds is not None:
            allowed &= within(x, y, bounds)
    if column is not None:
        allowed &= ~within(x, y, column)
    parts, _ = label(allowed)
    first, last = (set(parts[allowed & within(x, y, box)]) for box in (source, target))
    return bool(first & last)


def within(x: Array, y: Array, box: Box) -> npt.NDArray[np.bool_]:
    return (box[0] <= x) & (x <= box[1]) & (box[2] <= y) & (y <= box[3])


def distance(old: Arm, new: Arm, module: int = 2) -> int:
    """Modules removed or added: a link alone where its joint stays, else both."""
    table = list(range(0, module * (len(new) + 1), module))
    for i, length in enumerate(old, 1):
        row = [i * module]
        for j, other in enumerate(new, 1):
            swap = table[j - 1] + (0 if length == other else 2)
            row.append(min(table[j] + module, row[-1] + module, swap))
        table = row
    return table[-1]


# --- a scene that changes -----------------------------------------------------------------------

NARROW = (-0.65, 0.65, -0.65, 0.65)
DAYS: dict[str, tuple[Box, Box, Box | None, Box | None]] = {
    "Monday": ((0.4, 0.55, -0.3, -0.1), (-0.2, 0.1, 0.4, 0.55), NARROW, None),
    "Tuesday": ((0.45, 0.6, -0.2, 0.1), (0.6, 0.9, 0.6, 0.9), None, None),
    "Wednesday": (
        (0.6, 0.9, 0.6, 0.9), (-0.3, 0, 1.1, 1.25), None, (0.4, 0.7, 0.95, 1.1),
    ),
    "Thursday": ((-0.3, 0, 1.1, 1.25), (-1.5, -1.3, -0.2, 0.2), None, None),
    "Friday": ((-0.55, -0.4, 0.1, 0.3), (-0.1, 0.2, -0.55, -0.4), NARROW, None),
}  # fmt: skip
ARMS: list[Arm] = [(a,) for a in (0.5, 0.8)] + [*product((0.5, 0.8), repeat=2)]


def able(day: str) -> list[Arm]:
    return [arm for arm in ARMS if is_able(arm, *DAYS[day])]


def least(days: Sequence[str]) -> int:
    """What the cheapest arms of the days cost, by trying all."""
    costs = dict.fromkeys(able(days[0]), 0)
    for day in days[1:]:
        costs = {
            arm: min(cost + distance(old, arm) for old, cost in costs.items()) for arm in able(day)
        }
    return min(costs.values())


def lengths(robot: dict[str, list[dict[str, float]]]) -> Arm:
    return tuple(value["value"] for value in robot["parameters"])


@pytest.fixture(scope="module")
def week(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from srgc.cli import run

    folder = tmp_path_factory.mktemp("week") / "out"
    assert run(["synth", str(SCENE), "--mission", "Week", "-o", str(folder), "-q"]) == 0
    return folder


def test_no_arm_does_all_days() -> None:
    assert not set.intersection(*(set(able(day)) for day in DAYS))
    assert least([*DAYS]) == 4


def test_the_week_at_once(week: Path, srgc: Run) -> None:
    design = result_files.read(week, "design.json")
    assert (design["cost"], design["least"]) == (4, 4)
    line = [lengths(robot) for robot in design["robots"]]
    assert all(arm in able(day) for day, arm in zip(DAYS, line, strict=True))
    assert sum(distance(old, new) for old, new in pairwise(line)) == 4
    ran = srgc("verify", week)
    assert ran.status == 0
    assert "changes 4: no robots cost less" in ran.out


def test_the_week_step_by_step(tmp_path: Path, srgc: Run) -> None:
    """Each step is the cheapest from the robot that there is; together they cost no less."""
    before = tmp_path / "Monday"
    assert srgc("synth", SCENE, "--task", "Monday", "-o", before, "-q").status == 0
    arm = lengths(result_files.read(before, "design.json"))
    total = 0.0
    for number, day in enumerate([*DAYS][1:], 1):
        after = tmp_path / day
        assert srgc("evolve", before, SCENE, "--task", day, "-o", after, "-q").status == 0
        design = result_files.read(after, "design.json")
        cheapest = min(distance(arm, other) for other in able(day))
        assert design["cost"] == design["least"] == cheapest
        arm, before = lengths(design["robots"][0]), after
        total += design["cost"]
        assert sorted(p.name for p in (after / "history").iterdir()) == [
            str(n) for n in range(1, number + 1)
        ]
        assert srgc("verify", after).status == 0
    # Who does not know what is to come pays more: which of the cheapest arms it is, is left open.
    assert total > least([*DAYS])


# --- two places ---------------------------------------------------------------------------------

CABIN, SEAT, PANEL = (-0.6, 0.6, -0.6, 0.6), (0.4, 0.5, -0.3, -0.1), (-0.2, 0.1, 0.4, 0.52)
GATE, CRATE = (0.75, 0.95, -0.45, -0.2), (0.1, 0.4, 0.75, 0.9)


def test_one_extension_is_enough(tmp_path: Path, srgc: Run) -> None:
    spec = ROOT / "specs" / "cabin_and_yard.srg"
    indoors = [r for r in (0.5, 0.9) if is_able((r,), SEAT, PANEL, CABIN, None)]
    outdoors = [r for r in (0.5, 0.9) if is_able((r,), GATE, CRATE, None, None)]
    assert (indoors, outdoors) == ([0.5], [0.9])
    ran = srgc("synth", spec, "--mission", "OneArm", "-o", tmp_path / "one", "-q")
    assert ran.status == 3
    assert srgc("verify", tmp_path / "one", "--expect", "impossible").status == 0
    assert srgc("synth", spec, "--mission", "GrowingArm", "-o", tmp_path / "two", "-q").status == 0
    design = result_files.read(tmp_path / "two", "design.json")
    assert (design["cost"], design["least"]) == (1, 1)
    assert srgc("verify", tmp_path / "two", "--mission", "GrowingArm").status == 0


# --- three benches ------------------------------------------------------------------------------

BENCHES: tuple[tuple[Box, Box], ...] = (
    ((0.5, 0.7, -0.6, -0.3), (0.4, 0.7, 0.4, 0.7)),
    ((0.9, 1.1, -0.5, -0.2), (0.2, 0.5, 1.05, 1.2)),
    ((0.2, 0.35, -0.35, -0.1), (0.9, 1.1, 0.2, 0.5)),
)


def works(arm: Arm) -> bool:
    return all(is_able(arm, *boxes, None, None) for boxes in BENCHES)


def test_one_arm_for_three_benches(tmp_path: Path, srgc: Run) -> None:
    assert not [r for r in (0.4, 0.6, 0.9) if works((r,))]
    spec = ROOT / "specs" / "three_benches.srg"
    assert srgc("synth", spec, "--mission", "Shift", "-o", tmp_path / "out", "-q").status == 0
    design = result_files.read(tmp_path / "out", "design.json")
    (price,) = design["objectives"]
    assert price["value"] == price["least"] == 100 + 2 * (250 + 40) + 80
    arms = {lengths(robot) for robot in design["robots"]}
    assert len(arms) == 1
    assert all(map(works, arms))
    ran = srgc("verify", tmp_path / "out", "--json")
    assert json.loads(ran.out)["outcome"] == "valid"


def test_a_file_with_missions_names_them_where_a_task_has_to_be_chosen(srgc: Run) -> None:
    ran = srgc("synth", ROOT / "specs" / "three_benches.srg")
    assert ran.status == 2
    assert "or one of the missions Shift" in ran.err
    assert "with --mission" in ran.err
