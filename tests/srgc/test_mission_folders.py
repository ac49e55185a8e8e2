"""Commands and functions that take a result folder, given that of a mission."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest

import srgc as public
from srgc.paths import holds_results
from srgc.results.mission_folder import mission_folder
from tests.oracles import result_files
from tests.srgc.conftest import Ran

Run = Callable[..., Ran]
Made = Callable[[str], Path]


def folder_of(made: Made, name: str) -> Path:
    return made(f"mission_{name}") / "out"


# --- commands about one task ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ("replay", "--in", "python"),
        ("landscape",),
        ("graph", "--of", "lemmas"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_commands_about_one_task_name_the_folders(
    made: Made, srgc: Run, arguments: tuple[str, ...]
) -> None:
    command, *options = arguments
    folder = folder_of(made, "retune")
    ran = srgc(command, folder, *options)
    assert ran.status == 2
    assert ran.out == ""
    assert ran.err == (
        f"error: {folder} holds the results of a mission: name the folder of one of its tasks, "
        f"{folder / 'tasks' / 'Long'}, {folder / 'tasks' / 'Short'}\n"
    )


def test_compare_refuses_a_mission_and_takes_its_designs(made: Made, srgc: Run) -> None:
    folder = folder_of(made, "retune")
    assert "of a mission" in srgc("compare", folder, folder).err
    ran = srgc("compare", folder / "tasks" / "Long", folder / "tasks" / "Short")
    assert ran.status == 0


def test_without_robots_the_message_says_what_takes_it(made: Made, srgc: Run) -> None:
    ran = srgc("landscape", folder_of(made, "nobody"))
    assert ran.status == 2
    assert "`srgc why` and `srgc report` take it" in ran.err


def test_of_many_tasks_the_message_names_the_first(tmp_path: Path, srgc: Run) -> None:
    (tmp_path / "design.json").write_text('{"mission": "M"}', encoding="utf-8")
    for number in range(9):
        (tmp_path / "tasks" / f"T{number}").mkdir(parents=True)
    said = srgc("landscape", tmp_path).err
    assert "tasks/T3, 5 more\n" in said
    assert "T4" not in said


def test_shells_complete_folders_of_missions(made: Made) -> None:
    assert holds_results(folder_of(made, "nobody"))


# --- export ---------------------------------------------------------------------------------------


def test_export_writes_a_folder_for_each_task(made: Made, srgc: Run, tmp_path: Path) -> None:
    folder = folder_of(made, "grow")
    ran = srgc("export", folder, "--to", "csv", "-o", tmp_path / "arms")
    assert ran.status == 0
    written = [Path(line) for line in ran.out.splitlines()]
    tasks = ["Long", "Wide", "Again"]
    assert written == [tmp_path / "arms" / task / "trajectory.csv" for task in tasks]
    for task, path in zip(tasks, written, strict=True):
        one = srgc("export", folder / "tasks" / task, "--to", "csv")
        assert path.read_text(encoding="utf-8") == one.out


def test_export_in_python_does_the_same(made: Made, tmp_path: Path) -> None:
    found = public.export(folder_of(made, "retune"), "urdf", tmp_path / "arms")
    assert [path.relative_to(tmp_path).as_posix() for path in found] == [
        "arms/Long/robot.urdf", "arms/Short/robot.urdf",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "output", "said"),
    [
        ("retune", (), "name a folder for them with -o"),
        ("retune", ("-o", "tasks"), "is one of the results"),
        ("nobody", ("-o", "x"), "has no robot: its verdict is impossible"),
    ],
)
def test_export_refuses(
    result: Made, srgc: Run, name: str, output: tuple[str, ...], said: str
) -> None:
    folder = result(f"mission_{name}")
    places = [folder / each if each != "-o" else each for each in output]
    ran = srgc("export", folder, "--to", "urdf", *places)
    assert (ran.status, ran.out) == (2, "")
    assert said in ran.err


# --- why ------------------------------------------------------------------------------------------


def test_why_says_what_each_task_refutes_and_what_is_left(made: Made, srgc: Run) -> None:
    ran = srgc("why", folder_of(made, "bound"), "-q")
    assert ran.status == 0
    head, *blocks, left = ran.out.rstrip().split("\n\n")
    assert head.startswith("mission Bound: impossible (")
    assert [block.split(":")[0] for block in blocks] == ["task Long", "task Short"]
    assert left.splitlines() == [
        "the cheapest robots that are left would cost 2, and at most 1 is allowed",
        "  Long   B JO L EN",
        "  Short  B JO L EN",
    ]
    assert opened(made, "bound").why().cheapest_left == 2


def test_why_of_one_robot_says_which_tasks_are_needed(made: Made, srgc: Run) -> None:
    """Without the task out of reach, an arm would be left: one that is refuted in no other."""
    told = json.loads(srgc("why", folder_of(made, "nobody"), "--json").out)
    by_task = {each["task"]: each for each in told["tasks"]}
    assert by_task["Lost"]["without"] == {"robots": None, "one_left": True}
    assert told["left"] is None


@pytest.mark.parametrize(("name", "cost"), [("retune", 0.5), ("grow", 4.0), ("swap", 3.0)])
def test_why_of_a_found_mission_has_its_cost_as_the_least_left(
    made: Made, srgc: Run, name: str, cost: float
) -> None:
    """All was proved least, so that nothing cheaper may be left; without a task's, it is."""
    told = json.loads(srgc("why", folder_of(made, name), "--json").out)
    assert (told["cost"], told["least"], told["left"]["cost"]) == (cost, cost, cost)
    without = [each["without"]["robots"]["cost"] for each in told["tasks"] if each["without"]]
    assert min(without) < cost
    assert max(without) <= cost


