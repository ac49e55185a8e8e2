"""``srgc why``: what it says of small tasks, by geometry and by running what it suggests."""

from __future__ import annotations

import contextlib
import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from solvers.explanation.conflict import Conflict, Conflicts
from solvers.explanation.explanation import Explanation, Tried
from solvers.explanation.task_line import task_lines
from srgc.cli import run
from srgc.text_reports.why_report import why_text
from tests.oracles import result_files
from tests.oracles.extended_arm import best_robustness
from tests.oracles.least_specs import link
from tests.oracles.least_specs import spec as arms
from tests.oracles.priced_slides import KINDS, priced_slides, word
from tests.oracles.small_specs import SLIDER, TURNER, replaced
from tests.solvers.test_changes import posed
from tests.srgc.conftest import Ran

pytestmark = pytest.mark.usefixtures("without_pictures")


Srgc = Callable[..., Ran]

NARROW = replaced(
    replaced(TURNER, "box [1.2, 1.9] x [-0.3, 0.3] m", "box [1.25, 1.9] x [-0.3, 0.3] m"),
    "x [1.2, 1.9] m;",
    "x [1.25, 1.9] m;",
)
"""Start and target are at least 1.25 m from the base."""
SHORT = replaced(
    replaced(NARROW, "[1, 2] m", "[0.5, 1] m"),
    "effort <= 10 N*m;",
    "effort <= 10 N*m; modules <= 4;",
)
"""One link of at most 1 m: too short.  Another joint and link make five modules and more."""
WEAK = replaced(
    TURNER, "effort <= 10 N*m;", "effort <= 0.1 N*m; modules <= 4;"
)  # a quarter turn takes more
LINES = {"start": "start in S at rest;", "reach": "reach T;", "parameter": "param length"}


