"""The pages tell the truth: their specs check, their commands run, what they name exists."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from collections.abc import Callable, Collection
from pathlib import Path
from xml.etree import ElementTree

import click
import pytest
import yaml

import srgc.cli
from grammar_lang.load import load_text
from srgc.cli.command_table import command_named
from tests.conftest import SPECS
from tests.oracles import pages
from tests.oracles.page_session import NUMBER, Session
from tests.oracles.some_cases import some

ROOT = Path(__file__).parents[1]
RUN_ELSEWHERE = (
    "docs/reference/codes.md",  # its examples are to fail: tests/test_golden.py runs them
    "docs/reference/language.md",  # tests/test_language_reference.py
)
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("benchmarks/*.md")])
DECISIONS = sorted(ROOT.glob("docs/decisions/[0-9]*.md"))
TEXTS = {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in PAGES}
RUN = [
    page
    for page, text in TEXTS.items()
    if page != RUN_ELSEWHERE[0]
    and {"console", "python"} & {block.kind for block in pages.blocks(text)}
]
LONG = {
    "docs/tutorial.md": ("why out/short",),
    "docs/how-to/export.md": (
        "synth specs/robust_arm.srg -o out/robust -q",
        "replay out/robust --in mujoco --disturbed 20 --seed 1 --timestep 0.001",
    ),
    "docs/how-to/timor.md": ("synth sort.srg -o out/sort -q", "verify out/sort -q"),
    "docs/how-to/objectives.md": ("synth specs/cheapest_arm.srg --pareto -o out/front",),
}
"""What a page shows and only the slow suite runs."""
WITHOUT_THE_FIRST_PAGE = ("README.md", "docs/reference/language.md")


def blocks(kind: str) -> list[tuple[str, str]]:
    """The page and the content of every block of a kind, but for files."""
    return [
        (page, block.body)
        for page, text in TEXTS.items()
        if page != "docs/reference/codes.md"
        for block in pages.blocks(text)
        if block.kind == kind and not block.name
    ]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the specs, and the working directory of the test."""
    shutil.copytree(ROOT / "specs", tmp_path / "specs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_examples_check(tmp_path: Path) -> None:
    for page, content in blocks("srg"):
        if page not in RUN_ELSEWHERE:
            file = tmp_path / "example.srg"
            file.write_text(content, encoding="utf-8")
            assert srgc.cli.run(["check", str(file)]) == 0, page


@pytest.mark.parametrize("page", RUN)
def test_pages_run_as_shown(
    page: str,
    checkout: Path,
    made: Callable[[str], Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    if page not in WITHOUT_THE_FIRST_PAGE:
        for name, body in pages.files(TEXTS["README.md"]).items():
            (checkout / name).write_text(body, encoding="utf-8")
    follow(page, checkout, made, capsys, [each for some in LONG.values() for each in some])
    if page == "README.md":
        drawn = checkout / "fetch.svg"
        assert srgc.cli.run(["export", "out/fetch", "--to", "svg", "-o", str(drawn)]) == 0
        assert_alike(drawn, ROOT / "docs" / "pictures" / "fetch.svg")


def follow(
    page: str,
    checkout: Path,
    made: Callable[[str], Path],
    capsys: pytest.CaptureFixture[str],
    left_out: Collection[str] = (),
) -> None:
    def printed() -> str:
        return capsys.readouterr().out

    Session(TEXTS[page], checkout, srgc.cli.run, printed, made, SPECS, left_out).follow()


@pytest.mark.slow
@pytest.mark.parametrize("page", LONG)
def test_pages_run_with_their_longest_commands(
    page: str, checkout: Path, made: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    assert all(f"$ srgc {command}\n" in TEXTS[page] for command in LONG[page])
    for name, body in pages.files(TEXTS["README.md"]).items():
        (checkout / name).write_text(body, encoding="utf-8")
    follow(page, checkout, made, capsys)


def assert_alike(drawn: Path, kept: Path) -> None:
    """One picture, but for the last digits of a search: within half a unit everywhere."""
    ours, theirs = (list(ElementTree.parse(file).iter()) for file in (drawn, kept))
    assert [node.tag for node in ours] == [node.tag for node in theirs]
    for our, their in zip(ours, theirs, strict=True):
        assert our.keys() == their.keys()
        a, b = (NUMBER.findall(" ".join(node.attrib.values())) for node in (our, their))
        assert [float(x) for x in a] == pytest.approx([float(x) for x in b], abs=0.5)


def proposals() -> list[str]:
    """The changes that the tutorial proposes at its end."""
    section = TEXTS["docs/tutorial.md"].partition("## A robot of your own")[2]
    return [part for part in section.split("\n- ")[1:] if re.search(r"`[^`]+;`", part)]


@pytest.mark.parametrize("proposal", proposals(), ids=lambda part: part[:20])
def test_what_the_tutorial_proposes_checks_without_warnings(
    proposal: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert srgc.cli.run(["new", "planar"]) == 0
    text = Path("planar.srg").read_text(encoding="utf-8")
    for line in re.findall(r"`([^`]+;)`", proposal):
        word = line.split()[0]
        if word in {"accept", "avoid"}:
            replaced = "avoid Bar" if word == "avoid" else word
            text, count = re.subn(rf"(?m)^  {replaced} .*;", f"  {line}", text)
        else:
            before = "target Shelf" if word == "obstacle" else "effort <= 10"
            text, count = re.subn(rf"(?m)^  (?={before})", f"  {line}\n  ", text)
        assert count == 1, line
    assert [
        d.message for d in load_text(text, "p.srg").diagnostics if d.severity.value != "note"
    ] == []


def test_the_first_page_is_short() -> None:
    text = TEXTS["README.md"]
    assert text.count("\n") < 100
    [file] = pages.files(text).values()
    assert len([line for line in file.splitlines() if line]) <= 24
    pictures = [*(ROOT / "docs" / "pictures").iterdir()]
    assert all(picture.stat().st_size < 100_000 for picture in pictures)


@pytest.mark.parametrize(("page", "content"), blocks("sh"), ids=lambda part: part[:30])
def test_lines_for_a_shell_have_options_that_there_are(page: str, content: str) -> None:
    for line in content.splitlines():
        program, *arguments = shlex.split(line, comments=True) or [""]
        if program == "srgc":
            command = command_named(arguments[0])
            context = click.Context(command)
            command.make_parser(context).parse_args(arguments[1:])


def test_data_are_what_they_seem() -> None:
    for _, content in blocks("yaml"):
        assert yaml.safe_load(content)
    for _, content in blocks("json"):
        assert json.loads(content)


def keys(content: object) -> set[str]:
    """All keys of a JSON value, but those of ``cells``, which are names."""
    if isinstance(content, dict):
        below = [keys(value) for key, value in content.items() if key != "cells"]
        return set(content).union(*below)
    return set().union(*map(keys, content)) if isinstance(content, list) else set()


HEADS = {"slider": "t,q1,qd1,u1,e1_x,e1_y", "motor": "t,q1,qd1,s1,u1,e1_x,e1_y"}


@pytest.mark.parametrize("spec", [*HEADS, "beyond_reach"])
def test_the_fields_of_results_are_described(made: Callable[[str], Path], spec: str) -> None:
    page = TEXTS["docs/reference/results.md"]
    words = set(re.findall(r"`([\w.]+)`", page)) | {"structures", "evaluations", "paths"}
    folder = made(spec) / "out"
    for file in ("design.json", "certificate.json", "log.json"):
        content = json.loads((folder / file).read_text(encoding="utf-8"))
        assert keys(content) <= words, file
    described = {"spec", "proofs", "figures", "design.json", "certificate.json", "trajectory.csv"}
    assert {path.name for path in folder.iterdir()} <= described | {
        "log.json",
        "evaluations.csv",
        "nearest.csv",
    }
    if spec in HEADS:
        head = (folder / "trajectory.csv").read_text(encoding="utf-8").splitlines()[0]
        assert head == HEADS[spec]
        assert all(re.search(rf"`{column}`", page) for column in head.split(","))


@pytest.mark.parametrize("name", some(["retune", "both", "before"], 2))
def test_the_fields_of_missions_are_described(made: Callable[[str], Path], name: str) -> None:
    page = TEXTS["docs/reference/results.md"]
    counts = {"robots", "examined", "refutations", "motion searches"}
    words = set(re.findall(r"`([\w.]+)`", page)) | counts
    folder = made(f"mission_{name}") / "out"
    for file in ("design.json", "mission.json"):
        content = json.loads((folder / file).read_text(encoding="utf-8"))
        assert keys(content) <= words, file
    known = {"spec", "proofs", "tasks", "design.json", "mission.json", "log.json"}
    assert {path.name for path in folder.iterdir()} <= known


def test_the_rules_of_figure_1_are_shown_as_they_are() -> None:
    spec = (ROOT / "specs" / "l_shaped.srg").read_text(encoding="utf-8")
    [shown] = [body for _, body in blocks("text") if body.startswith("module LL")]
    for part in shown.split("\n\n"):
        assert part in spec


def test_of_a_length_of_zero_is_said_what_is_shown(
    checkout: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "`param length in [0, 1] m`, the robot above" in TEXTS["docs/reference/models.md"]
    [shown] = [body for _, body in blocks("text") if body.startswith("not positive definite")]
    file = checkout / "specs" / "motor_arm.srg"
    text = file.read_text(encoding="utf-8")
    changed = text.replace("length in [0.4, 1] m", "length in [0, 1] m")
    assert changed != text
    file.write_text(changed, encoding="utf-8")
    assert srgc.cli.run(["model", str(file), "--word", "B eps M eps L eps EN"]) == 0
    assert f"\n{shown}" in capsys.readouterr().out


def test_recorded_benchmarks_are_those_that_there_are() -> None:
    for file in sorted((ROOT / "benchmarks" / "results").glob("*.json")):
        record = json.loads(file.read_text(encoding="utf-8"))
        python, script, *_ = record["command"].split()
        assert python == "python"
        assert (ROOT / script).is_file(), file.name
        assert record["output"]
        assert str(ROOT) not in file.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("page", "benchmark"),
    [("docs/explanation/lemmas.md", "lemmas"), ("docs/how-to/solvers.md", "smt_agreement")],
)
def test_tables_on_pages_are_those_that_were_recorded(page: str, benchmark: str) -> None:
    file = ROOT / "benchmarks" / "results" / f"{benchmark}.json"
    output = json.loads(file.read_text(encoding="utf-8"))["output"]
    for table in "\n".join(output).strip().split("\n\n")[:2]:
        assert f"\n{table}\n" in TEXTS[page]


def test_targets_named_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    named = {
        target
        for text in TEXTS.values()
        for target in re.findall(r"(?:`|^)make ([\w-]+)", text, re.MULTILINE)
    }
    assert named <= targets
    assert {"demo", "test"} <= named


LINK = re.compile(r"(?:\]\(|^\[[^\]]+\]: )(?!https?://)([^)\s]+)", re.MULTILINE)


@pytest.mark.parametrize("page", TEXTS)
def test_links_lead_somewhere(page: str) -> None:
    """To a file, and where they have a fragment, to a heading in it."""
    for link in LINK.findall(pages.prose(TEXTS[page])):
        path, _, fragment = link.partition("#")
        target = (ROOT / page).parent / path if path else ROOT / page
        assert target.exists(), link
        if fragment:
            assert fragment in pages.anchors(whole(target)), link


def whole(page: Path) -> str:
    """A page with what it includes."""
    return re.sub(
        r"^```\{include\} (\S+)$",
        lambda found: (page.parent / found[1]).read_text(encoding="utf-8"),
        page.read_text(encoding="utf-8"),
        flags=re.MULTILINE,
    )


def test_what_one_must_trust_is_one_screen() -> None:
    lines = TEXTS["docs/explanation/trust.md"].splitlines()
    assert len(lines) <= 45
    assert max(map(len, lines)) <= 125


def test_files_named_exist() -> None:
    pattern = re.compile(r"`((?:grammar_lang|compiler|solvers|srgc|tests|specs)/[\w/.]+\.\w+)")
    for page, text in TEXTS.items():
        for file in pattern.findall(text):
            assert (ROOT / file).is_file(), (page, file)


@pytest.mark.parametrize("file", DECISIONS, ids=lambda file: file.stem)
def test_decisions_have_their_four_parts(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert re.findall(r"^## (.+)$", text, re.MULTILINE) == [
        "Context", "Options", "Choice", "Consequence",
    ]  # fmt: skip
    number, _, _ = file.stem.partition("-")
    assert int(number) == DECISIONS.index(file) + 1
    assert text.startswith(f"# {int(number)}. ")
    assert text.count("\n") < 60