def test_why_of_one_robot_that_was_found(made: Made, srgc: Run) -> None:
    ran = srgc("why", folder_of(made, "both"), "-q")
    assert ran.out.startswith(
        "mission Both: found, one robot; price 14, proved least; modules 4, proved least\n"
    )


def test_why_of_an_unknown_mission(result: Made, srgc: Run) -> None:
    folder = result("mission_nobody")
    (folder / "mission.json").unlink()
    design = result_files.read(folder, "design.json")
    design |= {"verdict": "unknown", "reason": "the time limit was reached", "undecided": 14}
    words = [["B", *["L"] * n, "E"] for n in range(12)]
    told = {"reason": "too wide", "try_first": None, "words": words}
    design["open"] = [
        {"task": "Lost", "robots": 13, **told},
        {"task": None, "robots": 1, **told, "words": words[:1]},
    ]
    design |= {"ended_by": "time", "try_first": "a longer `--time-limit`"}
    result_files.write(folder, design, "design.json")
    said = srgc("why", folder, "-q").out
    assert said.startswith("mission Nobody: unknown (the time limit was reached)\n")
    *_, lost, together, end = said.rstrip().split("\n\n")
    assert lost == "undecided in Lost:\n  13 robots, as B E, B L E, B L L E: too wide"
    assert together == "undecided in all tasks together:\n  1 robot, B E: too wide"
    assert end == (
        "14 robots undecided; the time limit ended the search\ntry first: a longer `--time-limit`"
    )


def test_why_checks_the_evidence(result: Made, srgc: Run) -> None:
    folder = result("mission_nobody")
    (covering,) = folder.glob("proofs/Lost/*.boxes")
    covering.write_text("boxes 1\n.\n", encoding="utf-8")
    ran = srgc("why", folder)
    assert (ran.status, ran.out) == (2, "")
    assert "`srgc verify` says more" in ran.err


# --- from Python ----------------------------------------------------------------------------------


def opened(made: Made, name: str) -> public.api.mission_result.MissionResult:
    found = public.open_result(folder_of(made, name))
    assert isinstance(found, public.api.mission_result.MissionResult)
    return found


