"""What a design uses of its inputs, against the rows of its certificate."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from srgc.report.used_inputs import used_inputs
from srgc.results.found_design import found_design
from tests.oracles import result_files
from tests.oracles.html_page import Page


@pytest.mark.parametrize(("spec", "bounds"), [("turner", [10]), ("motor", [24]), ("slider", [10])])
def test_peaks_and_margins(made: Callable[[str], Path], spec: str, bounds: list[float]) -> None:
    folder = made(spec) / "out"
    rows = np.array(
        [[float(Fraction(x)) for x in row] for row in result_files.read(folder)["inputs"]]
    )
    found = used_inputs(found_design(folder))
    assert [each.peak for each in found] == pytest.approx(np.abs(rows).max(axis=0))
    assert [each.margin for each in found] == pytest.approx(bounds - np.abs(rows).max(axis=0))


@pytest.mark.slow
def test_every_kind_of_joint_has_its_peak(pages: Callable[[str], tuple[Path, Page]]) -> None:
    """A turning joint and two sliding ones: a peak each, and the robustness in the unit it has."""
    folder, page = pages("prismatic")
    claim = result_files.read(folder)
    rows = np.array([[float(Fraction(x)) for x in row] for row in claim["inputs"]])
    torque, force = np.abs(rows[:, 0]).max(), np.abs(rows[:, 1:]).max()
    head = page.section("verdict")
    assert f"{torque:.4g} N·m and {force:.4g} N" in head
    unit = "N·m" if 20 - torque < 40 - force else "N"
    assert f"{min(20 - torque, 40 - force):.4g} {unit}" in head
