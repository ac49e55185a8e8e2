"""Searches of motions that go on for ever: shapes of loops, and what is not found."""

from __future__ import annotations

from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.result_files import read
from tests.oracles.small_specs import MOTOR, SLIDER, TURNER, WINDING, replaced

pytestmark = pytest.mark.usefixtures("without_pictures")


def asked(spec: str, clauses: str, steps: int = 16) -> str:
    """The spec with these clauses instead of ``reach T``, for ever, and time for a tour."""
    longer = replaced(spec, "horizon 10 steps", f"horizon {steps} steps")
    return replaced(longer, "  reach T;\n", f"  {clauses}\n  repeat;\n")


def found(text: str, folder: Path) -> int:
    path, out = folder / "spec.srg", folder / "out"
    path.write_text(text, encoding="utf-8")
    status = run(["synth", str(path), "-q", "-o", str(out)])
    if status:
        return -status
    report = verify_directory(out)
    assert report.outcome is Outcome.VALID, report.reason
    (loop,) = [item for item in read(out)["claims"] if item["kind"] == "loop"]
    first = loop["first"]
    assert isinstance(first, int)
    return first


AGAIN = "satisfy always (eventually T by effector 1 and eventually S by effector 1);"
BEYOND_START = (
    "satisfy always eventually T; satisfy always eventually U; satisfy eventually always not S;"
)
"""A tour between two regions, without the start."""
STAY = "satisfy eventually always T by effector 1;"
DISTURBED = "robust start 0.1 deg, 0.1 deg/s; robust effort 0.5 % of bound; robust mass 1 %;"


@pytest.mark.parametrize(
    ("text", "first"),
    [
        (asked(SLIDER, AGAIN), 0),
        (asked(SLIDER, "satisfy eventually always T;"), 8),
        (asked(SLIDER, "reach T;"), 0),
        (asked(SLIDER, "satisfy always eventually[0 s, 3.2 s] T;"), 0),
        pytest.param(asked(TURNER, f"{AGAIN} {DISTURBED}", 30), 0, marks=pytest.mark.slow),
        pytest.param(asked(TURNER, f"{STAY} {DISTURBED}", 30), 15, marks=pytest.mark.slow),
        pytest.param(
            asked(TURNER, f"{AGAIN} {DISTURBED} gravity (0, -2) m/s^2;", 30),
            0,
            marks=pytest.mark.slow,
        ),
        (asked(MOTOR, AGAIN), 0),
    ],
    ids=["tour", "stay", "reach", "window", "turner", "turner stays", "gravity", "motor"],
)
def test_loops_are_found_and_proved(text: str, first: int, tmp_path: Path) -> None:
    assert found(text, tmp_path) == first


def with_a_second_region(spec: str, region: str) -> str:
    return replaced(spec, "  target T ", f"  region U {region} m;\n  target T ")


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        (asked(with_a_second_region(SLIDER, "box [1.2, 1.5] x [-0.2, 0.2]"), BEYOND_START), 16),
        pytest.param(
            asked(
                with_a_second_region(TURNER, "box [0.85, 1.2] x [0.85, 1.2]"),
                f"{BEYOND_START.replace(';', ' by effector 1;')} {DISTURBED}",
                30,
            ),
            30,
            marks=pytest.mark.slow,
        ),
    ],
    ids=["slider", "turner"],
)
def test_a_tour_that_the_start_is_not_on(text: str, steps: int, tmp_path: Path) -> None:
    """A prefix leads into it, of a quarter or a half of the horizon."""
    first = found(text, tmp_path)
    assert first in {steps // 4, steps // 2}
    rounds = read(tmp_path / "out")["path"][0][first:]
    assert rounds[0] == rounds[-1]
    assert {"T", "U"} <= {name.split(".")[0] for name in rounds}
    assert not any(name.startswith("S") for name in rounds)


LEFT_FOR_GOOD = "satisfy eventually always not Tray by effector 1;"
HANDS = (Path(__file__).parents[2] / "specs/two_arm.srg").read_text(encoding="utf-8")


def test_each_of_two_effectors_has_its_own_work_for_ever(tmp_path: Path) -> None:
    """The first load stays about the start, the one that slides on it goes to and fro."""
    two = replaced(SLIDER, "eps P eps M eps EN;", "eps P eps M eps EN eps P eps M eps EN;")
    clauses = (
        "satisfy always (eventually S by effector 1 and eventually T by effector 2);"
        "satisfy always eventually S by effector 2;"
    )
    assert found(asked(two, clauses, 12), tmp_path) == 0
    one, other = read(tmp_path / "out")["path"]
    assert (one[0], other[0]) == (one[-1], other[-1])
    assert "T" in {name.split(".")[0] for name in other}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("clauses", "first"),
    [
        ("satisfy always (eventually Tray by effector 1 and eventually Bin by effector 2);", 0),
        pytest.param(
            "satisfy always (eventually Side by effector 1 and eventually Bin by effector 2); "
            + LEFT_FOR_GOOD,
            7,
        ),
    ],
    ids=["tour", "prefix"],
)
def test_both_hands_work_for_ever(clauses: str, first: int, tmp_path: Path) -> None:
    """One goes to and fro between two bins; the other one is at its tray, or leaves it for good."""
    text = replaced(
        HANDS,
        "  obstacle Post",
        "  region Bin box [-1.1, -0.7] x [-0.25, 0.15] m;\n"
        "  region High box [-0.9, -0.5] x [0.3, 0.6] m;\n"
        "  region Side box [0.45, 0.65] x [0.3, 0.6] m;\n"
        "  obstacle Post",
    )
    again = "satisfy always eventually High by effector 2;"
    text = replaced(text, "  reach Press by effector 2;", f"  {clauses} {again} repeat;")
    text = replaced(text, "horizon 8 steps of 0.25 s", "horizon 30 steps of 0.2 s")
    assert found(text, tmp_path) == first
    one, other = (names[first:] for names in read(tmp_path / "out")["path"])
    assert (one[0], other[0]) == (one[-1], other[-1])
    assert {"Bin", "High"} <= {name.split(".")[0] for name in other}


