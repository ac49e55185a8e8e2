"""``bounds with body`` binds the capsule that a rod with a radius is, not only its axis."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter_spec


@pytest.mark.parametrize(
    ("radius", "outcome"),
    [("0.4", Outcome.VALID), ("0.999", Outcome.VALID), ("1.01", Outcome.REFUTED)],
)
def test_a_rod_as_thick_as_its_base_is_far_from_the_bounds(
    result: Callable[[str], Path], radius: str, outcome: Outcome
) -> None:
    """The rod turns about the origin, in the first quadrant; the bounds end one metre from it."""
    folder = result("turner")
    (folder / "design.json").unlink()
    alter_spec(folder, "horizon 10", "bounds with body;\n  horizon 10", sign=True)
    assert verify_directory(folder).outcome is Outcome.VALID
    alter_spec(folder, "L.density);", f"L.density, radius: {radius} m);", sign=True)
    assert verify_directory(folder).outcome is outcome
