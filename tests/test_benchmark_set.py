"""The benchmark set: its files are what its list says, and answers are judged as its page says."""

from __future__ import annotations

import importlib
import itertools
import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
import shapely

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.load import load
from solvers.search.path_cores import PathCore, PathCores
from srgc.session import check_loaded

ROOT = Path(__file__).parents[1]
# The benchmarks are programs of a folder, and import each other by their names.
sys.path.append(str(ROOT / "benchmarks"))
bench_solvers: Any = importlib.import_module("bench_solvers")
bench_tables: Any = importlib.import_module("bench_tables")
srgc_bench: Any = importlib.import_module("srgc_bench")
synth_without: Any = importlib.import_module("synth_without")
task_families: Any = importlib.import_module("task_families")

TASKS = bench_solvers.tasks()
FOLDER: Path = bench_solvers.TASKS
SHIPPED = FOLDER / "solvers.toml"


def text_of(name: str) -> str:
    return (FOLDER / f"{name}.srg").read_text(encoding="utf-8")


# --- the tasks ----------------------------------------------------------------------------------


def test_the_list_names_all_files() -> None:
    assert sorted(TASKS) == sorted(file.stem for file in FOLDER.glob("*.srg"))
    assert len(TASKS) >= 60
    assert {task.known for task in TASKS.values()} == {"found", "impossible", "open"}
    page = (ROOT / "docs" / "reference" / "benchmark-set.md").read_text(encoding="utf-8")
    assert f"\n{len(TASKS)} tasks" in page
    named = {name for line in page.splitlines() if line.startswith("| `")
             for name in re.findall(r"`(\w+)`", line.split("|")[1])}  # fmt: skip
    assert {task.family for task in TASKS.values()} == named
    assert all(task.why for task in TASKS.values() if task.known == "impossible")


@pytest.mark.parametrize("name", TASKS)
def test_tasks_are_formatted_and_without_errors(name: str) -> None:
    checked = check_loaded(load(FOLDER / f"{name}.srg"))
    assert checked.program is not None
    assert len(checked.program.tasks) == 1
    assert canonical(text_of(name), Sink()) == text_of(name)


def test_families_are_written_by_their_program() -> None:
    for name, text in task_families.family_files().items():
        assert text == (FOLDER / name).read_text(encoding="utf-8"), name
    for family, (_, sizes) in task_families.FAMILIES.items():
        grown = {task.size for task in TASKS.values() if task.family == family}
        assert grown == set(sizes)


def box(name: str, region: str) -> shapely.Geometry:
    number = r"(-?[\d.]+)"
    sides = rf"{region} box \[{number}, {number}\] x \[{number}, {number}\] m"
    found = re.search(sides, text_of(name))
    assert found is not None
    low, high, bottom, top = map(float, found.groups())
    return shapely.box(low, bottom, high, top)


@pytest.mark.parametrize(
    ("name", "region", "fores"),
    [
        ("impossible_far", "Shelf", 1),
        ("impossible_near", "Bin", 1),
        ("impossible_far_many", "Shelf", 5),
        ("impossible_order", "Key", 1),
        ("impossible_modules", "Shelf", 1),
    ],
)
def test_what_is_out_of_reach_is(name: str, region: str, fores: int) -> None:
    """The distances that limbs one after another have, against that of the region."""
    ranges = re.findall(r"param length in \[([\d.]+), ([\d.]+)\] m", text_of(name))
    (upper_low, upper_high), (fore_low, fore_high) = [tuple(map(float, each)) for each in ranges]
    base, goal = shapely.Point(0, 0), box(name, region)
    most = upper_high + fores * fore_high
    least = max(0.0, upper_low - fores * fore_high, fore_low - upper_high if fores == 1 else 0.0)
    nearest = shapely.distance(base, goal)
    farthest = shapely.hausdorff_distance(base, goal)
    assert nearest > most or farthest < least


def test_walls_that_enclose_the_target_leave_no_way() -> None:
    text = text_of("impossible_walled")
    walls = [
        shapely.MultiPoint(
            [tuple(map(float, p.split(", "))) for p in re.findall(r"\(([^)]+)\)", w)]
        )
        for w in re.findall(r"obstacle \w+ hull ([^;]+) m;", text)
    ]
    ring = shapely.union_all([wall.convex_hull for wall in walls])
    assert len(ring.interiors) == 1
    inside = shapely.Polygon(ring.interiors[0])
    assert inside.contains(box("impossible_walled", "Shelf"))
    assert not inside.intersects(box("impossible_walled", "Home"))


# --- answers ------------------------------------------------------------------------------------


def solver(folder: Path, code: str, answer: str = "json") -> Any:
    """A solver that runs some Python, from a file as users write them."""
    program, file = folder / "mine.py", folder / "mine.toml"
    program.write_text(f"import json, sys\nspec, out, limit = sys.argv[1:]\n{code}\n", "utf-8")
    command = f"{{python}} {program} {{spec}} {{out}} {{limit}}"
    file.write_text(f'[mine]\nsays = "mine"\nanswer = "{answer}"\ncommand = "{command}"\n', "utf-8")
    return bench_solvers.solvers(file)["mine"]


