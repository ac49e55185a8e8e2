"""Row 4.15: what holds at the samples need not hold between them."""

from __future__ import annotations

from itertools import pairwise
from math import dist

import numpy as np

from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter, alter_spec, read
from tests.oracles.turning_link import one_link_tips


def test_two_free_samples_with_a_corner_between() -> None:
    """phi holds of samples at (1.6, 2.2) and (1.9, 1.9); half way is 5 cm inside the obstacle."""
    samples, steps = np.array([[1.6, 2.2], [1.9, 1.9]]), np.linspace(0, 1, 7)[:, None]
    way = samples[0] * (1 - steps) + samples[1] * steps

    def inside(point: np.ndarray) -> bool:
        return bool(1.7 <= point[0] <= 3 and 2 <= point[1] <= 3)

    assert not any(map(inside, samples))
    np.testing.assert_allclose(way[3], [1.75, 2.05])
    assert inside(way[3])


def test_an_obstacle_that_is_passed_between_two_samples(result):
    folder = result("turner")
    (folder / "design.json").unlink()
    content = read(folder)
    tips = one_link_tips(content, 2)
    samples = tips[::2]
    gaps = [dist(a, b) for a, b in pairwise(samples)]
    fastest = gaps.index(max(gaps))
    x, y = (round(value, 3) for value in tips[2 * fastest + 1])
    box = f"[{x - 0.01:.3f}, {x + 0.01:.3f}] x [{y - 0.01:.3f}, {y + 0.01:.3f}] m;"
    assert all(max(abs(a - x), abs(b - y)) > 0.02 for a, b in samples)
    alter_spec(folder, "box [1.4, 2.5] x [1.4, 2.5] m;", f"box {box}", sign=True)
    program = load(folder / "spec" / "turner.srg").program
    cells = abstract(program.workspaces["Table"])
    located = [cells.locate(np.array(point)) for point in samples]
    path = [cells.cells[index].name for index in located if index is not None]
    assert len(path) == 11
    assert "O" not in path
    alter(folder, lambda c: c.update(path=[path]), sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert report.reason.startswith("clearance of effector to O: violated at ")
    (failed,) = (f for f in report.conditions if f.name == "clearance of effector to O")
    assert fastest * 0.2 < failed.time < (fastest + 1) * 0.2
    assert failed.margin < 0
