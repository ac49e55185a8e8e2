"""What a design uses of its inputs, against the rows of its certificate."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from srgc.cli import run
from srgc.results.found_design import found_design
from srgc.text_reports.synthesis_report import amount, used_inputs
from tests.oracles import result_files
from tests.oracles.small_specs import MOTOR, TURNER

pytestmark = pytest.mark.usefixtures("without_pictures")


@pytest.mark.parametrize(("spec", "bounds"), [("turner", [10]), ("motor", [24]), ("slider", [10])])
def test_peaks_and_margins(made: Callable[[str], Path], spec: str, bounds: list[float]) -> None:
    folder = made(spec) / "out"
    rows = np.array(
        [[float(Fraction(x)) for x in row] for row in result_files.read(folder)["inputs"]]
    )
    design = found_design(folder)
    found = used_inputs(design.model, design.task, design.claim.inputs)
    assert [each.peak for each in found] == pytest.approx(np.abs(rows).max(axis=0))
    assert [each.low for each in found] == rows.min(axis=0).tolist()
    assert [each.high for each in found] == rows.max(axis=0).tolist()
    assert [each.margin for each in found] == pytest.approx(bounds - np.abs(rows).max(axis=0))


def test_four_digits_and_a_unit_however_small() -> None:
    """The torques of a robot of centimetres and grams have no four decimals."""
    assert amount(3.21987e-6, "N*m") == "3.22e-06 N*m"
    assert amount(0.000123456, "N") == "0.0001235 N"
    assert amount(9.79783, "N*m") == "9.798 N*m"
    assert amount(0.5, "1") == "0.5"


SMALL = (
    TURNER.replace("[1, 2] m", "[1, 2] cm").replace("[-1, 3] x [-1, 3] m", "[-1, 3] x [-1, 3] cm")
    .replace("[1.2, 1.9] x [-0.3, 0.3] m", "[1.2, 1.9] x [-0.3, 0.3] cm")
    .replace("[1.4, 2.5] x [1.4, 2.5] m", "[1.4, 2.5] x [1.4, 2.5] cm")
    .replace("[-0.3, 0.3] x [1.2, 1.9] m", "[-0.3, 0.3] x [1.2, 1.9] cm")
    .replace("effort <= 10 N*m", "effort <= 0.0001 N*m")
)  # fmt: skip


def printed(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The lines about inputs that a synthesis prints."""
    (folder / "spec.srg").write_text(text, encoding="utf-8")
    assert run(["synth", str(folder / "spec.srg"), "-q", "-o", str(folder / "out")]) == 0
    lines = capsys.readouterr().out.splitlines()
    return [line for line in lines if line.startswith(("effort", "input", "robustness"))]


def test_what_is_printed_of_a_small_robot(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line, rest = printed(SMALL, tmp_path, capsys)
    claim = result_files.read(tmp_path / "out")
    peak = max(abs(Fraction(row[0])) for row in claim["inputs"])
    left = Fraction(1, 10_000) - peak
    assert 0 < peak < Fraction(1, 20_000)
    assert line == f"effort:  peak {float(peak):.4g} of 0.0001 N*m"
    share = 100 * left / Fraction(1, 10_000)
    assert rest == f"robustness: {float(share):.4g} % ({float(left):.4g} N*m)"


def test_what_is_printed_of_a_motor(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """No effort of a joint is free: none is said to be 0."""
    line, rest = printed(MOTOR, tmp_path, capsys)
    volts = [float(Fraction(row[0])) for row in result_files.read(tmp_path / "out")["inputs"]]
    left = min(24 - max(volts), 24 + min(volts))
    assert line == f"input:   M.voltage (symbol 2) {min(volts):.4g} to {max(volts):.4g} V"
    assert rest == f"robustness: {100 * left / 24:.4g} % ({left:.4g} V)"
