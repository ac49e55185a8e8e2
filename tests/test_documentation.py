"""The pages tell the truth: their specs check, their commands run, what they name exists."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import srgc.cli
from tests.oracles import pages

ROOT = Path(__file__).parents[1]
RUN_ELSEWHERE = (
    "docs/codes.md",  # its examples are to fail: tests/test_golden.py runs them
    "docs/language.md",  # tests/test_language_reference.py
)
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("benchmarks/*.md")])
DECISIONS = sorted(ROOT.glob("docs/decisions/*.md"))
TEXTS = {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in PAGES}
DECIMAL = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
LONG = ("synth", "verify", "landscape")


def blocks(kind: str) -> list[tuple[str, str]]:
    """The page and the content of every block of a kind, but for files."""
    return [
        (page, block.body)
        for page, text in TEXTS.items()
        if page != "docs/codes.md"
        for block in pages.blocks(text)
        if block.kind == kind and not block.name
    ]


def commands() -> list[tuple[str, list[str], int, str]]:
    """The page, the arguments, the status and the output shown of every ``$ srgc`` line."""
    found = []
    for page, content in blocks("console"):
        for part in re.split(r"^\$ ", content, flags=re.MULTILINE)[1:]:
            line, _, output = part.partition("\n")
            exits = re.search(r"# exits (\d+)$", line)
            program, *arguments = shlex.split(line, comments=True)
            assert program == "srgc", line
            found.append((page, arguments, int(exits[1]) if exits else 0, output))
    return found


QUICK = [command for command in commands() if command[1][0] not in LONG]
SLOW = [command for command in commands() if command[1][0] in LONG]


def name(value: object) -> str | None:
    return " ".join(map(str, value)) if isinstance(value, list) else None


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


@pytest.mark.parametrize(("page", "arguments", "status", "output"), QUICK, ids=name)
def test_commands_print_what_is_shown(
    page: str,
    arguments: list[str],
    status: int,
    output: str,
    checkout: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for file, content in pages.files(TEXTS[page]).items():
        (checkout / file).parent.mkdir(parents=True, exist_ok=True)
        (checkout / file).write_text(content, encoding="utf-8")
    assert srgc.cli.run(arguments) == status, page
    assert capsys.readouterr().out == output
    if "-o" in arguments:
        assert (checkout / arguments[arguments.index("-o") + 1]).is_file()


def shape(output: str) -> list[str]:
    """The lines of an output without its measured numbers, whose order depends on them."""
    lines = (re.sub(r"\s+", " ", DECIMAL.sub("#", line)) for line in output.splitlines())
    return sorted(re.sub(r"margin \S+", "margin #", line) for line in lines)


@pytest.mark.slow
def test_the_tour_ends_as_shown(
    made: Callable[[str], Path], checkout: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tour = [command for command in SLOW if command[0] == "README.md"]
    (_, synth, _, synth_output), (_, verify, _, verify_output) = tour
    folder = synth[synth.index("-o") + 1]
    assert synth[:2] == ["synth", "specs/planar_arm.srg"]
    assert verify == ["verify", folder]
    done = made("planar_arm")
    printed = (done / "stdout").read_text(encoding="utf-8").replace("out\n", f"{folder}\n")
    assert shape(printed) == shape(synth_output)
    shutil.copytree(done / "out", checkout / folder)
    assert srgc.cli.run(verify) == 0
    assert shape(capsys.readouterr().out) == shape(verify_output)


def test_all_designs_and_a_landscape_end_as_shown(
    checkout: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = "docs/designs.md"
    for file, content in pages.files(TEXTS[page]).items():
        (checkout / file).write_text(content, encoding="utf-8")
    shown = [command for command in SLOW if command[0] == page]
    assert [arguments[0] for _, arguments, _, _ in shown] == ["synth", "landscape"]
    for _, arguments, status, output in shown:
        assert srgc.cli.run(arguments) == status
        assert shape(capsys.readouterr().out) == shape(output)
    assert {command[0] for command in SLOW} == {page, "README.md"}


def keys(content: object) -> set[str]:
    """All keys of a JSON value, but those of ``cells``, which are names."""
    if isinstance(content, dict):
        below = [keys(value) for key, value in content.items() if key != "cells"]
        return set(content).union(*below)
    return set().union(*map(keys, content)) if isinstance(content, list) else set()


HEADS = {"slider": "t,q1,qd1,u1,e1_x,e1_y", "motor": "t,q1,qd1,s1,u1,e1_x,e1_y"}


@pytest.mark.parametrize("spec", [*HEADS, "beyond_reach"])
def test_the_fields_of_results_are_described(made: Callable[[str], Path], spec: str) -> None:
    page = TEXTS["docs/results.md"]
    words = set(re.findall(r"`([\w.]+)`", page)) | {"structures", "evaluations", "paths"}
    folder = made(spec) / "out"
    for file in ("design.json", "certificate.json", "log.json"):
        content = json.loads((folder / file).read_text(encoding="utf-8"))
        assert keys(content) <= words, file
    described = {"spec", "proofs", "figures", "design.json", "certificate.json", "trajectory.csv"}
    assert {path.name for path in folder.iterdir()} <= described | {"log.json", "evaluations.csv"}
    if spec in HEADS:
        head = (folder / "trajectory.csv").read_text(encoding="utf-8").splitlines()[0]
        assert head == HEADS[spec]
        assert all(re.search(rf"`{column}`", page) for column in head.split(","))


def test_the_rules_of_figure_1_are_shown_as_they_are() -> None:
    spec = (ROOT / "specs" / "l_shaped.srg").read_text(encoding="utf-8")
    [shown] = [body for _, body in blocks("text") if body.startswith("module LL")]
    for part in shown.split("\n\n"):
        assert part in spec


def test_of_a_length_of_zero_is_said_what_is_shown(
    checkout: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "`param length in [0, 1] m`, the robot above" in TEXTS["docs/models.md"]
    [shown] = [body for _, body in blocks("text") if body.startswith("not positive definite")]
    file = checkout / "specs" / "motor_arm.srg"
    text = file.read_text(encoding="utf-8")
    changed = text.replace("length in [0.4, 1] m", "length in [0, 1] m")
    assert changed != text
    file.write_text(changed, encoding="utf-8")
    assert srgc.cli.run(["model", str(file), "--word", "B eps M eps L eps EN"]) == 0
    assert f"\n{shown}" in capsys.readouterr().out


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
            assert fragment in pages.anchors(target.read_text(encoding="utf-8")), link


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
