"""Lower bounds on what parameters add up to, against geometry; false ones are refused."""

from __future__ import annotations

import copy
import shutil
from fractions import Fraction
from math import sqrt
from pathlib import Path
from typing import Any

import pytest

from solvers.verifier.report import Report
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.least_specs import least, link, spec
from tests.oracles.result_files import alter, read

pytestmark = pytest.mark.usefixtures("without_pictures")

ONE = "matches Base eps Joint eps A eps Hand"
TUBE = {"A": "param length in [0.2, 1] m;"}
ALONG = {"a": ("eps A", link("A.length", "A.length * 2 kg/m"))}
NEAREST = Fraction(45, 100)
"""From the base to the shelf, in metres: no straight arm is shorter, nor any other."""
CLOSE = Fraction(21, 20)


def claim_of(folder: Path) -> dict[str, Any]:
    (claim,) = (c for c in read(folder)["claims"] if c["kind"] == "objectives")
    return claim


def near(bound: Fraction, true: float | Fraction) -> bool:
    """Whether a lower bound is one, and close to what is true."""
    return bound <= true < bound * CLOSE


def test_one_tube(tmp_path: Path) -> None:
    text = spec(TUBE, ALONG, "modules <= 4; minimize sum(length);", accept=ONE)
    ((value, bound),), report = least(text, tmp_path)
    assert near(bound, NEAREST)
    assert value >= NEAREST
    assert report.conditions[-1].name.endswith(f"no robot has less than {float(bound):.6g} m")


def test_a_tilted_shelf(tmp_path: Path) -> None:
    """The nearest point of x + 2 y >= 1 is 1 / sqrt(5) away."""
    shelf = "polytope { x + 2*y >= 1; x + 2*y <= 1.3; 2*x - y >= -0.4; 2*x - y <= 0.4 } m"
    text = spec(TUBE, ALONG, "modules <= 4; minimize sum(length);", accept=ONE, shelf=shelf)
    ((value, bound),), _ = least(text, tmp_path)
    assert near(bound, 1 / sqrt(5))
    assert value**2 >= Fraction(1, 5)


def test_two_tubes_of_which_one_counts(tmp_path: Path) -> None:
    """The longest tube that costs nothing leaves 0.15 m, and half a metre costs 1."""
    modules = {
        "A": "param length in [0.1, 0.3] m; const cost = 0;",
        "B": "param cost in [0.1, 0.9];",
    }
    blocks = {"a": ALONG["a"], "b": ("eps B", link("B.cost * 0.5 m", "0.1 kg"))}
    text = spec(
        modules, blocks, "modules <= 6; minimize sum(cost);",
        accept="matches Base eps Joint eps A eps Joint eps B eps Hand",
    )  # fmt: skip
    ((value, bound),), _ = least(text, tmp_path, "--evaluations", "12", "--paths", "6")
    assert near(bound, Fraction(3, 10))
    assert value >= Fraction(3, 10)


def test_masses(tmp_path: Path) -> None:
    """Two kilograms a metre, and three for the joint."""
    text = spec(TUBE, ALONG, "modules <= 4; minimize mass;", accept=ONE)
    text = text.replace("Joint.q);", "Joint.q); point(frame: Arm.frame, mass: 3 kg);")
    ((value, bound),), _ = least(text, tmp_path)
    assert near(bound, 3 + 2 * NEAREST)
    assert bound > 3 + 2 * Fraction(2, 10)
    assert value >= 3 + 2 * NEAREST


@pytest.mark.parametrize(("objective", "due"), [("sum(length)", "1/2"), ("mass", "1")])
def test_values_one_by_one(objective: str, due: str, tmp_path: Path) -> None:
    """Of single values the least that reaches is proved to be the least."""
    tube = {"A": "param length in {0.9, 0.2, 0.3, 0.5, 0.7} m;"}
    text = spec(tube, ALONG, f"modules <= 4; minimize {objective};", accept=ONE)
    found = least(text, tmp_path, "--evaluations", "12", "--paths", "6")[0]
    assert found == [(Fraction(due), Fraction(due))]


def test_a_value_that_no_binary_number_is(tmp_path: Path) -> None:
    tube = {"A": "param length in {0.8, 0.3, 0.4, 0.6} m;"}
    shelf = "box [-0.05, 0.05] x [0.55, 0.65] m"
    text = spec(tube, ALONG, "modules <= 4; minimize sum(length);", accept=ONE, shelf=shelf)
    found = least(text, tmp_path, "--evaluations", "12", "--paths", "6")[0]
    assert found == [(Fraction(3, 5), Fraction(3, 5))]


