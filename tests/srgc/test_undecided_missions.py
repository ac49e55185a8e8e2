"""Unknown missions: which robots are undecided and why, in the folder, in `why` and on the page."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import srgc as public
from solvers.missions import compared_structures
from srgc.cli import run
from srgc.results.undecided_robots import stated_undecided
from tests.oracles import result_files
from tests.oracles.small_specs import TURNER, replaced
from tests.solvers.test_missions import FIXED, arms, fixed
from tests.srgc.report.conftest import page_of

SCENE, TASK = TURNER[: TURNER.index("task Turn")], TURNER[TURNER.index("task Turn") :]
SHORT = replaced(TASK, "effort <= 10 N*m", "modules <= 4; effort <= 10 N*m")
ARM = "B eps JO eps L eps EN"
ONLY = replaced(SCENE, "accept contains EN and starts with B eps JO;", f"accept matches {ARM};")
MASS = "rod(frame: N.frame, axis: x, length: L.length, density: L.density);"


def mission(scene: str, clauses: str, *tasks: str) -> str:
    """Tasks A and B, and a mission of both."""
    named = [
        replaced(task, "task Turn", f"task {name}") for task, name in zip(tasks, "AB", strict=True)
    ]
    return f"{scene}{''.join(named)}mission Both {{ tasks A, B; {clauses} }}\n"


def synthesised(path: Path, text: str, *options: str) -> Path:
    path.mkdir(exist_ok=True)
    (path / "both.srg").write_text(text, encoding="utf-8")
    asked = ["synth", str(path / "both.srg"), "--mission", "Both", "-q", "-o", str(path / "out")]
    assert run([*asked, *options]) == 4
    return path / "out"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The only arm has all its mass on its axis: no torque is inertia times an acceleration."""
    scene = replaced(ONLY, MASS, "point(frame: N.frame, mass: 1 kg);")
    text = mission(scene, "one robot;", SHORT, SHORT)
    return synthesised(tmp_path_factory.mktemp("undecided"), text)


def test_the_folder_says_which_robot_and_why(folder: Path) -> None:
    design = result_files.read(folder, "design.json")
    (entry,) = design["open"]
    assert (entry["task"], entry["robots"], entry["words"]) == ("A", 1, [ARM.split()])
    assert "mass matrix" in entry["reason"]
    assert (entry["try_first"], design["ended_by"], design["try_first"]) == (None, None, None)


def test_why_names_the_robot_and_no_time_limit(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["why", str(folder), "-q"]) == 0
    *_, undecided, end = capsys.readouterr().out.rstrip().split("\n\n")
    head, robot = undecided.splitlines()
    assert head == "undecided in A:"
    assert robot.startswith(f"  1 robot, {ARM}: ")
    assert end == "1 robot undecided"
    assert run(["why", str(folder), "-q", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [each["task"] for each in told["open"]] == ["A"]
    assert "time-limit" not in json.dumps(told)


def test_the_page_says_the_same(folder: Path) -> None:
    page = page_of(folder, "--no-verify")
    assert page.faults == []
    assert "Undecided in A" in page.section("refuted")
    assert f"1 robot, {ARM}: " in page.section("refuted")
    assert "more time" not in page.source


def test_python_has_it_by_task(folder: Path) -> None:
    found = public.open_result(folder)
    assert isinstance(found, public.api.mission_result.MissionResult)
    why = found.why()
    assert [*why.undecided] == ["A"]
    assert why.undecided["A"][0].startswith(f"1 robot, {ARM}: ")
    assert why.try_first is None


@pytest.mark.slow
@pytest.mark.parametrize("clauses", ["one robot;", "reconfigure;"])
def test_a_budget_that_was_used_up(
    clauses: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """So little is missing at 0.34 N*m that there is neither a motion nor a proof of that.

    A constant torque turns the link by tau t^2 / (2 L^3 / 3) in t = 2 s.  Least is needed from
    (1.2, 0.3) to (0.3, 1.2), by 1.0808 rad, for which L^2 = 1.53: 0.3409 N*m.
    """
    weak = replaced(SHORT, "effort <= 10 N*m", "effort <= 0.34 N*m")
    out = synthesised(tmp_path, mission(SCENE, clauses, SHORT, weak))
    (entry,) = result_files.read(out, "design.json")["open"]
    assert (entry["task"], entry["words"]) == ("B", [ARM.split()])
    assert "the budget of paths is used up" in entry["reason"]
    capsys.readouterr()
    assert run(["why", str(out), "-q"]) == 0
    said = capsys.readouterr().out
    assert "    try first: more steps or more effort, or larger budgets: `--paths`" in said
    assert "--time-limit" not in said


@pytest.mark.parametrize(
    "entry",
    [
        {"task": "Nobody"},
        {"reason": 3},
        {"try_first": []},
        {"robots": 0},
        {"words": []},
        {"words": [[1]]},
    ],
)
def test_entries_that_were_altered_are_refused(entry: dict[str, object]) -> None:
    stated = {"task": "A", "reason": "r", "try_first": None, "robots": 1, "words": [["B"]]}
    assert stated_undecided({"open": [stated]}, ["A", "B"])
    with pytest.raises((TypeError, LookupError)):
        stated_undecided({"open": [stated | entry]}, ["A", "B"])


@pytest.mark.slow
def test_what_is_found_among_some_structures_verifies_and_claims_no_least(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """L K is 1 m long, and with one L more 1.4 m; the grammar has thousands of arms."""
    monkeypatch.setattr(compared_structures, "MOST_ROBOTS", 12)
    path, out = tmp_path / "arms.srg", tmp_path / "out"
    text = fixed(arms("reconfigure; minimize changes;", "1.0", "1.4", **FIXED))
    path.write_text(text, encoding="utf-8")
    assert run(["synth", str(path), "--mission", "M", "-q", "-o", str(out)]) == 0
    assert "changes 1, not proved least" in capsys.readouterr().out
    assert run(["verify", str(out)]) == 0
    said = capsys.readouterr().out
    assert "  holds     changes 1\n" in said
    assert "cost less" not in said
    assert run(["why", str(out), "-q"]) == 0
    claim = result_files.read(out, "mission.json")
    claim["least"] = "1"
    claim["digest"] = result_files.digest(claim)
    result_files.write(out, claim, "mission.json")
    assert run(["verify", str(out)]) == 1
    assert "more than 1,000 structures" in capsys.readouterr().out