def answered(folder: Path, code: str, answer: str = "json", task: str = "links_001") -> Any:
    told = bench_solvers.run(solver(folder, code, answer), TASKS[task], folder / "out", 5)
    assert told.pop("cpu_seconds") >= 0
    return told


SAY = "open(out + '/answer.json', 'w').write(json.dumps({}))"


@pytest.mark.parametrize(
    ("code", "told"),
    [
        (SAY.format("{'verdict': 'unknown'}"), {"verdict": "unknown"}),
        (
            SAY.format("{'verdict': 'found', 'evidence': 'simulated', 'value': 4, 'bound': 3}"),
            {"verdict": "found", "evidence": "simulated", "value": 4, "bound": 3},
        ),
        (SAY.format("{'verdict': 'impossible'}"), {"verdict": "impossible", "evidence": "claimed"}),
        (SAY.format("{'verdict': 'perhaps'}"), {"verdict": "unreadable answer: no verdict"}),
        (SAY.format("[]"), {"verdict": "unreadable answer: no verdict"}),
        ("sys.exit(3)", {"verdict": "no answer, exit status 3"}),
        ("import os, signal; os.kill(os.getpid(), signal.SIGXCPU)", {"verdict": "out of time"}),
    ],
)
def test_answers_are_read(tmp_path: Path, code: str, told: dict[str, Any]) -> None:
    assert answered(tmp_path, code) == told


def test_what_is_no_json_is_no_answer(tmp_path: Path) -> None:
    told = answered(tmp_path, "open(out + '/answer.json', 'w').write('{')")
    assert told["verdict"].startswith("unreadable answer: ")


def test_exit_statuses_of_srgc_are_verdicts(tmp_path: Path) -> None:
    assert answered(tmp_path, "sys.exit(4)", "srgc") == {"verdict": "unknown"}
    claimed = {"verdict": "impossible", "evidence": "claimed"}
    assert answered(tmp_path, "sys.exit(3)", "srgc") == claimed


def test_results_are_verified(tmp_path: Path) -> None:
    """A result of srgc is checked; one that was altered is refused, and the answer is wrong."""
    task = TASKS["impossible_far"]
    srgc = bench_solvers.solvers(SHIPPED)["srgc"]
    told = bench_solvers.run(srgc, task, tmp_path / "out", 60)
    assert (told["verdict"], told["evidence"]) == ("impossible", "checked")
    assert bench_tables.solved(told)
    altered = tmp_path / "out" / "result" / "certificate.json"
    claim = json.loads(altered.read_text(encoding="utf-8"))
    claim["structures"] = claim["structures"][1:]
    kept = tmp_path / "kept"
    (tmp_path / "out" / "result").rename(kept)
    (kept / "certificate.json").write_text(json.dumps(claim), encoding="utf-8")
    copy = f"import shutil; shutil.copytree('{kept}', out + '/result'); sys.exit(3)"
    told = answered(tmp_path, copy, "srgc", task.name)
    assert (told["verdict"], told["evidence"]) == ("impossible", "refused")
    assert not bench_tables.solved(told)
    assert bench_tables.is_wrong(told, task)


@pytest.mark.parametrize("verdict", ["found", "impossible", "unknown", "out of time"])
@pytest.mark.parametrize("known", ["found", "impossible", "open"])
def test_wrong_is_what_contradicts(verdict: str, known: str) -> None:
    task = bench_solvers.Task("any", "any", known, "", None)
    wrong = {verdict, known} == {"found", "impossible"}
    assert bench_tables.is_wrong({"verdict": verdict, "evidence": "checked"}, task) == wrong


@pytest.mark.parametrize(
    ("value", "bound", "gap"), [(4, 3, 0.25), (4, 4, 0), (0, 0, 0), (-2, -3, 0.5), (4, None, None)]
)
def test_gaps(value: float, bound: float | None, gap: float | None) -> None:
    assert bench_tables.gap({"value": value, "bound": bound}) == gap


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[mine", "mine.toml: "),
        ('[mine]\ncommand = "x"', "`mine` needs `says` and `command`"),
        ('[mine]\nsays = "x"\ncommand = "x"\nlimit = 3', "`mine` needs `says` and `command`"),
        ('[mine]\nsays = "x"\ncommand = "x"\nanswer = "xml"', '"json" or "srgc", not "xml"'),
    ],
)
def test_files_of_solvers_that_are_none(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit, match=re.escape(says)):
        bench_solvers.solvers(file)


# --- the command --------------------------------------------------------------------------------


def bench(monkeypatch: pytest.MonkeyPatch, *options: object) -> None:
    monkeypatch.setattr(sys, "argv", ["srgc_bench.py", *map(str, options)])
    srgc_bench.main()


