"""``srgc landscape``: rho over parameters, against what mechanics says of an arm on one joint."""

from __future__ import annotations

import csv
import json
import shutil
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import RobotModel
from compiler.words.structures import derivations_of
from grammar_lang.load import load_text
from srgc.cli.landscape import parsed_marks, parsed_ranges
from srgc.landscapes.landscape_request import LandscapeRequest, axes_of, refuse_marks
from srgc.session import UsageFault
from tests.oracles import result_files
from tests.oracles.extended_arm import FAR, NEAR, best_robustness
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def fits(reach: float, row: dict[str, str]) -> bool:
    """Whether rho is what mechanics allows, less the margins that a search keeps."""
    if reach < NEAR or best_robustness(reach, reach) < 0:
        return row["feasible"] == "0" and float(row["rho"]) < 0
    optimum = best_robustness(reach, reach)
    if optimum < 0.01 or reach < NEAR + 0.01:
        return float(row["rho"]) <= optimum
    return row["feasible"] == "1" and optimum - 0.02 < float(row["rho"]) <= optimum


# --- what is computed ----------------------------------------------------------------------------


def test_a_curve_over_one_length(srgc: Srgc, designs: Path) -> None:
    ran = srgc("landscape", designs, "--points", 11, "--mark", "1.5", "--label", "halfway")
    assert (ran.status, ran.err) == (0, "")
    found = rows(designs / "landscape.csv")
    assert list(found[0]) == ["4.length", "rho", "feasible"]
    lengths = [float(row["4.length"]) for row in found]
    np.testing.assert_allclose(lengths, np.linspace(1, 2, 11), rtol=1e-15)
    assert all(fits(length, row) for length, row in zip(lengths, found, strict=True))
    assert {row["feasible"] for row in found} == {"0", "1"}
    text = (designs / "figures" / "landscape.svg").read_text(encoding="utf-8")
    assert ">halfway, " in text
    (mark,) = (line for line in ran.out.splitlines() if line.startswith("mark:"))
    rho = float(mark.rpartition("rho ")[2].split()[0])
    assert best_robustness(1.5, 1.5) - 0.02 < rho <= best_robustness(1.5, 1.5)
    assert srgc("verify", designs).status == 0


BOTH = """\
module Base { role base; }
module Rail { role joint; dof d: prismatic y in [-1, 1] m; const mass = 2 kg; }
module Turn { role joint; dof q: revolute z in [-120, 120] deg; }
module Bar { role link; param length in [0.5, 1] m; const density = 2 kg/m; }
module Tip { role effector; }
grammar G { start N; whole: N -> Base Rail Turn Bar Tip; }
semantics G {
  whole {
    this.hub = move(y, Rail.d);
    point(frame: this.hub, mass: Rail.mass);
    this.at = this.hub * rot(z, Turn.q);
    rod(frame: this.at, axis: x, length: Bar.length, density: Bar.density);
    effector(frame: this.at * move(x, Bar.length));
  }
}
workspace W {
  plane xy; bounds box [-2, 2] x [-2, 2] m;
  region S box [0.5, 0.8] x [-0.4, 0] m; target T box [0, 0.4] x [0.9, 1.3] m;
}
task P {
  robot G; workspace W; start in S at rest; reach T; effort <= 40 N; effort <= 3 N*m;
  horizon 12 steps of 0.1 s;
}
"""


def test_where_bounds_differ_all_is_in_shares_of_them(srgc: Srgc, tmp_path: Path) -> None:
    """The least share of 40 N and of 3 N m is what a search makes large."""
    (tmp_path / "both.srg").write_text(BOTH, encoding="utf-8")
    out = tmp_path / "out"
    assert srgc("synth", tmp_path / "both.srg", "-o", out).status == 0
    share = 100 * result_files.read(out, "design.json")["robustness_share"]
    ran = srgc("landscape", out, "--points", 2)
    (own,) = (line for line in ran.out.splitlines() if line.startswith("design:"))
    told = own.rpartition("rho ")[2]
    assert told.endswith(" % of the bounds")
    assert float(told.split()[0]) == pytest.approx(share, abs=0.01)


def test_at_its_own_parameters_a_design_is_no_better(srgc: Srgc, designs: Path) -> None:
    """Its motion is proved, so that the best there is not less; a search begins with it."""
    folder = designs / "designs" / "1"
    design = result_files.read(folder, "design.json")
    own = ",".join(repr(parameter["value"]) for parameter in design["parameters"])
    ran = srgc("landscape", folder, "--points", 2, "--mark", own)
    assert ran.status == 0
    (mark,) = (line for line in ran.out.splitlines() if line.startswith("mark:"))
    assert float(mark.rpartition("rho ")[2].split()[0]) > design["robustness"] - 1e-3


