"""The page about a mission: against its folder, and by what the missions are made to come to."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.oracles import result_files
from tests.oracles.html_page import Page
from tests.srgc.conftest import Ran
from tests.srgc.report.conftest import HOSTILE, page_of

Pages = Callable[[str], tuple[Path, Page]]
Run = Callable[..., Ran]
KINDS = ["retune", "grow", "both", "nobody", "bound", "before"]


def design_of(folder: Path) -> dict[str, Any]:
    return result_files.read(folder, "design.json")


@pytest.fixture(scope="session")
def mission_pages(pages: Pages) -> Pages:
    return lambda name: pages(f"mission_{name}")


@pytest.mark.parametrize("name", KINDS)
def test_the_page_is_whole_and_loads_nothing(mission_pages: Pages, name: str) -> None:
    _, page = mission_pages(name)
    assert page.faults == []
    assert page.loaded == []
    assert page.handlers == []
    assert page.dangling == []
    assert len(page.source.encode()) < 1_000_000


@pytest.mark.parametrize(
    ("name", "badge", "claim"),
    [
        ("grow", "found, proved, level validated", "Changes 4, the robot rebuilt 2 times; no"),
        ("retune", "found, proved, level validated", "Changes 0.5, the robot rebuilt 1 time; no"),
        ("both", "found, proved, level validated", "One robot for 2 tasks; price 14, none has"),
        ("nobody", "impossible, proved, level validated", "no robot of at most 4 modules does all"),
        ("bound", "impossible, proved, level validated", "no robots do the tasks within 1"),
    ],
)
def test_the_verdict_and_the_claim_come_first(
    mission_pages: Pages, name: str, badge: str, claim: str
) -> None:
    _, page = mission_pages(name)
    (head,) = page.all("header")
    said = " ".join(head.text.split())
    assert badge in said
    assert claim in said


def test_modules_are_marked_by_signs_and_classes(mission_pages: Pages) -> None:
    """JO and L come for the second task and go after it: both robots of one link are unmarked."""
    _, page = mission_pages("grow")
    marked = [
        (each.attributes["class"], each.text)
        for each in page.all("g")
        if each.attributes.get("class", "").startswith("module ")
        and {"added", "removed", "changed"} & set(each.attributes["class"].split())
    ]
    assert sorted(each.split()[1] for each, _ in marked) == ["joint", "link"]
    assert all("added" in each and "removed" in each for each, _ in marked)
    assert all("added, removed" in said for _, said in marked)
    names = [each.text for each in page.all("g") if "name" in each.attributes.get("class", "")]
    assert {name for name in names if name.startswith("+")} == {
        "+ \N{MINUS SIGN} JO 6",
        "+ \N{MINUS SIGN} L 80.5 m",
    }
    assert page.section("robots").count("cost 2") == 2


def test_a_changed_parameter_is_marked(mission_pages: Pages) -> None:
    _, page = mission_pages("retune")
    (mark,) = [each for each in page.all("g") if "changed" in each.attributes.get("class", "")]
    assert mark.attributes["data-symbol"] == "4"
    assert "Δ L 4.length; 4 modules kept: cost 0.5" in page.section("robots")


@pytest.mark.parametrize("name", ["grow", "retune", "both"])
def test_a_robot_that_comes_back_is_no_other_one(mission_pages: Pages, name: str) -> None:
    folder, page = mission_pages(name)
    robots = {
        (*each["word"], *((p["symbol"], p["name"], p["value"]) for p in each["parameters"]))
        for each in design_of(folder)["robots"]
    }
    assert {"grow": 2, "retune": 2, "both": 1}[name] == len(robots)
    assert f"different robots{len(robots)}" in page.section("verdict")


def test_one_robot_is_drawn_once(mission_pages: Pages) -> None:
    _, page = mission_pages("both")
    assert len([e for e in page.all("svg") if e.attributes["class"] == "modules"]) == 1
    assert "For Long, Again" in page.section("robots")
    assert page.all("table", class_="steps") == []


def test_the_robot_before_is_drawn_with_the_lengths_of_what_is_kept(mission_pages: Pages) -> None:
    folder, page = mission_pages("before")
    assert "There before" in page.section("robots")
    (robot,) = design_of(folder)["robots"]
    assert len(robot["changes"]["added"]) == 2
    assert len([e for e in page.all("svg") if e.attributes["class"] == "modules"]) == 2


@pytest.mark.parametrize("name", ["grow", "retune", "before"])
def test_the_table_of_steps_has_what_the_folder_says(mission_pages: Pages, name: str) -> None:
    folder, page = mission_pages(name)
    (table,) = page.all("table", class_="steps")
    rows = [[c for c in page.elements if c.parent is row] for row in page.all("tr")
            if row.within("class", "steps")][1:]  # fmt: skip
    costs = [row[-2].text for row in rows if row[-2].text]
    said = [each["changes"]["cost"] for each in design_of(folder)["robots"] if each["changes"]]
    assert [float(cost) for cost in costs] == said
    assert float(rows[-1][-1].text) == design_of(folder)["cost"]
    for each in design_of(folder)["robots"]:
        assert " ".join(each["word"]) in table.text


def test_the_animation_has_all_motions_in_turn(mission_pages: Pages) -> None:
    folder, page = mission_pages("grow")
    data = page.data("motion-data")
    tasks = [each["task"] for each in design_of(folder)["robots"]]
    assert [each["motion"]["steps"] for each in data] == [12, 12, 12]
    assert [e.attributes["data-task"] for e in page.all("div", class_="part")] == tasks
    (slider,) = page.all("input", type_="range")
    assert slider.attributes["max"] == str(3 * 13 - 1)
    assert [e.text for e in page.all("button") if "data-part" in e.attributes] == tasks
    assert len({(each["scale"], each["unit"]) for each in data}) == 1
    poses = [e for e in page.all("path") if e.attributes.get("id", "").startswith("pose-")]
    assert len({e.attributes["id"] for e in poses}) == len(poses)


def test_each_task_has_its_figures_and_commands(mission_pages: Pages) -> None:
    folder, page = mission_pages("grow")
    for each in page.all("div", class_="task"):
        task = each.attributes["data-task"]
        own = result_files.read(folder / "tasks" / task, "design.json")
        assert f"{100 * own['robustness_share']:.4g} %" in each.text
        assert f"srgc verify tasks/{task}" in each.text
        assert "valid, level validated" in each.text


def test_what_is_refuted_stands_by_task(mission_pages: Pages) -> None:
    folder, page = mission_pages("nobody")
    claim = result_files.read(folder, "mission.json")
    section = page.section("refuted")
    assert section.startswith("Why there are no robots")
    for task in claim["tasks"]:
        (row,) = page.all("tr", data_task=task["task"])
        cells = [cell.text for cell in page.elements if cell.parent is row]
        assert cells[:3] == [task["task"], str(len(task["structures"])), str(len(task["lemmas"]))]
    assert "1 structure: no poses in the start region and in the target" in section


def test_boxes_of_parameters_are_counted(mission_pages: Pages) -> None:
    folder, page = mission_pages("retune")
    files = {path.parent.name for path in folder.glob("proofs/*/cut*.boxes")}
    assert files == {"Long", "Short"}
    for task in files:
        (row,) = page.all("tr", data_task=task)
        cells = [cell.text for cell in page.elements if cell.parent is row]
        assert cells[3] == "1"
        assert cells[4].startswith("1, with ")


def test_unknown_says_so_by_task(result: Callable[[str], Path]) -> None:
    folder = result("mission_nobody")
    (folder / "mission.json").unlink()
    design = design_of(folder)
    design |= {"verdict": "unknown", "reason": HOSTILE, "undecided": 2}
    design["refuted"][1]["reasons"] = [{"reason": HOSTILE, "robots": 1, "word": ["B"]}]
    design |= {"ended_by": HOSTILE, "try_first": HOSTILE}
    design["open"] = [
        {"task": None, "reason": HOSTILE, "try_first": HOSTILE, "robots": 2, "words": [[HOSTILE]]}
    ]
    result_files.write(folder, design, "design.json")
    page = page_of(folder)
    assert page.faults == []
    assert "Other robots are left" in page.section("refuted")
    assert "alert(1)" in page.section("refuted")
    assert "neither robots that are proved" in page.section("verdict")
    assert len(page.all("script")) == 1


def test_without_a_check_the_page_says_so(result: Callable[[str], Path]) -> None:
    page = page_of(result("mission_retune"), "--no-verify")
    assert "found, not checked for this page" in page.all("header")[0].text
    assert all(each["motion"]["tube"] is None for each in page.data("motion-data"))


def test_a_false_claim_is_reported_as_refuted(result: Callable[[str], Path]) -> None:
    folder = result("mission_nobody")
    claim = result_files.read(folder, "mission.json")
    for task in claim["tasks"]:
        task["structures"] = []
    claim["digest"] = result_files.digest(claim)
    result_files.write(folder, claim, "mission.json")
    page = page_of(folder)
    assert "the claim is refuted" in page.all("header")[0].text
    assert "Do not rely on what this folder says" in page.section("verdict")


def raised(design: dict[str, Any]) -> None:
    design["cost"] += 1


def renamed(design: dict[str, Any]) -> None:
    design["robots"][0]["word"][2] = "L"


def unchanged(design: dict[str, Any]) -> None:
    design["robots"][1]["changes"]["added"] = []


def another(design: dict[str, Any]) -> None:
    design["mission"] = "Swap"


def counted(design: dict[str, Any]) -> None:
    design["refuted"][0]["structures"] = "many"


def more_robust(design: dict[str, Any]) -> None:
    design["robots"][0]["robustness"] += 0.01


def forgotten(design: dict[str, Any]) -> None:
    del design["robots"][0]["robustness"]


@pytest.mark.parametrize(
    "change", [more_robust, forgotten, raised, renamed, unchanged, another, counted]
)
def test_what_was_altered_is_refused(
    result: Callable[[str], Path], srgc: Run, change: Callable[[dict[str, Any]], None]
) -> None:
    folder = result("mission_grow")
    design = design_of(folder)
    change(design)
    result_files.write(folder, design, "design.json")
    ran = srgc("report", folder)
    assert ran.status == 2
    assert ran.err.startswith("error: ")
    assert not (folder / "report.html").exists()


def test_a_claim_with_an_old_digest_is_refused(result: Callable[[str], Path], srgc: Run) -> None:
    folder = result("mission_grow")
    claim = result_files.read(folder, "mission.json")
    claim["cost"] = "3"
    result_files.write(folder, claim, "mission.json")
    assert srgc("report", folder).status == 2


def test_designs_of_another_mission_are_refused(result: Callable[[str], Path], srgc: Run) -> None:
    folder, other = result("mission_grow"), result("mission_retune")
    shutil.rmtree(folder / "tasks" / "Wide")
    shutil.copytree(other / "tasks" / "Short", folder / "tasks" / "Wide")
    assert srgc("report", folder).status == 2


def test_the_history_of_a_step_is_on_its_page(
    result: Callable[[str], Path], tmp_path: Path, srgc: Run
) -> None:
    folder = result("mission_retune")
    spec = next((folder / "spec").iterdir())
    step = tmp_path / "step"
    assert srgc("evolve", folder, spec, "--task", "Long", "-o", step, "-q").status == 0
    page = page_of(step)
    assert page.faults == []
    section = page.section("earlier")
    assert re.search(r"1Long.*1Short.*0\.5 m0\.5.*nowLong", section)
    cost = design_of(step)["cost"]
    assert f"Changes {cost:g}" in page.all("header")[0].text
    assert "One step from a robot that there is" in page.section("verdict")
    assert json.loads((step / "design.json").read_text("utf-8"))["history"] == 1
