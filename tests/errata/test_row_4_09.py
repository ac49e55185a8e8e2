"""Row 4.9: Theorem 1, that a module more never lowers the best robustness."""

from __future__ import annotations

from pathlib import Path

from solvers.search.synthesis import Synthesis
from tests.oracles.extended_arm import all_designs, best_robustness


def robustness(result: Synthesis) -> list[float]:
    return [proved.design.robustness for proved in result.designs]


def test_where_the_hypothesis_holds_the_longer_robot_is_as_robust(tmp_path: Path) -> None:
    """Lengths from 0: the extension is neutral at 0, and any length of it only costs."""
    result = all_designs(tmp_path, "[0, 1]")
    shorter, longer = robustness(result)
    assert longer >= shorter - 1e-6
    # Both have the same optimum, that of mechanics, which no motion exceeds.
    optimum = best_robustness(1.0)
    assert optimum - 0.01 < shorter < optimum
    assert longer < optimum
    assert [proved.number for proved in result.designs] == [0, 1]
    assert result.ended is None


def test_where_it_fails_the_longer_robot_is_less_robust(tmp_path: Path) -> None:
    """Lengths from 0.5 m: the longer arm reaches 1.5 m at least; the proved motion beats that."""
    result = all_designs(tmp_path, "[0.5, 1]")
    shorter, longer = robustness(result)
    assert best_robustness(1.5) < shorter < best_robustness(1.0)
    assert longer < best_robustness(1.5) < shorter - 0.3
    assert [record.reason for record in result.records] == ["proved", "proved"]