def test_a_plane_over_two_lengths_the_same_for_any_jobs(
    srgc: Srgc, designs: Path, tmp_path: Path
) -> None:
    """Rho depends on the sum of the lengths alone; the rows go through the second one first."""
    folder, other = designs / "designs" / "1", tmp_path / "other"
    options = ("--over", "6.length,4.length", "--points", 5, "--range", "6.length=0.5:0.75")
    files = ("-o", other / "a" / "l.svg", "--csv", other / "l.csv")
    assert srgc("landscape", folder, *options, *files).status == 0
    found = rows(other / "l.csv")
    assert list(found[0]) == ["4.length", "6.length", "rho", "feasible"]
    pairs = [(float(row["6.length"]), float(row["4.length"])) for row in found]
    grid = [(z, length) for z in np.linspace(0.5, 0.75, 5) for length in np.linspace(1, 2, 5)]
    np.testing.assert_allclose(pairs, grid, rtol=1e-14)
    assert all(fits(sum(pair), row) for pair, row in zip(pairs, found, strict=True))
    assert max(sum(pair) for pair in pairs) > FAR
    ET.fromstring((other / "a" / "l.svg").read_text(encoding="utf-8"))
    ran = srgc("landscape", folder, *options, "--jobs", 2)
    assert ran.status == 0
    assert (folder / "landscape.csv").read_bytes() == (other / "l.csv").read_bytes()
    svg = (folder / "figures" / "landscape.svg").read_bytes()
    assert svg == (other / "a" / "l.svg").read_bytes()


def test_samples_of_the_search_are_shown(srgc: Srgc, designs: Path) -> None:
    count = sum(row["structure"] == "0" for row in rows(designs / "evaluations.csv"))
    assert f"samples: {count} of the search" in srgc("landscape", designs, "--points", 2).out
    assert ">search, feasible<" in (designs / "figures" / "landscape.svg").read_text()
    (designs / "evaluations.csv").unlink()
    assert "samples: 0 of the search" in srgc("landscape", designs, "--points", 2).out
    (designs / "evaluations.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    refused(srgc("landscape", designs), "is not a table of evaluations")


# --- what is asked for ---------------------------------------------------------------------------


def model(lengths: str, angles: str) -> RobotModel:
    text = replaced(
        TURNER,
        "module L  { role link; param length in [1, 2] m;",
        f"module L  {{ role link; param length in {lengths} m; param angle in {angles};",
    )
    loaded = load_text(text, "t.srg")
    assert loaded.program is not None, loaded.diagnostics
    family = RobotFamily(loaded.program, loaded.program.grammars["Turner"], 2)
    word = ("B", "eps", "JO", "eps", "L", "eps", "EN")
    return family.robot(next(iter(derivations_of(family.language, word))))


def request(
    over: str | None = None,
    ranges: tuple[str, ...] = (),
    marks: tuple[str, ...] = (),
    labels: tuple[str, ...] = (),
) -> LandscapeRequest:
    """As the command makes it of its options."""
    names = None if over is None else tuple(over.split(","))
    return LandscapeRequest(names, parsed_ranges(ranges), 4, parsed_marks(marks, labels))


def test_a_finite_set_is_taken_whole() -> None:
    length, angle = axes_of(model("{2, 0.5, 1.25}", "[-1, 1]"), request())
    assert (length.discrete, angle.discrete) == (True, False)
    assert length.values.tolist() == [0.5, 1.25, 2]
    assert angle.values.tolist() == pytest.approx([-1, -1 / 3, 1 / 3, 1])
    (length,) = axes_of(
        model("{2, 0.5, 1.25}", "[-1, 1]"),
        request(over="4.length", ranges=("4.length=0.5:1.5",)),
    )
    assert length.values.tolist() == [0.5, 1.25]


def test_what_cannot_vary_is_no_axis() -> None:
    (length,) = axes_of(model("[1, 2]", "{0.5}"), request())
    assert length.name == "4.length"
    with pytest.raises(UsageFault, match="one value only"):
        axes_of(model("[1, 2]", "{0.5}"), request(over="4.angle"))
    with pytest.raises(UsageFault, match="no parameter that may vary"):
        axes_of(model("[1, 1]", "{0.5}"), request())


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"over": "4.width"}, "has no parameter `4.width`: it has 4.length, 4.angle"),
        ({"over": "4.length,4.length"}, "two different ones"),
        ({"over": "4.length,4.angle,4.x"}, "two different ones"),
        ({"ranges": ("4.length=0.5:2",)}, "is not within [1, 2]"),
        ({"ranges": ("4.length=2:1",)}, "the lower end comes first"),
        ({"ranges": ("4.length=1:2", "4.length=1:1.5")}, "twice for one parameter"),
        ({"ranges": ("4.length=1.5",)}, "write it as in"),
        ({"ranges": ("4.length=1:x",)}, "`x` is not a number"),
        ({"ranges": ("4.length=1:nan",)}, "`nan` is not a number"),
        ({"over": "4.angle", "ranges": ("4.length=1:2",)}, "which --over does not name"),
        ({"marks": ("1.5",)}, "2 numbers are expected"),
        ({"marks": ("1.5,2",)}, "2 is not within [-1, 1]"),
        ({"marks": ("1.5,0",), "labels": ("a", "b")}, "more --label than --mark"),
    ],
)
def test_requests_that_are_refused(changes: dict[str, Any], reason: str) -> None:
    robot = model("[1, 2]", "[-1, 1]")

    def ask() -> None:
        asked = request(**changes)
        refuse_marks(axes_of(robot, asked), asked.marks)

    with pytest.raises(UsageFault) as caught:
        ask()
    assert reason in str(caught.value)


