"""Claims about tasks with formulas, for a rod that turns as school physics says.

A rod of length l and density 1 has the moment l^3 / 3 about its joint; a torque held for a second,
then its opposite, turn it by (1 s)^2 u / (l^3 / 3) and leave it at rest.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.partition import Cut
from grammar_lang import ir
from grammar_lang.load import load
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, Report, verify_directory
from tests.oracles import result_files
from tests.oracles.formulas import FAMILY, ONE_ARM
from tests.oracles.found_folders import claim_found

LENGTH, TORQUE = 1.3, 0.5
PUSH = TORQUE / (LENGTH**3 / 3)
"""rad/s^2"""
ARM = "B eps J eps L eps E"
SPEC = """
workspace W {
  plane xy; bounds box [-3, 3] x [-3, 3] m;
  region S box [1.2, 1.4] x [-0.1, 0.1] m;
  region A polytope { 3*x + 4*y <= 6.8; 3*x + 4*y >= 5.8; 4*x - 3*y <= 2.1; 4*x - 3*y >= 1; } m;
  region Half polytope { 3*x - 4*y <= 2; } m;
}
task P {
  robot Arm; workspace W; start in S BY; effort <= 2 N*m; horizon 8 steps of 0.25 s;
  CLAUSES
}
"""


def tip(time: float) -> tuple[float, float]:
    """Where the tip is: on a circle, speeding up for a second and slowing down for one."""
    rest = 2 - time
    angle = PUSH * time**2 / 2 if time <= 1 else PUSH * (1 - rest**2 / 2)
    return LENGTH * math.cos(angle), LENGTH * math.sin(angle)


def entry(inside: Callable[[float, float], bool]) -> float:
    """The time from which on the tip is in a set that it enters once, by bisection."""
    low, high = 0.0, 2.0
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (low, middle) if inside(*tip(middle)) else (middle, high)
    return high


def cells_of(folder: Path) -> Abstraction:
    program = load(folder / "spec" / "robot.srg").program
    assert program is not None
    return abstract(program.workspaces["W"])


def claim(
    folder: Path,
    clauses: str,
    *,
    by: str = "",
    cuts: tuple[Cut, ...] = (),
    spec: str = SPEC,
    word: str = ARM,
    **fields: Any,
) -> Path:
    """A folder with the motion of this file's head as its claim."""
    arms = ONE_ARM + (" (eps E)?" if word != ARM or "by effector" in clauses + by else "")
    text = FAMILY.replace(ONE_ARM, arms) + spec.replace("CLAUSES", clauses).replace("BY", by)
    made = claim_found(folder, text, word, ["1.3"])
    cells = cells_of(made).cut(cuts)
    places = [cells.locate(tip(k / 4)) for k in range(9)]
    content = result_files.read(made)
    content |= {
        "inputs": [["0.5"]] * 4 + [["-0.5"]] * 4,
        "path": [[cells.cells[place].name for place in places if place is not None]],
        "effort_peak": "0.5",
        "robustness": "1.5",
        "cuts": [[c.cell, [str(a) for a in c.half_space.normal], str(c.half_space.offset)]
                 for c in cuts],
        **fields,
    }  # fmt: skip
    content["digest"] = result_files.digest(content)
    result_files.write(made, content)
    return made


def judged(folder: Path, clauses: str, **options: Any) -> Report:
    return verify_directory(claim(folder, clauses, **options))


HALF = entry(lambda x, y: 3 * x - 4 * y <= 2)


def test_a_formula_holds_with_its_robustness(tmp_path: Path) -> None:
    """The tip ends at rest in A; how deep is that of the last instant, by the rows of A."""
    report = judged(tmp_path / "out", "satisfy eventually last[0 s] A;")
    assert (report.outcome, report.reason) == (Outcome.VALID, None)
    (found,) = [finding for finding in report.conditions if finding.clause == 0]
    assert found.name == "satisfy 1: eventually last[0 s] A"
    x, y = tip(2)
    sums = 3 * x + 4 * y, 4 * x - 3 * y
    depth = min(6.8 - sums[0], sums[0] - 5.8, 2.1 - sums[1], sums[1] - 1) / 5
    assert 0.97 * depth < found.margin <= depth
    assert report.level == "validated"


MOVED = {
    "eventually": ("eventually[0 s, {}] Half", 1),
    "always not": ("always[0 s, {}] not Half", -1),
    "always": ("always[{}, 2 s] Half", 1),
    "until": ("(not Half until Half) and eventually[0 s, {}] Half", 1),
    "nested": ("eventually[0.5 s, 0.5 s] eventually[0 s, {} - 0.5 s] Half", 1),
    "last": ("last[2 s - {}] Half", 1),
}


