"""``start at`` from the spec to the verified result, where joints merge or move nothing."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from math import cos, sin
from pathlib import Path

import pytest

from tests.oracles import result_files
from tests.oracles.found_folders import claim_found
from tests.oracles.joint_chains import TOP, chain_spec
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

pytestmark = pytest.mark.usefixtures("without_pictures")


Run = Callable[..., Ran]

J = "revolute z in [-100, 100] deg"
K = "revolute -z in [-100, 100] deg"
X = "revolute x in [-1, 1]"
S = "prismatic x in [0, 2] m"
R = "prismatic -x in [0, 2] m"
ALONG = "[2, 2.4] x [-0.1, 0.1]"
HERE = "[0.9, 1.1] x [-0.1, 0.1]"


def made(srgc: Run, folder: Path, text: str) -> tuple[Ran, Ran, Path]:
    """Synthesis and verification of a spec, the refutations with the solver asked again."""
    path = folder / "spec.srg"
    path.write_text(text, encoding="utf-8")
    synthesis = srgc("synth", path, "-o", folder / "out")
    return synthesis, srgc("verify", folder / "out", "--trust", "z3"), folder / "out"


def first_row(folder: Path) -> dict[str, float]:
    with (folder / "trajectory.csv").open(encoding="utf-8") as file:
        row = next(csv.DictReader(file))
    return {name: float(value) for name, value in row.items() if value}


FOUND = {
    # Where the coordinate starts, and where the effector does.
    "two about one axis": ({"J": J}, "J eps J eps L eps E", "0.4 rad, 0.3", TOP, 0.7, None),
    "against each other": ({"J": J, "K": K}, "J eps K eps L eps E", "1.2, 0.5", TOP, 0.7, None),
    "an idle one behind": ({"J": J}, "J eps L eps E eps J", "0.7, 1.1", TOP, 0.7, None),
    "slides": ({"S": S, "R": R}, "S eps R eps L eps E", "0.5 m, 20 cm", ALONG, 0.3, (1.3, 0)),
    "an idle one before": (
        {"X": X, "S": S}, "X eps S eps L eps E", "1 rad, 0.5 m", f"{ALONG} x [-1, 1]", 0.5,
        (1.5, 0),
    ),
    "three about one axis": (
        {"J": J, "K": K}, "J eps K eps J eps L eps E", "1.2, 0.5, 0.2", TOP, 0.9, None,
    ),
    "the end of a range": ({"J": J}, "J eps J eps L eps E", "100 deg, -1", TOP, 0.7453292519943,
                           None),
}  # fmt: skip


@pytest.mark.parametrize("name", some(FOUND, 5))
def test_a_motion_starts_at_the_sum_of_the_values(name: str, srgc: Run, tmp_path: Path) -> None:
    joints, word, start, target, coordinate, tip = FOUND[name]
    text = chain_spec(joints, f"B eps {word}", start, target)
    synthesis, verified, out = made(srgc, tmp_path, text)
    assert synthesis.out.startswith("verdict: found\n")
    assert (verified.status, verified.out.splitlines()[0]) == (0, "valid: found, level validated")
    row = first_row(out)
    assert row["q1"] == pytest.approx(coordinate, abs=2e-9)
    assert "q2" not in row
    expected = (cos(coordinate), sin(coordinate)) if tip is None else tip
    assert (row["e1_x"], row["e1_y"]) == pytest.approx(expected, abs=1e-8)


def test_a_robot_whose_only_joint_is_idle_stands(srgc: Run, tmp_path: Path) -> None:
    text = chain_spec({"J": J}, "B eps L eps E eps J", "0.7", HERE)
    synthesis, verified, _ = made(srgc, tmp_path, text)
    assert (synthesis.status, verified.status) == (0, 0)


REFUTED = {
    "out of its own range": (
        {"J": J}, "J eps J eps L eps E", "120 deg, -60 deg",
        "value 1 of the start is out of the range of its joint",
    ),
    "an idle joint out of its range": (
        {"J": J}, "J eps L eps E eps J", "0.7, -101 deg",
        "value 2 of the start is out of the range of its joint",
    ),
    "too few values": ({"J": J}, "J eps J eps L eps E", "0.7", None),
    "too many values": ({"J": J}, "J eps L eps E eps J", "0.7, 0, 0", None),
    "a coordinate out of its range": (
        {"J": J}, "J eps L eps E eps J", "101 deg, 0",
        "the given start is out of the range of a joint",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", some(REFUTED, 3))
def test_a_start_that_the_robot_cannot_have_is_refuted(
    name: str, srgc: Run, tmp_path: Path
) -> None:
    """The sum is fine in every case, and the target near."""
    joints, word, start, reason = REFUTED[name]
    synthesis, verified, out = made(srgc, tmp_path, chain_spec(joints, f"B eps {word}", start))
    assert synthesis.status == 3
    assert verified.status == 0
    (tried,) = json.loads((out / "design.json").read_text(encoding="utf-8"))["structures_tried"]
    if reason is not None:
        assert tried["reason"] == reason
    assert srgc("verify", out).status == 0  # a covering shows it, and no solver is believed


def test_of_two_robots_of_one_form_one_starts_in_an_obstacle(srgc: Run, tmp_path: Path) -> None:
    """At 0.8 rad the tip of J J is in the obstacle, at 0.5 rad that of J with an idle J is not."""
    text = chain_spec(
        {"J": J}, "B eps J (eps J)? eps L eps E (eps J)?", "0.5, 0.3", more="avoid O with effector;"
    ).replace("target T", "obstacle O box [0.68, 0.71] x [0.7, 0.73] m; target T")
    text = text.replace(TOP, "[0.85, 1] x [0.3, 0.6]")
    synthesis, verified, out = made(srgc, tmp_path, text)
    assert (synthesis.status, verified.status) == (0, 0)
    design = json.loads((out / "design.json").read_text(encoding="utf-8"))
    assert design["word"] == ["B", "eps", "J", "eps", "L", "eps", "E", "eps", "J"]
    assert first_row(out)["q1"] == pytest.approx(0.5, abs=2e-9)
    tried = {" ".join(s for s in t["word"] if s != "eps"): t for t in design["structures_tried"]}
    assert tried["B J J L E"]["verdict"] == "refuted"
    assert all(each["same_robot_as"] is None for each in tried.values())


def test_mixed_kinds_without_a_sum_are_refused_before_anything_is_searched(
    srgc: Run, tmp_path: Path
) -> None:
    """Two joints about one axis: a length and an angle have no sum."""
    text = chain_spec({"J": J, "S": S}, "B eps (J eps J | S) eps L eps E", "0.5 m, 30 deg")
    ran, _, _ = made(srgc, tmp_path, text)
    assert ran.status == 5
    assert "SRG0301" in ran.err
    assert "value 1 is a length" in ran.err


def test_of_words_with_as_many_joints_only_those_of_the_right_kinds(
    srgc: Run, tmp_path: Path
) -> None:
    text = chain_spec({"J": J, "S": S}, "B eps (J eps J | J eps S) eps L eps E", "0.7 rad, 1 cm")
    synthesis, verified, out = made(srgc, tmp_path, text.replace(TOP, "[-0.3, 0.3] x [0.9, 1.5]"))
    assert (synthesis.status, verified.status) == (0, 0)
    design = json.loads((out / "design.json").read_text(encoding="utf-8"))
    assert design["word"][2:5] == ["J", "eps", "S"]
    first = design["structures_tried"][0]
    assert first["reason"] == "value 2 of the start is a length, and its joint is revolute"


def test_why_names_the_range_of_the_joint(srgc: Run, tmp_path: Path) -> None:
    text = chain_spec({"J": J}, "B eps J eps J eps L eps E", "120 deg, -60 deg")
    synthesis, _, out = made(srgc, tmp_path, text)
    assert "the robot starts in this pose" in synthesis.out
    assert "the range of `J.q`" in synthesis.out
    assert srgc("why", out, "--no-runs").status == 0


# --- claims --------------------------------------------------------------------------------------

CLAIMS = {
    # All stand at 0 rad, where the sum has to be.
    "the sum": ({"J": J}, "J eps J", "0.4, -0.4", None),
    "the difference": ({"J": J, "K": K}, "J eps K", "0.4, 0.4", None),
    "the wrong sum": ({"J": J, "K": K}, "J eps K", "0.4, -0.4", "start pose"),
    "another sum": ({"J": J}, "J eps J", "0.4, -0.3", "start pose"),
    "a sum that is nearly right": ({"J": J}, "J eps J", "0.4, -0.39999999", "start pose"),
    "out of the ranges of the joints": ({"J": J}, "J eps J", "101 deg, -101 deg",
                                        "value 1 of the start is out of the range of its joint"),
    "by less than any float": ({"J": "revolute z in [-1, 1]"}, "J eps J",
                               "1.00000000000000000001, -1.00000000000000000001",
                               "value 1 of the start is out of the range of its joint"),
    "too few": ({"J": J}, "J eps J", "0",
                "the start gives 1 coordinate, and the word has 2 degrees of freedom"),
}  # fmt: skip


@pytest.mark.parametrize("name", CLAIMS)
def test_claims_about_the_start_of_merged_joints(name: str, srgc: Run, tmp_path: Path) -> None:
    joints, word, start, fault = CLAIMS[name]
    text = chain_spec(joints, f"B eps {word} eps L eps E", start, HERE)
    folder = claim_found(tmp_path / "out", text, f"B eps {word} eps L eps E", [])
    _on_target(folder)
    ran = srgc("verify", folder)
    assert ran.status == (0 if fault is None else 1)
    if fault is not None:
        assert fault in ran.out.splitlines()[0]


def test_a_claim_whose_joint_may_be_out_of_its_range_is_not_decided(
    srgc: Run, tmp_path: Path
) -> None:
    """Two ways to write one number, which no ball shows to be one."""
    end = "in [-4, sqrt(2) + sqrt(3)]"
    text = chain_spec(
        {"J": f"revolute z {end}", "K": f"revolute -z {end}"},
        "B eps J eps K eps L eps E", "sqrt(5 + 2 * sqrt(6)), sqrt(2) + sqrt(3)", HERE,
    )  # fmt: skip
    folder = claim_found(tmp_path / "out", text, "B eps J eps K eps L eps E", [])
    _on_target(folder)
    ran = srgc("verify", folder)
    assert ran.status == 4
    assert "value 1 of the start may be out of the range of its joint" in ran.out


def test_a_start_is_no_other_one_with_the_same_sum_of_two(srgc: Run, tmp_path: Path) -> None:
    """Two coordinates: each is given by itself, and their sum is not enough."""
    word = "B eps J eps J eps L eps J eps L eps E"
    text = chain_spec({"J": J}, word, "0.1, 0.2, -0.3", "[1.8, 2.1] x [-0.5, 0.5]")
    for name, coordinates in (("right", ["0.3", "-0.3"]), ("wrong", ["0.1", "-0.1"])):
        folder = claim_found(tmp_path / name, text, word, [])
        _on_target(folder, coordinates)
        ran = srgc("verify", folder)
        assert ran.status == (0 if name == "right" else 1)
        assert ("start pose" in ran.out.splitlines()[0]) is (name == "wrong")


def _on_target(folder: Path, coordinates: list[str] | None = None) -> None:
    """The effector is in the target all the time, without effort, the robot at coordinates."""

    def change(content: dict[str, object]) -> None:
        path = content["path"]
        assert isinstance(path, list)
        content["robustness"] = "10"
        content["path"] = [["T"] * len(cells) for cells in path]
        if coordinates is not None:
            content["start"] = [*coordinates, *["0"] * len(coordinates)]

    result_files.alter(folder, change, sign=True)