def test_a_mark_without_a_label_is_named_by_its_place() -> None:
    asked = request(marks=("1.5,0.25", "1,-1"), labels=("paper",))
    refuse_marks(axes_of(model("[1, 2]", "[-1, 1]"), asked), asked.marks)
    first, second = asked.marks
    assert (first.label, first.values) == ("paper", (1.5, 0.25))
    assert second.label == "(1,-1)"


# --- folders that are refused --------------------------------------------------------------------


def refused(ran: Ran, reason: str) -> None:
    assert (ran.status, ran.out) == (2, "")
    assert reason in ran.err
    assert ran.err.count("\n") == 1


def test_folders_without_a_design(
    srgc: Srgc, result: Callable[[str], Path], tmp_path: Path
) -> None:
    refused(srgc("landscape", tmp_path / "none"), "is not a folder")
    refused(srgc("landscape", tmp_path), "has no certificate")
    ran = srgc("landscape", result("beyond_reach"))
    assert (ran.status, ran.out) == (2, "")
    assert "error[SRG0735]: " in ran.err
    assert "its verdict is impossible\n  hint: " in ran.err
    refused(srgc("landscape", result("slider")), "no parameter that may vary")


def test_altered_folders(srgc: Srgc, designs: Path, tmp_path: Path) -> None:
    def copy() -> Path:
        target = tmp_path / "copy"
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(designs, target)
        return target

    folder = copy()
    spec = folder / "spec" / "arm.srg"
    spec.write_text(spec.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    refused(srgc("landscape", folder), "the spec has been altered")
    folder = copy()
    result_files.alter(folder, lambda content: content.update(robustness="0.9"), sign=False)
    refused(srgc("landscape", folder), "the certificate has been altered")
    folder = copy()
    result_files.alter(folder, lambda content: content.update(format=1), sign=True)
    refused(srgc("landscape", folder), "is not of format")
    for change, reason in (
        ({"version": "9.9"}, "holds results of srgc 9.9"),
        ({"robustness": 0.9}, "differ in `robustness`"),
        ({"leader": 7}, "does not say how the design was found"),
        ({"structures_tried": []}, "does not say how the design was found"),
        ({"seed": "x"}, "does not say how the design was found"),
    ):
        folder = copy()
        content = result_files.read(folder, "design.json") | change
        (folder / "design.json").write_text(json.dumps(content), encoding="utf-8")
        refused(srgc("landscape", folder), reason)
    (folder / "design.json").write_text("{", encoding="utf-8")
    refused(srgc("landscape", folder), "is not JSON")
    (folder / "design.json").unlink()
    ran = srgc("landscape", folder)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.startswith(f"error: {folder} has lost its design.json")


def test_a_picture_is_svg(srgc: Srgc, designs: Path, tmp_path: Path) -> None:
    refused(srgc("landscape", designs, "-o", tmp_path / "l.png"), "let the name end in .svg")
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    refused(srgc("landscape", designs, "--points", 2, "-o", blocked / "l.svg"), "file")
