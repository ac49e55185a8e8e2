"""Altered certificates of closed loops: none is valid that breaks the task in a simulation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome
from tests.oracles.some_cases import campaign
from tests.soundness.altered_loops import (
    CORNERS,
    KINDS,
    PLANNED,
    Loops,
    Trial,
    tally,
    unjust,
    unsound,
)

LOOPS = {"closed": ((1.0,), "L"), "pair": ((1.0, 1.5), "LK")}
PARTS, PART = 10, 30
FEW = 2
"""Corners of the disturbances in the usual suite."""


def trials(
    made: Callable[[str], Path], scratch: Path, name: str, seeds: Iterable[int], corners: int
) -> list[Trial]:
    loops = Loops(name, made(name) / "out", scratch, *LOOPS[name], corners)
    found = [loops.judge(seed) for seed in seeds]
    assert [str(trial) for trial in found if unsound(trial)] == []
    assert [str(trial) for trial in found if unjust(trial)] == []
    return found


@pytest.mark.parametrize("name", LOOPS)
def test_the_oracle_follows_the_certified_loop(
    made: Callable[[str], Path], tmp_path: Path, name: str
) -> None:
    """Its planned motion has the stated peak, and no corner breaks the task."""
    loops = Loops(name, made(name) / "out", tmp_path, *LOOPS[name])
    loop = loops.loop(loops.content, loops.text)
    states, commanded = loop.motion(loop.still(), PLANNED)
    assert abs(commanded).max() == pytest.approx(float(loops.content["effort_peak"]), rel=1e-9)
    assert min((loop.room(states, commanded) | loop.planned_room(states)).values()) >= 0


@pytest.mark.parametrize(
    ("name", "seeds"),
    [
        ("closed", range(7)),
        pytest.param("pair", (4, 6), marks=pytest.mark.slow),
        pytest.param("pair", (0, 5, 6), marks=pytest.mark.slow),
    ],
)
def test_some_altered_loops(
    made: Callable[[str], Path], tmp_path: Path, name: str, seeds: Sequence[int]
) -> None:
    """All kinds of changes of one link, some of two, with few corners each."""
    found = trials(made, tmp_path, name, seeds, FEW)
    seen = tally(found)
    assert seen["broken", "valid"] == 0
    assert {trial.altered.kind for trial in found} == {KINDS[seed % len(KINDS)] for seed in seeds}
    assert seen["kept", "valid"] >= 1
    assert sum(seen["broken", each.value] for each in Outcome) >= 1


@pytest.mark.parametrize("part", campaign(range(1, PARTS + 1), 3))
@pytest.mark.parametrize("name", LOOPS)
def test_hundreds_of_altered_loops(
    made: Callable[[str], Path], tmp_path: Path, name: str, part: int
) -> None:
    """Three hundred, two of three about one link, in parts."""
    count = PART * (2 if name == "closed" else 1) // 3
    found = trials(made, tmp_path, name, range(1000 * part, 1000 * part + count), CORNERS)
    # Not every part has one that breaks the task.
    assert tally(found)["kept", "valid"] >= 1