def test_a_mission_is_opened_with_its_designs_and_steps(made: Made) -> None:
    found = opened(made, "grow")
    assert (found.verdict, found.reason, found.mission) == ("found", None, "Grow")
    assert found.tasks == ("Long", "Wide", "Again")
    assert (found.cost, found.least, found.one_robot) == (4.0, 4.0, False)
    assert [design.task for design in found.designs.values()] == [*found.tasks]
    first, there, back = found.steps
    assert first is None
    assert there is not None
    assert back is not None
    assert (there.added, there.removed, there.changed) == (((6, "JO"), (8, "L")), (), ())
    assert back.removed == there.added
    assert there.kept == ((0, 0), (2, 2), (4, 4), (6, 10))
    assert found.designs["Wide"].robot.word.count("JO") == 2


def test_a_changed_parameter_has_its_place(made: Made) -> None:
    _, step = opened(made, "retune").steps
    assert step is not None
    assert (step.cost, step.changed, step.added) == (0.5, ("4.length",), ())


def test_one_robot_has_no_cost(made: Made) -> None:
    found = opened(made, "both")
    assert (found.cost, found.least, found.steps, found.one_robot) == (
        None,
        None,
        (None, None),
        True,
    )
    one, other = found.designs.values()
    assert (one.word, one.parameters) == (other.word, other.parameters)


def test_verify_has_the_answers_on_all_designs(made: Made) -> None:
    found = opened(made, "retune")
    answer = found.verify()
    assert answer.valid
    assert {task: own.outcome.value for task, own in answer.tasks.items()} == {
        "Long": "valid", "Short": "valid",
    }  # fmt: skip
    assert "mission: Retune" in str(answer)
    assert "task Short: valid" in answer._repr_html_()
    assert "verified: valid" in found._repr_html_()
    other = public.verify(found, mission="Grow")
    assert other.outcome.value == "not as expected"
    with pytest.raises(public.SrgcError, match="give the folder of a task in it"):
        public.verify(found, task="Long")


def test_displays(made: Made) -> None:
    found = opened(made, "grow")
    assert repr(found) == "<MissionResult Grow: found, changes 4>"
    assert "  Wide   B eps JO eps L eps JO eps L eps EN  (2 added: 2)" in str(found).splitlines()
    html = found._repr_html_()
    assert html.count("<img") == 3
    assert "not verified yet" in html
    none = opened(made, "nobody")
    assert none.designs == {}
    assert (none.reason or "") in none._repr_html_()


def test_reports_and_explanations(made: Made) -> None:
    found = opened(made, "nobody")
    assert "Why there are no robots" in found.report(verify=False).html
    why = found.why()
    assert [*why.refuted] == ["Long", "Lost"]
    assert why.cheapest_left is None
    assert "task Lost: 1 structure refuted" in str(why)
    assert "task Lost" in why._repr_html_()
    with pytest.raises(public.SrgcError, match=r"`open_result\(…\)\.why\(\)` explains it"):
        public.why(found)


def test_a_mission_is_synthesised_saved_and_pickled(made: Made, tmp_path: Path) -> None:
    spec = next(made("mission_nobody").glob("*.srg"))
    program = public.load(spec)
    assert program.missions[:3] == ("Retune", "Swap", "Grow")
    assert "mission    Nobody         one robot for Long, Lost" in str(program)
    found = public.synthesize(program, mission="Nobody")
    assert found.verdict == "impossible"
    assert found.verify().valid
    again = pickle.loads(pickle.dumps(found))
    assert again.folder != found.folder
    assert again.design == found.design
    assert mission_folder(found.save(tmp_path / "kept")).verdict == "impossible"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"task": "Long"}, "`task` is about one task"),
        ({"every": True}, "`every` is about one task"),
        ({"cells": 3}, "`cells` is about one task"),
        ({"mission": "Growth"}, "there is no mission `Growth`; did you mean `Grow`?"),
    ],
)
def test_what_does_not_go_with_a_mission(
    made: Made, arguments: dict[str, object], said: str
) -> None:
    program = public.load(next(made("mission_nobody").glob("*.srg")))
    with pytest.raises(public.SrgcError, match=said.replace("?", r"\?")):
        public.synthesize(program, **({"mission": "Grow"} | arguments))  # type: ignore[call-overload]
