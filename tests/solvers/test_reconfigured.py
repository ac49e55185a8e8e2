"""Tasks with an existing robot, from the search to the verifier."""

from __future__ import annotations

import csv
import math

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter, alter_spec, read, without_boxes, write

TURNER = ["B", "eps", "JO", "eps", "L", "eps", "EN"]
LENGTH = 1.5


def refused(folder):
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    return report.reason


def test_nothing_has_to_change(made, result):
    design = read(result("good_as_it_is"), "design.json")
    assert design["word"] == TURNER
    assert len(design["structures_tried"]) == 1
    assert [p["value"] for p in design["parameters"]] == [LENGTH]
    assert design["reconfiguration"] == {
        "from": TURNER,
        "added": 0,
        "removed": 0,
        "kept": [[0, 0], [2, 2], [4, 4], [6, 6]],
        "configurations": [TURNER],
    }
    printed = (made("good_as_it_is") / "stdout").read_text()
    assert "change:  none, this is the existing robot\n" in printed


def test_the_arm_moves_with_the_length_that_it_has(result):
    """The hand is where the kept length puts it, by the cosine and the sine."""
    with (result("good_as_it_is") / "trajectory.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 11
    for row in rows:
        angle, x, y = (float(row[name]) for name in ("q1", "e1_x", "e1_y"))
        assert (x, y) == pytest.approx((LENGTH * math.cos(angle), LENGTH * math.sin(angle)))


def test_valid(result):
    for name in ("good_as_it_is", "without_link"):
        assert verify_directory(result(name)).outcome is Outcome.VALID


@pytest.mark.parametrize("value", ["1.500000000000001", "1.6", "2"])
def test_another_value_than_the_fixed_one_is_refuted(result, value):
    folder = result("good_as_it_is")
    alter(folder, lambda c: c["parameters"][0].update(value=value), sign=True)
    assert refused(folder) == f"`L.length` = {value} at symbol 4 is outside its range"


def test_without_fixed_the_same_claim_is_valid(result):
    """So that it is `fixed` that binds; the task is the same but for that."""
    folder = result("good_as_it_is")
    alter_spec(folder, " fixed L.length = 150 cm", "", sign=True)
    design = read(folder, "design.json")
    design["spec_sha256"] = read(folder)["spec_sha256"]
    write(folder, design, "design.json")
    assert verify_directory(folder).outcome is Outcome.VALID
    alter_spec(folder, "from B eps JO", "from B eps JO eps JO", sign=True)
    assert refused(folder) == "design.json and certificate.json differ in `spec_sha256`"
    design["spec_sha256"] = read(folder)["spec_sha256"]
    write(folder, design, "design.json")
    assert refused(folder) == "design.json and certificate.json differ in `reconfiguration`"


def test_a_module_is_added(made, result):
    folder = result("without_link")
    design = read(folder, "design.json")
    old = ["B", "eps", "JO", "eps", "EN"]
    assert design["reconfiguration"] == {
        "from": old,
        "added": 1,
        "removed": 0,
        "kept": [[0, 0], [2, 2], [4, 6]],
        "configurations": [old, TURNER],
    }
    # W, then what is one module away from it, in the order of section 2.
    tried = [" ".join(s["word"]) for s in design["structures_tried"]]
    assert tried == ["B eps JO eps EN", "B eps JO eps L eps EN"]
    # The first is refuted for want of links, and with it what has another joint.
    assert [lemma["condition"] for lemma in design["lemmas"]] == ["count(L) <= 0"]
    printed = (made("without_link") / "stdout").read_text()
    assert (
        "change:  1 module added, 0 removed\n"
        "         0: B eps JO eps EN\n"
        "         1: B eps JO eps L eps EN\n"
    ) in printed


def false_step(change):
    change["configurations"].insert(1, ["B", "eps", "JO"])


@pytest.mark.parametrize(
    "alteration",
    [
        lambda change: change.update(added=2),
        lambda change: change["kept"].pop(),
        false_step,
        lambda change: change.clear(),
    ],
)
def test_a_false_report_of_the_way(result, alteration):
    folder = result("without_link")
    design = read(folder, "design.json")
    alteration(design["reconfiguration"])
    write(folder, design, "design.json")
    assert refused(folder) == "design.json and certificate.json differ in `reconfiguration`"


# --- impossible ----------------------------------------------------------------------------------


def test_a_kept_length_makes_it_impossible(result):
    """With a link of 1 m the hand is 1 m from the joint; start and target are 1.2 m away."""
    folder = result("too_short")
    design = read(folder, "design.json")
    assert (design["verdict"], design["reconfiguration"]) == ("impossible", None)
    words = [" ".join(s["word"]) for s in design["structures_tried"]]
    assert words == [
        "B eps JO eps L eps EN",
        "B eps JO eps EN",
        "B eps JO eps JO eps EN",
        "B eps JO eps EN eps JO",
        "B eps JO eps EN eps L",
        "B eps JO eps EN eps EN",
    ]
    assert verify_directory(folder).level == "validated"
    without_boxes(folder)
    (folder / "design.json").unlink()
    assert verify_directory(folder).outcome is Outcome.UNCHECKED
    assert verify_directory(folder, trust="z3").outcome is Outcome.VALID


def test_another_order_is_refuted(result):
    folder = result("too_short")

    def exchange(content):
        first, second, *rest = content["structures"]
        content["structures"] = [second, first, *rest]

    alter(folder, exchange, sign=True)
    assert refused(folder) == "structure 0 is not B eps JO eps L eps EN"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" fixed L.length = 1 m", ""),
        ("L.length = 1 m", "L.length = 1.25 m"),
        ("L.length = 1 m", "L.length = 1.0000001 m"),
    ],
)
def test_the_scripts_are_about_the_fixed_length(result, old, new):
    folder = result("too_short")
    without_boxes(folder)
    alter_spec(folder, old, new, sign=True)
    assert refused(folder) == "proofs/0000.smt2 is not the script of structure 0"


def test_the_boxes_are_about_the_fixed_length(result):
    """With 1.25 m the hand comes to start and target; with 1.0000001 m it does not either."""
    folder = result("too_short")
    alter_spec(folder, "L.length = 1 m", "L.length = 1.25 m", sign=True)
    assert refused(folder).startswith("proofs/0000.boxes does not refute structure 0")


# --- the shipped spec ----------------------------------------------------------------------------


@pytest.mark.slow
def test_yesterdays_arm(result):
    folder = result("reconfigure")
    assert verify_directory(folder).outcome is Outcome.VALID
    design = read(folder, "design.json")
    change = design["reconfiguration"]
    assert (change["added"], change["removed"]) == (2, 0)
    two = "B eps JO eps L eps JO eps L"
    assert [" ".join(word) for word in change["configurations"]] == [
        f"{two} eps EN",
        f"{two} eps JO eps EN",
        f"{two} eps JO eps L eps EN",
    ]
    lengths = [p["value"] for p in design["parameters"]]
    assert lengths[:2] == [1.6, 1.2]
    assert 0.5 <= lengths[2] <= 2
    assert design["structures_tried"][0]["word"] == change["from"]
    assert design["structures_tried"][0]["verdict"] == "refuted"
