"""What `modular_search.py` asks of both sides, and that answers of its peer check our proofs."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from grammar_lang.load import load_text

ROOT = Path(__file__).parents[1]
ENDS = "Pick", "Place"


@pytest.fixture(scope="module")
def modular() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "benchmarks"))
        return importlib.import_module("modular_search")


@pytest.mark.parametrize(("seed", "free"), [(0, 0.0), (3, 0.0), (11, 0.4), (None, 0.0)])
def test_both_are_asked_the_same(modular: Any, seed: int | None, free: float) -> None:
    scene = modular.desk(6) if seed is None else modular.scene(seed, 6, free)
    program = load_text(scene.spec, "move.srg", ROOT).program
    assert program is not None
    task, place = program.tasks["Move"], program.workspaces["Hall"]
    asked = scene.for_peer(0, 100)
    assert task.modules == asked["modules"] + 1  # the floor is none of Timor's
    assert [each.kind for each in task.minimize] == asked["minimize"]
    walls = sorted(region.name for region in place.regions if region.name not in ENDS)
    assert len(walls) == len(asked["obstacles"])
    boxes = [*asked["goals"], *asked["obstacles"]]
    for name, (low, high) in zip([*ENDS, *walls], boxes, strict=True):
        rows = place.region(name).shape.rows
        ends = {tuple(map(float, row.normal)): float(row.offset) for row in rows}
        for axis, ways in enumerate(np.eye(3)):
            assert ends[tuple(ways)] == high[axis]
            assert ends[tuple(-ways)] == -low[axis]
    at = np.array(asked["placements"])
    assert np.abs(at[:, :2]).max() == free
    assert len(at) == (25 if free else 1)


@pytest.mark.parametrize("seed", range(20))
def test_goals_are_clear_of_pillars(modular: Any, seed: int) -> None:
    scene = modular.scene(seed, 7, 0.0)
    for low, high in scene.goals:
        for under, over in scene.walls[1:]:
            gaps = np.maximum(np.subtract(under, high), np.subtract(low, over))
            assert gaps[:2].max() > 0.1


ANSWER = {"found": True, "modules": ["0base", "J2", "J2", "eef"], "time": 0.3, "looked at": 9,
          "cpu": 1.0}  # fmt: skip


@pytest.mark.parametrize(
    "own",
    [
        {"verdict": "impossible"},
        {"verdict": "found", "modules": 5, "least": 5, "undecided": 0, "time": 0.4},
    ],
)
def test_an_answer_against_a_proof_ends_the_benchmark(modular: Any, own: dict[str, Any]) -> None:
    scene = modular.scene(0, 7, 0.0)
    with pytest.raises(SystemExit, match="contradicts the proof"):
        modular.line(scene, {"cpu": 1.0, "looked at": 3, **own}, [ANSWER])


@pytest.mark.parametrize("least", [4, 2])
def test_an_answer_that_needs_as_many_modules_does_not(modular: Any, least: int) -> None:
    own = {"verdict": "found", "modules": 4, "least": least, "undecided": 2, "time": 0.4,
           "cpu": 1.0, "looked at": 3}  # fmt: skip
    said = modular.line(modular.scene(0, 7, 0.0), own, [ANSWER, {**ANSWER, "found": False}])
    assert ("proved" in said) == (least == 4)
    assert "1/2" in said