@pytest.mark.parametrize("name", MOVED)
def test_a_millisecond_beside_the_entry_decides(tmp_path: Path, name: str) -> None:
    text, sign = MOVED[name]
    for by in (1, -1):
        time = Fraction(round(HALF * 10**6), 10**6) + Fraction(by, 1000)
        report = judged(tmp_path / str(by), f"satisfy {text.format(f'{float(time):.6f} s')};")
        assert report.outcome is (Outcome.VALID if by == sign else Outcome.REFUTED)
        if by != sign:
            assert report.reason is not None
            assert report.reason.startswith("satisfy 1: ")
            assert ": violated at " in report.reason


def test_at_the_entry_itself_nothing_is_claimed(tmp_path: Path) -> None:
    """Twelve digits of the time of entry are more than the halving of slices resolves."""
    report = judged(tmp_path / "out", f"satisfy eventually[0 s, {HALF:.12f} s] Half;")
    assert report.outcome is Outcome.UNDECIDED
    assert report.reason is not None
    assert report.reason.endswith(": not decided")


def test_a_tip_that_rests_on_a_boundary(tmp_path: Path) -> None:
    """Nothing is claimed, and soon; a formula that does not ask which side it is on is proved."""
    texts = {
        "always Half": Status.UNDECIDED,
        "always (Half or not Half)": Status.HOLDS,
        "always (A or not Half or eventually[0 s, 1 s] Half)": Status.UNDECIDED,
        "not always (Half or S)": Status.FAILS,
    }
    clauses = " ".join(f"satisfy {text};" for text in texts)
    rest = {"inputs": [["0"]] * 8, "path": [["S.1"] * 9], "effort_peak": "0", "robustness": "2"}
    edge = SPEC.replace("3*x - 4*y <= 2", "x <= 1.3")
    report = judged(tmp_path / "out", clauses, spec=edge, **rest)
    found = {f.clause: f.status for f in report.conditions if f.clause is not None}
    assert list(found.values()) == list(texts.values())


def test_every_clause_is_judged(tmp_path: Path) -> None:
    clauses = "satisfy eventually A; satisfy always not A; avoid S with effector;"
    report = judged(tmp_path / "one", clauses.replace("avoid S with effector;", ""))
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert report.reason.startswith("satisfy 2: always not A: violated at ")
    with_reach = judged(tmp_path / "two", "satisfy eventually Half; reach S;")
    assert with_reach.outcome is Outcome.REFUTED
    assert with_reach.reason == "the path does not end in the target"
    assert judged(tmp_path / "three", "satisfy eventually Half; reach A;").outcome is Outcome.VALID


def test_robots_without_a_named_effector_are_refused(tmp_path: Path) -> None:
    clauses = "satisfy eventually Half by effector 1 or A by effector 2;"
    report = judged(tmp_path / "out", clauses, by="by effector 1")
    assert report.outcome is Outcome.REFUTED
    assert report.reason == "the robot has no effector 2, which the task names"


def test_the_proof_itself_refuses_them_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Points of bodies follow the effectors in the robot's graph: one of them must not stand in."""
    monkeypatch.setattr("solvers.verifier.found_check.missing_effector", lambda *_: None)
    clauses = "satisfy eventually Half by effector 1 or A by effector 2;"
    report = judged(tmp_path / "out", clauses, by="by effector 1")
    assert report.outcome is Outcome.REFUTED
    assert report.reason == "effector 2 of the task: violated"


@pytest.mark.parametrize(
    ("by", "effector", "reason"),
    [
        ("by effector 1", 0, None),
        ("by effector 1", 1, "the task names effector 1, the claim 2"),
        ("by effector 2", 0, "the task names effector 2, the claim 1"),
        ("by effector 2", 1, None),
        ("by effector 3", 0, "the task names effector 3, the claim 1"),
        ("", 1, None),
        ("", 2, "the robot has no effector 3"),
    ],
)
def test_the_recorded_effector_is_the_one_that_starts(
    tmp_path: Path, by: str, effector: int, reason: str | None
) -> None:
    """Two effectors at one tip: what one does, the other does."""
    clauses = "satisfy eventually Half by effector 1 and last[0 s] A by effector 2;"
    folder = tmp_path / "out"
    arm = claim(tmp_path / "one", "satisfy eventually Half by effector 1;")
    (names,) = result_files.read(arm)["path"]
    report = judged(
        folder, clauses, by=by, word=ARM + " eps E", effector=effector, path=[names, names]
    )
    assert report.reason == reason
    assert report.outcome is (Outcome.VALID if reason is None else Outcome.REFUTED)