@pytest.fixture(scope="module")
def impossible(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("why")
    (folder / "short.srg").write_text(SHORT, encoding="utf-8")
    assert run(["synth", str(folder / "short.srg"), "-o", str(folder / "out"), "--json"]) == 3
    return folder / "out"


def explained(srgc: Srgc, folder: Path, *options: str) -> dict[str, Any]:
    ran = srgc("why", folder, "--json", *options)
    assert (ran.status, ran.err) == (0, "")
    content = json.loads(ran.out)
    assert isinstance(content, dict)
    return content


@pytest.fixture(scope="module")
def found(impossible: Path) -> dict[str, Any]:
    """The whole explanation, with all runs."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        assert run(["why", str(impossible), "--json"]) == 0
    content = json.loads(text.getvalue())
    assert isinstance(content, dict)
    return content


def check_place(line: dict[str, Any], text: str) -> None:
    """A line of the explanation is where the spec says what it is about."""
    wanted = LINES[line["kind"]]
    row = text.splitlines()[line["line"] - 1]
    assert row[line["column"] - 1 :].startswith(wanted)


def test_conflicts_and_suggestions(srgc: Srgc, found: dict[str, Any], tmp_path: Path) -> None:
    (mine,) = [
        c for c in found["conflicts"] if ["B", "eps", "JO", "eps", "L", "eps", "EN"] in c["robots"]
    ]
    assert {line["kind"] for line in mine["lines"]} == {"start", "parameter"}
    for conflict in found["conflicts"]:
        for line in conflict["lines"]:
            check_place(line, SHORT)
    says = {one["says"]: one for one in found["suggestions"]}
    # 1.3 is the least number of two digits above 1.25, the least distance.
    assert "with `L.length` up to 1.3 m" in says
    assert found["modules"]["line"] == SHORT[: SHORT.index("modules <=")].count("\n") + 1
    for length, status in (("1.3", 0), ("1.2", 3)):
        path = tmp_path / f"{length}.srg"
        path.write_text(replaced(SHORT, "[0.5, 1] m", f"[0.5, {length}] m"), encoding="utf-8")
        assert srgc("synth", path, "-o", tmp_path / length, "--json").status == status


def test_every_suggested_bound_on_modules_is_found(
    srgc: Srgc, found: dict[str, Any], tmp_path: Path
) -> None:
    bounds = [one for one in found["suggestions"] if "modules" in one["says"]]
    for one in bounds:
        path = tmp_path / "more.srg"
        bound = f"modules <= {int(one['value'])}"
        path.write_text(replaced(SHORT, "modules <= 4", bound), encoding="utf-8")
        assert srgc("synth", path, "-o", tmp_path / "more", "--json").status == 0
    assert bounds


def test_text_has_excerpts_with_carets(srgc: Srgc, impossible: Path) -> None:
    ran = srgc("why", impossible, "--no-runs")
    assert ran.status == 0
    lines = ran.out.splitlines()
    place = next(i for i, line in enumerate(lines) if "the range of `L.length`" in line)
    row, column = (int(part) for part in lines[place].split(":")[1:3])
    text = SHORT.splitlines()[row - 1]
    assert lines[place + 1].endswith(text)
    carets = lines[place + 2].index("^") - lines[place + 1].index(text) + 1
    assert carets == column == text.index("param") + 1
    assert "No changes were tried." in ran.out
    assert "short.srg" in lines[place]


def test_the_same_twice(srgc: Srgc, impossible: Path) -> None:
    first = srgc("why", impossible, "--no-runs").out
    assert srgc("why", impossible, "--no-runs").out == first


def test_time_that_is_too_short(srgc: Srgc, impossible: Path) -> None:
    ran = srgc("why", impossible, "--time-limit", 1e-9)
    assert ran.status == 0
    assert "not all was tried: the time limit was reached" in ran.out
    # What the search said of robots stands there, whether or not lines were found.
    tried = json.loads((impossible / "design.json").read_text())["structures_tried"]
    refuted = [each for each in tried if each["verdict"] == "refuted"]
    for each in refuted[:3]:
        assert f"  {' '.join(each['word'])}: {each['reason']}" in ran.out


def test_synth_ends_with_a_conflict(srgc: Srgc, impossible: Path) -> None:
    ran = srgc("synth", impossible.parent / "short.srg", "-o", impossible)
    assert ran.status == 3
    assert "the range of `L.length`" in ran.out
    assert ran.out.splitlines()[-1].startswith("next:    srgc why")


def test_synth_ends_with_the_reason_where_a_conflict_takes_long(srgc: Srgc, tmp_path: Path) -> None:
    text = replaced(SHORT, "avoid O with effector;", "avoid O with body;")
    (tmp_path / "body.srg").write_text(text, encoding="utf-8")
    ran = srgc("synth", tmp_path / "body.srg", "-o", tmp_path / "out", "--no-lemmas")
    assert ran.status == 3
    first, last = ran.out.splitlines()[-2:]
    assert first.startswith("B eps JO eps L eps EN: no ")
    assert last.startswith("next:    srgc why")


def test_after_a_time_limit(srgc: Srgc, tmp_path: Path) -> None:
    (tmp_path / "turn.srg").write_text(TURNER, encoding="utf-8")
    ran = srgc("synth", tmp_path / "turn.srg", "-o", tmp_path / "out", "--time-limit", 1e-9)
    assert ran.status == 4
    assert "next:    run the same command again to continue" in ran.out
    found = explained(srgc, tmp_path / "out", "--no-runs")
    assert (found["verdict"], found["conflicts"], found["runs"]) == ("unknown", [], 0)
    said = srgc("why", tmp_path / "out", "--no-runs").out.splitlines()
    assert said[0].startswith("verdict: unknown (the time limit was reached")
    assert said[1].startswith("The search was not finished")


def test_a_place_is_shown_once_with_all_that_is_said_about_it() -> None:
    """The range and the effort of one joint are in one statement."""
    limits = "dof q: revolute z in [-1, 1] rad effort <= 5 N*m;"
    asked = posed(replaced(TURNER, "dof q: revolute z in [-180, 180] deg;", limits))
    about = {line.kind: line for line in task_lines(asked)}
    lines = tuple(about[kind] for kind in ("joint_range", "start", "joint_effort"))
    found = Explanation(
        asked, Tried("impossible", "", ()), Conflicts((Conflict(lines, (("B",),)),))
    )
    text = why_text(found)
    assert text.count(limits) == 1
    assert ": the range of `JO.q`; the effort of `JO.q`\n" in text


def test_refuted_robots_that_are_left_out_are_counted() -> None:
    """Of nine robots without a conflict, six reasons are shown."""
    reasons = {("B",) * size: f"reason {size}" for size in range(1, 9)}
    found = Explanation(
        posed(TURNER), Tried("impossible", "", (), reasons=reasons), Conflicts((), left=9)
    )
    text = why_text(found)
    assert "no conflict is known yet: 9\n  B: reason 1\n" in text
    assert text.count(": reason ") == 6
    assert "\n  and 3 more\n" in text


def test_lines_of_an_included_file(srgc: Srgc, tmp_path: Path) -> None:
    module = "module L  { role link; param length in [0.5, 1] m; const density = 1 kg/m; }\n"
    (tmp_path / "parts.srg").write_text("// links\n" + module, encoding="utf-8")
    main = 'include "parts.srg";\n' + replaced(SHORT, module, "")
    (tmp_path / "main.srg").write_text(main, encoding="utf-8")
    assert srgc("synth", tmp_path / "main.srg", "-o", tmp_path / "out").status == 3
    found = explained(srgc, tmp_path / "out", "--no-runs")
    lines = [line for conflict in found["conflicts"] for line in conflict["lines"]]
    parts = {(line["file"], line["line"]) for line in lines if line["kind"] == "parameter"}
    assert parts == {("parts.srg", 2)}


@pytest.mark.slow
def test_an_effort_that_suffices(srgc: Srgc, tmp_path: Path) -> None:
    """A torque about a fixed axis: mechanics says how large it must be to turn so far in 2 s."""
    (tmp_path / "weak.srg").write_text(WEAK, encoding="utf-8")
    assert srgc("synth", tmp_path / "weak.srg", "-o", tmp_path / "out", "--json").status in (3, 4)
    found = explained(srgc, tmp_path / "out")
    (effort,) = [one for one in found["suggestions"] if "effort" in one["says"]]
    needed = 1 - best_robustness(1.2, 2)
    assert needed <= effort["value"] <= 1.2 * needed
    path = tmp_path / "strong.srg"
    path.write_text(replaced(WEAK, "0.1 N*m", f"{effort['value']} N*m"), encoding="utf-8")
    assert srgc("synth", path, "-o", tmp_path / "strong", "--json").status == 0


def test_a_family_without_robots_within_the_bound(srgc: Srgc, tmp_path: Path) -> None:
    text = replaced(TURNER, "effort <= 10 N*m;", "effort <= 10 N*m; modules <= 2;")
    (tmp_path / "few.srg").write_text(text, encoding="utf-8")
    ran = srgc("synth", tmp_path / "few.srg", "-o", tmp_path / "out")
    assert ran.status == 3
    assert ran.out.startswith("verdict: impossible (the family has no robot of at most 2 modules)")
    found = explained(srgc, tmp_path / "out")
    assert found["modules"]["kind"] == "modules"
    assert [one["says"] for one in found["suggestions"]] == ["with `modules <= 4`"]


@pytest.mark.slow
def test_refuted_up_to_the_default_bound_is_explained_like_impossible(
    srgc: Srgc, tmp_path: Path
) -> None:
    text = replaced(
        replaced(SHORT, " modules <= 4;", ""),
        "accept contains EN and starts with B eps JO;",
        "accept matches B eps JO eps L (eps EN)+;",
    )
    (tmp_path / "endless.srg").write_text(text, encoding="utf-8")
    arguments = tmp_path / "endless.srg", "-o", tmp_path / "out", "--json", "--no-lemmas"
    assert srgc("synth", *arguments).status == 4
    found = explained(srgc, tmp_path / "out")
    assert "with `L.length` up to 1.3 m" in {one["says"] for one in found["suggestions"]}
    text = srgc("why", tmp_path / "out", "--no-runs").out
    assert text.index("rule out") < text.index("No changes were tried.")


def test_no_change_has_poses(srgc: Srgc, tmp_path: Path) -> None:
    """One link that turns is at one distance only, whatever its length."""
    text = replaced(
        replaced(TURNER, "x [1.2, 1.9] m;", "x [2.3, 2.9] m;"),
        "accept contains EN and starts with B eps JO;",
        "accept matches B eps JO eps L eps EN;",
    )
    (tmp_path / "radii.srg").write_text(text, encoding="utf-8")
    assert srgc("synth", tmp_path / "radii.srg", "-o", tmp_path / "out", "--json").status == 3
    ran = srgc("why", tmp_path / "out")
    said = "\nNo change of a single line was found that makes it possible: no poses were found "
    assert ran.out.endswith(f"{said}with any of them.\n")


# --- folders that cannot be explained ------------------------------------------------------------


def test_a_design_needs_no_explanation(srgc: Srgc, tmp_path: Path) -> None:
    (tmp_path / "slide.srg").write_text(SLIDER, encoding="utf-8")
    assert srgc("synth", tmp_path / "slide.srg", "-o", tmp_path / "out", "--json").status == 0
    ran = srgc("why", tmp_path / "out")
    assert (ran.status, ran.out.splitlines()[0]) == (0, "verdict: found")
    assert "nothing to explain" in ran.out
    told = json.loads(srgc("why", tmp_path / "out", "--json").out)
    assert told == {"verdict": "found", "objectives": []}


def test_no_results(srgc: Srgc, tmp_path: Path) -> None:
    assert "is not a folder" in srgc("why", tmp_path / "none").err
    ran = srgc("why", tmp_path)
    assert (ran.status, ran.out) == (2, "")
    assert "no design.json" in ran.err


def test_an_altered_spec(srgc: Srgc, impossible: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    shutil.copytree(impossible, folder)
    result_files.alter_spec(folder, "reach T;", "reach S;", sign=False)
    ran = srgc("why", folder)
    assert (ran.status, ran.out) == (2, "")
    assert "altered" in ran.err


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"spec": 1, "spec_sha256": 2}', "\x00"])
def test_results_that_are_none(srgc: Srgc, impossible: Path, tmp_path: Path, content: str) -> None:
    folder = tmp_path / "out"
    shutil.copytree(impossible, folder)
    (folder / "design.json").write_text(content, encoding="utf-8")
    ran = srgc("why", folder)
    assert (ran.status, ran.out) == (2, "")
    assert len(ran.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("verdict", "maybe"),
        ("task", "Other"),
        ("seed", "x"),
        ("seed", -1),
        ("seed", float("inf")),
        ("structures_tried", [{}]),
        ("structures_tried", [{"verdict": "found", "same_robot_as": None}]),
        ("reason", None),
        ("structures_tried", [{"verdict": "refuted", "same_robot_as": None, "derivation": ["no"]}]),
    ],
)
def test_fields_that_are_wrong(
    srgc: Srgc, impossible: Path, tmp_path: Path, key: str, value: object
) -> None:
    folder = tmp_path / "out"
    shutil.copytree(impossible, folder)
    content = result_files.read(folder, "design.json")
    result_files.write(folder, content | {key: value}, "design.json")
    ran = srgc("why", folder)
    assert (ran.status, ran.out) == (2, "")
    assert "is not what `srgc synth` writes" in ran.err


@pytest.mark.parametrize("key", ["search", "solver"])
def test_a_search_or_solver_that_is_not_here(
    srgc: Srgc, impossible: Path, tmp_path: Path, key: str
) -> None:
    folder = tmp_path / "out"
    shutil.copytree(impossible, folder)
    content = result_files.read(folder, "design.json")
    result_files.write(folder, content | {key: "none-such"}, "design.json")
    ran = srgc("why", folder, "--no-runs")
    assert (ran.status, ran.out) == (2, "")
    assert "`none-such`" in ran.err


def test_a_bound_below_every_robot_is_named(srgc, spec, tmp_path):
    """The one word has thirteen modules; up to twelve there is nothing to refute."""
    word = f"B eps JO eps L{' eps EN' * 10}"
    text = replaced(
        TURNER, "accept contains EN and starts with B eps JO;", f"accept matches {word};"
    )
    path = spec(replaced(text, "  horizon", "  modules <= 2;\n  horizon"))
    assert srgc("synth", path, "-q", "-o", tmp_path / "out").status == 3
    ran = srgc("why", tmp_path / "out", "-q", "--no-runs")
    assert ran.status == 0
    assert f"Longer robots are ruled out by the bound, as {word}" in ran.out


# --- A design of a task that says what is to be least ---------------------------------------------


def test_what_the_next_cheaper_robot_lacks(srgc: Srgc, priced: Path) -> None:
    """The one that is cheaper is too heavy for the force, in that time; there is no other one."""
    found = explained(srgc, priced)
    assert (found["verdict"], found["objective"], found["value"]) == ("found", "sum(price)", 10)
    assert found["refuted"] == [{"word": word("Block").split(), "value": KINDS["Block"][1]}]
    (conflict,) = found["conflicts"]
    assert {line["kind"] for line in conflict["lines"]} == {"start", "reach", "effort", "horizon"}
    assert conflict["robots"] == [word("Block").split()]
    assert (found["undecided"], found["found"], found["unexplained"]) == ([], [], 0)
    ran = srgc("why", priced)
    assert ran.status == 0
    assert ran.out.startswith("verdict: found (price 10)\n\nNearest below the design, and refuted:")
    assert "rule out the robot Base e Block e Hand:" in ran.out


@pytest.fixture
def lighter(srgc: Srgc, spec: Callable[[str], Path], tmp_path: Path) -> Path:
    """A light slide instead of the cheapest that is found."""
    text = priced_slides("minimize sum(price) within 250 % then mass;")
    assert srgc("synth", spec(text), "-o", tmp_path / "out", "--quiet").status == 0
    return tmp_path / "out"


def test_a_cheaper_robot_that_was_found(srgc: Srgc, lighter: Path) -> None:
    assert result_files.read(lighter, "design.json")["word"] == word("Light").split()
    found = explained(srgc, lighter)
    assert found["value"] == KINDS["Light"][1]
    assert [one["word"] for one in found["refuted"]] == [word("Block").split()]
    assert found["found"] == [{"word": word("Heavy").split(), "value": KINDS["Heavy"][1]}]
    assert "Found, but with more of what comes behind:\n  Base e Heavy e Hand, price 10" in (
        srgc("why", lighter).out
    )


def test_undecided_robots_are_named_with_their_reason(srgc: Srgc, priced: Path) -> None:
    """What the folder says of them, whatever that is."""
    design = result_files.read(priced, "design.json")
    (block,) = [one for one in design["structures_tried"] if "Block" in one["word"]]
    block |= {"verdict": "unresolved", "reason": "no motion was found", "boxes": None}
    (priced / "design.json").write_text(json.dumps(design), encoding="utf-8")
    found = explained(srgc, priced)
    assert (found["refuted"], found["conflicts"]) == ([], [])
    (one,) = found["undecided"]
    assert (one["word"], one["value"], one["reason"]) == (
        word("Block").split(), 5, "no motion was found",
    )  # fmt: skip
    ran = srgc("why", priced)
    assert "Nothing below the design is refuted: robots with less price may exist." in ran.out
    assert "  Base e Block e Hand, price 5\n    no motion was found" in ran.out


def test_a_lemma_says_what_it_lacks(srgc: Srgc, made: Callable[[str], Path]) -> None:
    """By hand: 174 is the largest sum below 177, of two servos and two stubs."""
    found = explained(srgc, made("cheapest_arm") / "out")
    (one,) = found["refuted"]
    assert one["value"] == 2 * 48 + 2 * 9 + 60
    (lemma,) = found["lemmas"]
    assert lemma["argument"] == "too far"
    assert [line["kind"] for line in lemma["lines"]] == ["reach"]
    assert found["conflicts"] == []


def test_nothing_is_less_than_the_least_of_a_family(
    srgc: Srgc, spec: Callable[[str], Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    text = priced_slides("minimize mass;")
    assert srgc("synth", spec(text), "-o", out, "--quiet").status == 0
    assert "There is no robot with less mass in the family." in srgc("why", out).out


def test_of_motions_there_is_nothing_to_explain(
    srgc: Srgc, spec: Callable[[str], Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    text = priced_slides("minimize effort;")
    assert srgc("synth", spec(text), "-o", out, "--quiet").status == 0
    said = srgc("why", out).out
    assert "nothing to explain" in said
    (stated,) = json.loads(srgc("why", out, "--json").out)["objectives"]
    assert (stated["objective"], stated["least"]) == ("effort", 0)
    assert f"  effort {100 * stated['value']:.6g} %: nothing is proved of other robots\n" in said


def test_the_design_with_other_parameters(srgc: Srgc, spec: Callable[[str], Path]) -> None:
    """What it has at least is what is proved of all robots, not the ends of its parameters."""
    tube = {"A": "param length in [0.2, 1] m;"}
    text = arms(
        tube, {"a": ("eps A", link("A.length", "1 kg"))},
        "modules <= 4; minimize sum(length);", accept="matches Base eps Joint eps A eps Hand",
    )  # fmt: skip
    folder = spec(text).parent / "tube"
    assert srgc("synth", spec(text), "-o", folder, "--quiet", "--paths", "2").status == 0
    stated = result_files.read(folder, "design.json")["objectives"][0]
    assert 0.4 < stated["least"] <= 0.45 <= stated["value"]
    said = srgc("why", folder).out
    assert "comes behind" not in said
    head, _, robots = said.partition("Found; other parameters may give less:\n")
    assert head.startswith("verdict: found (length 0.4")
    assert head.splitlines()[2].startswith(f"No robot has less length than {stated['least']:.3f}")
    assert robots.startswith(f"  Base eps Joint eps A eps Hand, length {stated['least']:.3f}")
    assert robots.endswith(" m or more\n")


def test_a_refuted_robot_has_its_least_value_or_more(
    srgc: Srgc, spec: Callable[[str], Path]
) -> None:
    """One tube is too short to get 0.45 m away from the base; two of them are not."""
    tube = {"A": "param length in [0.2, 0.4] m;"}
    text = arms(
        tube, {"a": ("eps A", link("A.length", "1 kg"))},
        "modules <= 5; minimize sum(length);", accept="matches Base eps Joint (eps A)+ eps Hand",
    )  # fmt: skip
    folder = spec(text).parent / "tubes"
    assert srgc("synth", spec(text), "-o", folder, "--quiet", "--paths", "2").status == 0
    said = srgc("why", folder).out
    assert "Nearest below the design, and refuted: length 0.2 m or more\n" in said
