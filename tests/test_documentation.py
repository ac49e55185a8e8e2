"""The pages tell the truth: their specs check, their commands run, what they name exists."""

from __future__ import annotations

import ast
import json
import re
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import srgc.cli
from grammar_lang.code_pages import examples

ROOT = Path(__file__).parents[1]
RUN_ELSEWHERE = ("docs/codes.md",)  # its examples are to fail: tests/test_golden.py runs them
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("benchmarks/*.md")])
DECISIONS = sorted(ROOT.glob("docs/decisions/*.md"))
TEXTS = {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in PAGES}
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
DECIMAL = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
LONG = ("synth", "verify")


def blocks(kind: str) -> list[tuple[str, str]]:
    """The page and the content of every block of a kind."""
    return [
        (page, content)
        for page, text in TEXTS.items()
        for found, content in FENCE.findall(text)
        if found == kind and page not in RUN_ELSEWHERE
    ]


def commands() -> list[tuple[str, list[str], str]]:
    """The page, the arguments and the output shown of every ``$ srgc`` line."""
    found = []
    for page, content in blocks("console"):
        for part in re.split(r"^\$ ", content, flags=re.MULTILINE)[1:]:
            line, _, output = part.partition("\n")
            program, *arguments = shlex.split(line)
            assert program == "srgc", line
            found.append((page, arguments, output))
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


@pytest.mark.parametrize(("page", "content"), blocks("srg"))
def test_examples_check(page: str, content: str, tmp_path: Path) -> None:
    file = tmp_path / "example.srg"
    file.write_text(content, encoding="utf-8")
    assert srgc.cli.run(["check", str(file)]) == 0, page


def test_examples_of_several_files_check(tmp_path: Path) -> None:
    number = 0
    for page in TEXTS.keys() - RUN_ELSEWHERE:
        for example in examples(TEXTS[page]):
            if len(example.files) == 1 or example.expected is not None:
                continue
            number += 1
            for name, content in example.files:
                file = tmp_path / str(number) / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(content, encoding="utf-8")
            checked = tmp_path / str(number) / example.checked
            assert srgc.cli.run(["check", str(checked)]) == 0, page
    assert number > 0


def test_the_language_page_has_an_example_of_every_part() -> None:
    text = "".join(content for page, content in blocks("srg") if page == "docs/language.md")
    for keyword in ("module", "edge", "grammar", "semantics", "workspace", "task", "hull", "space"):
        assert re.search(rf"^\s*(region \w+ )?{keyword}\b", text, re.MULTILINE), keyword


def test_what_is_said_not_to_be_supported_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each clause, in the language's first complete example: read by check, refused by synth."""
    monkeypatch.chdir(tmp_path)
    page = TEXTS["docs/language.md"]
    complete = next(c for p, c in blocks("srg") if p == "docs/language.md" and "\ntask " in c)
    listed = next(c for p, c in blocks("text") if p == "docs/language.md")
    statements = [part.strip() for part in re.sub(r"\s{3,}.*", "", listed).split("\n")]
    clauses = [f"{clause.strip()};" for line in statements for clause in line.split(";") if clause]
    assert len(clauses) == 4
    place = "task Turn {\n"
    assert place in complete
    for clause in clauses:
        keyword = clause.split("(")[0].split()[0]
        assert f"`{keyword}" in TEXTS["README.md"] or f"{keyword}`" in TEXTS["README.md"], clause
        file = tmp_path / "example.srg"
        file.write_text(complete.replace(place, f"{place} {clause}", 1), encoding="utf-8")
        assert srgc.cli.run(["check", str(file)]) == 0, clause
        capsys.readouterr()
        assert srgc.cli.run(["synth", str(file)]) == 5, clause
        assert f"error[SRG0190]: `{keyword}" in capsys.readouterr().err
    assert "SRG0190" in page


@pytest.mark.parametrize(("page", "arguments", "output"), QUICK, ids=name)
def test_commands_print_what_is_shown(
    page: str,
    arguments: list[str],
    output: str,
    checkout: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert srgc.cli.run(arguments) == 0, page
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
    (_, synth, synth_output), (_, verify, verify_output) = SLOW
    folder = synth[synth.index("-o") + 1]
    assert synth[:2] == ["synth", "specs/planar_arm.srg"]
    assert verify == ["verify", folder]
    done = made("planar_arm")
    printed = (done / "stdout").read_text(encoding="utf-8").replace("out\n", f"{folder}\n")
    assert shape(printed) == shape(synth_output)
    shutil.copytree(done / "out", checkout / folder)
    assert srgc.cli.run(verify) == 0
    assert shape(capsys.readouterr().out) == shape(verify_output)


def keys(content: object) -> set[str]:
    """All keys of a JSON value, but those of ``cells``, which are names."""
    if isinstance(content, dict):
        below = [keys(value) for key, value in content.items() if key != "cells"]
        return set(content).union(*below)
    return set().union(*map(keys, content)) if isinstance(content, list) else set()


@pytest.mark.parametrize("spec", ["slider", "beyond_reach"])
def test_the_fields_of_results_are_described(made: Callable[[str], Path], spec: str) -> None:
    page = TEXTS["docs/results.md"]
    words = set(re.findall(r"`([\w.]+)`", page)) | {"structures", "evaluations", "paths"}
    folder = made(spec) / "out"
    for file in ("design.json", "certificate.json", "log.json"):
        content = json.loads((folder / file).read_text(encoding="utf-8"))
        assert keys(content) <= words, file
    described = {"spec", "proofs", "figures", "design.json", "certificate.json", "trajectory.csv"}
    assert {path.name for path in folder.iterdir()} <= described | {"log.json"}
    if spec == "slider":
        head = (folder / "trajectory.csv").read_text(encoding="utf-8").splitlines()[0]
        assert head == "t,q1,qd1,u1,e1_x,e1_y"
        assert all(re.search(rf"`{column}`", page) for column in head.split(","))


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


def test_links_lead_somewhere() -> None:
    for page, text in TEXTS.items():
        for link in re.findall(r"\]\((?!https?://|#)([^)#]+)", text):
            assert (ROOT / page).parent.joinpath(link).exists(), (page, link)


def test_files_named_exist() -> None:
    pattern = re.compile(r"`((?:grammar_lang|compiler|solvers|srgc|tests|specs)/[\w/.]+\.\w+)")
    for page, text in TEXTS.items():
        for file in pattern.findall(text):
            assert (ROOT / file).is_file(), (page, file)


def test_every_difference_is_shown_by_tests() -> None:
    page = TEXTS["docs/differences-from-the-paper.md"]
    rows = [line for line in page.splitlines() if re.match(r"\| 4\.\d", line)]
    assert rows
    for row in rows:
        named = re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", row)
        assert named, row
        for file, test in named:
            tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
            functions = {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}
            assert test in functions, (file, test)


def test_corrections_named_in_the_code_are_listed() -> None:
    page = TEXTS["docs/differences-from-the-paper.md"]
    for package in ("grammar_lang", "compiler", "solvers", "srgc"):
        for file in sorted((ROOT / package).glob("*.py")):
            for row in re.findall(r"correction (4\.\d+)", file.read_text(encoding="utf-8")):
                assert re.search(rf"\b{re.escape(row)}\b", page), (file.name, row)


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