@pytest.mark.slow
def test_nothing_brings_a_mass_back_without_feedback(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert found(asked(SLIDER, "reach T; control open loop;", 12), tmp_path) == -4
    assert "no set of states was found" in capsys.readouterr().out


def test_what_is_out_of_reach_at_all_times_is_refuted(tmp_path: Path) -> None:
    far = replaced(asked(SLIDER, "reach T;"), "box [2, 2.5]", "box [3.2, 3.5]")
    assert found(far, tmp_path) == -3
    assert verify_directory(tmp_path / "out").outcome is Outcome.VALID


@pytest.mark.slow
def test_weak_drives_refute_nothing(tmp_path: Path) -> None:
    """Within the horizon the mass does not get there; swung to and fro for ever, it might."""
    weak = replaced(asked(SLIDER, "reach T;"), "effort <= 10 N", "effort <= 0.01 N")
    assert found(weak, tmp_path) == -4
    once = replaced(weak, "  repeat;\n", "")
    again = tmp_path / "once"
    again.mkdir()
    assert found(once, again) == -3


def test_a_plan_is_one_round(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A tour ends where it begins; who stays has arrived by half of the horizon."""
    path = tmp_path / "spec.srg"
    for clauses, cells, latest in (
        (AGAIN, ["S", "T", "S"], 16),
        ("satisfy eventually always T;", ["S", "T"], 8),
    ):
        path.write_text(asked(SLIDER, clauses), encoding="utf-8")
        assert run(["plan", str(path)]) == 0
        lines = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
        assert [name for name, _ in lines if not name.startswith("free")] == cells
        assert int(lines[-1][1].split()[2]) <= latest
    path.write_text(asked(SLIDER, AGAIN, 2), encoding="utf-8")
    assert run(["plan", str(path)]) == 4
    assert "no path" in capsys.readouterr().out
    assert run(["plan", str(path), "--dump", "smt2"]) == 2


def test_a_robot_that_cannot_move_stays_for_ever(tmp_path: Path) -> None:
    fixed = replaced(asked(SLIDER, "satisfy always S;"), "B eps P eps M eps EN;", "B eps M eps EN;")
    assert found(replaced(fixed, "box [0.1, 0.5]", "box [-0.1, 0.5]"), tmp_path) == 0
    (loop,) = read(tmp_path / "out")["claims"]
    assert (loop["centre"], loop["generators"]) == ([], [])


@pytest.mark.slow
@pytest.mark.parametrize("text", [asked(SLIDER, AGAIN), WINDING], ids=["slider", "winding"])
def test_another_convex_solver_closes_loops_too(text: str, tmp_path: Path) -> None:
    path = tmp_path / "spec.srg"
    path.write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    assert run(["synth", str(path), "-q", "-o", str(out), "--solver", "CLARABEL"]) == 0
    assert verify_directory(out).outcome is Outcome.VALID