def test_one_after_the_other(tmp_path: Path) -> None:
    """A third more length is allowed, and the mass then is that of the lighter of two tubes."""
    modules = {**TUBE, "B": "param length in [0.2, 1] m;"}
    blocks = {**ALONG, "b": ("eps B", link("B.length", "B.length * 1 kg/m"))}
    text = spec(
        modules, blocks, "modules <= 4; minimize sum(length) within 30 % then mass;",
        accept="matches Base eps Joint eps (A | B) eps Hand",
    )  # fmt: skip
    (length, mass), _ = least(text, tmp_path)
    assert near(length[1], NEAREST)
    assert near(mass[1], NEAREST)
    assert mass[0] < 2 * NEAREST


# --- false claims ---------------------------------------------------------------------------------


def judged(folder: Path, change: Any) -> Report:
    (folder / "design.json").unlink(missing_ok=True)
    alter(folder, lambda content: change(claim_in(content)), sign=True)
    return verify_directory(folder)


def claim_in(content: dict[str, Any]) -> dict[str, Any]:
    (claim,) = (c for c in content["claims"] if c["kind"] == "objectives")
    return claim


@pytest.fixture(scope="module")
def two_ends(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Equal robots, one of which counts for 0.1 m more."""
    folder = tmp_path_factory.mktemp("two_ends")
    modules = {**TUBE, "X": "const length = 0.1 m;", "Y": "const length = 0 m;"}
    still = "this.frame = Arm.frame;"
    text = spec(
        modules, {**ALONG, "long": ("eps X", still), "short": ("eps Y", still)},
        "modules <= 5; minimize sum(length);",
        accept="matches Base eps Joint eps A eps (X | Y) eps Hand",
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        from srgc.render import result_pictures

        for name in ("workspace_figure", "input_figure"):
            patch.setattr(result_pictures, name, lambda *_: "<svg/>")
        ((_, bound),), _ = least(text, folder)
    assert near(bound, NEAREST)
    return folder / "out"


def test_equal_robots_of_different_values(two_ends: Path, tmp_path: Path) -> None:
    """What shows that a robot has as much does not show it of an equal one that counts for less."""
    short, long = sorted(claim_of(two_ends)["structures"], key=lambda each: "X" in each["word"])
    folder = shutil.copytree(two_ends, tmp_path / "out")
    assert judged(folder, lambda c: c.update(structures=[long, short])).outcome is Outcome.VALID
    header, tree = (folder / long["boxes"]).read_text(encoding="ascii").split("\n", 1)
    assert tree.startswith("|")
    # From 0.4 m on it counts for 0.5 m, and the other one for 0.4 m.
    (folder / long["boxes"]).write_text(f"{header}\nAA{tree.strip()}$$\n", encoding="ascii")
    assert judged(folder, lambda c: c.update(structures=[long, short])).outcome is Outcome.VALID
    same = {**short, "same_robot_as": 0, "boxes": long["boxes"]}
    report = judged(folder, lambda c: c.update(structures=[long, same]))
    assert report.outcome is Outcome.REFUTED
    assert "too little of an objective" in (report.reason or "")


@pytest.mark.parametrize("more", ["1/100", "1/10", "1"])
def test_more_than_is_true(two_ends: Path, tmp_path: Path, more: str) -> None:
    folder = shutil.copytree(two_ends, tmp_path / "out")
    bound = NEAREST + Fraction(more)

    def raise_it(claim: dict[str, Any]) -> None:
        claim["values"][0]["least"] = str(bound)
        claim["values"][0]["value"] = str(max(bound, Fraction(claim["values"][0]["value"])))

    assert judged(folder, raise_it).outcome is Outcome.REFUTED


@pytest.mark.parametrize("letters", ["$", "A$$", "B$$", "$.", "AA|.$$", "A$|."])
def test_files_that_leave_out_too_much(two_ends: Path, tmp_path: Path, letters: str) -> None:
    """Lengths from 0.2 m on, or from 0.4 m on, count for less than what is claimed."""
    folder = shutil.copytree(two_ends, tmp_path / "out")
    for each in copy.deepcopy(claim_of(folder)["structures"]):
        (folder / each["boxes"]).write_text(f"boxes 1\n{letters}\n", encoding="ascii")
    assert verify_directory(folder).outcome is Outcome.REFUTED