def test_answers_are_kept_and_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A second run asks nothing again; another limit does; parts come together."""
    log = tmp_path / "asked"
    solver(
        tmp_path, f"open(r'{log}', 'a').write(spec + '\\n');" + SAY.format("{'verdict': 'unknown'}")
    )
    own = ["--file", tmp_path / "mine.toml", "--solvers", "mine", "-o", tmp_path / "out"]
    record = tmp_path / "record.json"
    bench(monkeypatch, *own, "--tasks", "links", "--limit", 5, "--part", "1/2")
    assert len(log.read_text(encoding="utf-8").splitlines()) == 4
    for _ in range(2):
        bench(monkeypatch, *own, "--tasks", "links", "--limit", 5, "--record", record)
        assert len(log.read_text(encoding="utf-8").splitlines()) == 7
    bench(monkeypatch, *own, "--tasks", "links_003", "--limit", 6)
    assert len(log.read_text(encoding="utf-8").splitlines()) == 8
    kept = json.loads(record.read_text(encoding="utf-8"))
    assert list(kept["answers"]["mine"]) == [f"links_00{n}" for n in range(1, 8)]
    assert "| mine | 0/7 | 0 | 0 |" in capsys.readouterr().out
    assert not (tmp_path / "out" / "curves.svg").exists()  # nothing was solved


def test_curves_are_of_families_with_a_verdict(tmp_path: Path) -> None:
    good = {"verdict": "found", "evidence": "checked", "cpu_seconds": 2.0}
    bad = {"verdict": "unknown", "cpu_seconds": 60.0}
    own = {"links_001": good, "links_003": bad, "cells_004": bad, "logic_key": good}
    bench_tables.draw_curves({"answers": {"mine": own}}, tmp_path / "curves.svg")
    drawn = (tmp_path / "curves.svg").read_text(encoding="utf-8")
    assert bench_tables.TITLES["links"] in drawn
    assert bench_tables.TITLES["cells"] not in drawn


@pytest.mark.parametrize(
    ("options", "says"),
    [(["--solvers", "none"], "no solver: none"), (["--tasks", "none"], "no task or family: none")],
)
def test_names_that_are_none(
    monkeypatch: pytest.MonkeyPatch, options: list[str], says: str
) -> None:
    with pytest.raises(SystemExit, match=says):
        bench(monkeypatch, *options)


# --- the ablation -------------------------------------------------------------------------------


def test_every_part_has_a_solver() -> None:
    known = bench_solvers.solvers(SHIPPED)
    assert set(known) == {"srgc", *(f"without_{part}" for part in synth_without.PARTS)}
    for name, each in known.items():
        words = each.filled(Path("a task.srg"), Path("out"), 7)
        assert words[2] == name.removeprefix("without_").replace("srgc", "nothing")
        assert words[3] == "a task.srg"


def test_without_cores_a_path_explains_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(PathCores, "explained", PathCores.explained)
    synth_without.without_cores()

    class Problem:
        formula, loop, cells = None, None, (4, 7, 9)

    cores: Any = object.__new__(PathCores)
    assert cores.explained(Problem(), None, "") == PathCore((0, 1, 2))
    Problem.loop = object()  # type: ignore[assignment]
    assert cores.explained(Problem(), None, "") is None


def test_without_dovetailing_structures_come_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    from solvers.search.search_queue import SearchQueue

    class UnderWay:
        round = 5

    def wants(*under_way: Any) -> bool:
        return SearchQueue(every=False, entered=1, under_way=list(under_way)).wants_another()

    monkeypatch.setattr(SearchQueue, "wants_another", SearchQueue.wants_another)
    assert wants(UnderWay())
    synth_without.without_dovetailing()
    assert [wants(UnderWay()), wants()] == [False, True]


def test_without_feedback_only_what_is_asked_for_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    from solvers.search import motion_proof
    from solvers.search.closed_loop import needs_feedback

    monkeypatch.setattr(motion_proof, "feedback_choices", motion_proof.feedback_choices)
    proof = motion_proof.MotionProof
    monkeypatch.setattr(proof, "wants_feedback", proof.wants_feedback)
    synth_without.without_feedback()
    for control, loop in itertools.product(("", "feedback", "open loop"), (None, object())):
        problem: Any = type("Problem", (), {"loop": loop})
        problem.task = type("Task", (), {"control": control, "robust": None})
        choices: Any = motion_proof.feedback_choices
        assert choices(problem, None) == (needs_feedback(problem),)
    anything: Any = object()
    assert not proof.wants_feedback(anything, anything)


def test_without_polishing_evaluations_stay_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    from solvers.search import configuration_search

    survey: Any = configuration_search._Survey
    monkeypatch.setattr(survey, "polished", survey.polished)
    synth_without.without_polishing()
    fake: Any = type("Survey", (), {"space": type("Space", (), {"is_point": False})})
    fake.attempts, fake.basins = ["all"], lambda: ["best"]
    assert survey.polished(fake, None) == ["best"]