DESIGN: dict[str, tuple[Any, str | None]] = {
    "as proved": (lambda r: r, None),
    "hardly less": (lambda r: r - 1e-12, None),
    "less": (lambda r: r - 1e-6, "the robustness of `satisfy` 1"),
    "more": (lambda r: r + 1e-6, "the robustness of `satisfy` 1"),
    "text": (str, "the robustness of `satisfy` 1"),
    "unlimited": (lambda _: None, "the robustness of `satisfy` 1"),
}


@pytest.mark.parametrize("name", DESIGN)
def test_what_the_design_says_of_formulas(tmp_path: Path, name: str) -> None:
    change, reason = DESIGN[name]
    folder = claim(tmp_path / "out", "satisfy eventually A;")
    proved = next(f.margin for f in verify_directory(folder).conditions if f.clause == 0)
    satisfied = [{"formula": "eventually A", "robustness": change(proved)}]
    assert_said(folder, satisfied, reason)


@pytest.mark.parametrize(
    ("satisfied", "reason"),
    [
        ([], "other formulas than the task"),
        ("eventually A", "other formulas than the task"),
        ([{"formula": "eventually Half", "robustness": 0.1}], "another formula than the task's"),
        ([["eventually A", 0.1]], "another formula than the task's"),
    ],
)
def test_a_design_with_other_formulas(tmp_path: Path, satisfied: Any, reason: str) -> None:
    assert_said(claim(tmp_path / "out", "satisfy eventually A;"), satisfied, reason)


def assert_said(folder: Path, satisfied: Any, reason: str | None) -> None:
    """``design.json`` says what the claim does, and this of the formulas."""
    content = result_files.read(folder)
    cells = cells_of(folder)
    design = {
        "verdict": "found", "dofs": [{"symbols": [2], "kind": "revolute", "axis": "z"}],
        "parameters": [{"symbol": 4, "module": "L", "name": "length", "value": 1.3, "unit": "m"}],
        "robustness": 1.5, "effort_peak": 0.5, "step": 0.25, "horizon": 8,
        "cells": cells.describe(), "satisfy": satisfied,
    }  # fmt: skip
    same = ("task", "spec", "spec_sha256", "word", "derivation", "path")
    design |= {name: content[name] for name in same}
    (folder / "design.json").write_text(json.dumps(design), encoding="utf-8")
    report = verify_directory(folder)
    if reason is None:
        assert (report.outcome, report.reason) == (Outcome.VALID, None)
    else:
        assert report.outcome is Outcome.REFUTED
        assert report.reason is not None
        assert reason in report.reason


def cut(cell: int, *normal: int, offset: str) -> Cut:
    return Cut(cell, ir.HalfSpace(tuple(Fraction(a) for a in normal), Fraction(offset)))


def test_cuts_are_made_again(tmp_path: Path) -> None:
    """The start region halved by a tilted line, and its half again."""
    names = [
        cell.name for cell in cells_of(claim(tmp_path / "none", "satisfy eventually A;")).cells
    ]
    start = names.index("S")
    cuts = (cut(start, 1, 2, offset="1.31"), cut(start, 0, 1, offset="-0.05"))
    report = judged(tmp_path / "cut", "satisfy eventually A;", cuts=cuts)
    assert (report.outcome, report.reason) == (Outcome.VALID, None)
    result_files.alter(tmp_path / "cut", lambda content: content.update(cuts=[]), sign=True)
    assert verify_directory(tmp_path / "cut").outcome is Outcome.REFUTED


@pytest.mark.parametrize(
    ("made", "reason"),
    [
        ([[99, ["1", "0"], "1"]], "there is no cell number 99"),
        ([[-1, ["1", "0"], "1"]], "there is no cell number -1"),
        ([[0, ["1", "0"], "100"]], "the cells cannot be cut as claimed"),
        ([[0, ["0", "0"], "1"]], "the cells cannot be cut as claimed"),
        ([[0, ["1", "0", "0"], "1"]], "not given by 2 coordinates"),
        ([[0, ["1", "x"], "1"]], "malformed"),
        ([[0, ["1", "0"], "1", "2"]], "malformed"),
        ([["0", ["1", "0"], "1"]], "malformed"),
    ],
)
def test_cuts_that_cannot_be_made(tmp_path: Path, made: Any, reason: str) -> None:
    folder = claim(tmp_path / "out", "satisfy eventually A;")
    content = result_files.read(folder) | {"cuts": made}
    content["digest"] = result_files.digest(content)
    result_files.write(folder, content)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert reason in report.reason
