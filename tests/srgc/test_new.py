"""Starter files: they check, are canonical, and a robot is found and verified for each.

What their comments say is looked at too: every version that stands after ``// Try:`` is put in the
place of what is above it and checked, and figures in the comments are computed from the file.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from srgc.starters.starter_files import STARTERS, starter
from tests.oracles.some_cases import some
from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
KINDS = ("planar", "branching", "space", "kit")
TRY = re.compile(r"( *)// Try: (.*)\n")
NUMBER = r"(-?[\d.]+)"


def versions(text: str) -> Iterator[tuple[str, str]]:
    """Every statement after ``// Try:``, and the text with it in the place of the one above."""
    lines = text.splitlines(keepends=True)
    for at, line in enumerate(lines):
        tried = TRY.fullmatch(line)
        if tried is None:
            continue
        end = at
        while TRY.fullmatch(lines[end - 1]):
            end -= 1
        begin = end - 1
        while not re.match(rf"{tried[1]}\w", lines[begin]):
            begin -= 1
        yield tried[2], "".join([*lines[:begin], f"{tried[1]}{tried[2]}\n", *lines[end:]])


TRIED = [(kind, new, text) for kind in KINDS for new, text in versions(starter(kind))]


# --- the command --------------------------------------------------------------------------------


def test_without_a_kind_all_are_listed(srgc: Run) -> None:
    ran = srgc("new")
    assert ran.status == 0
    assert [line.split()[0] for line in ran.out.split("\n\n")[0].splitlines()] == [*KINDS]
    assert set(STARTERS) == {path.stem for path in (ROOT / "srgc/starters").glob("*.srg")}


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_is_written_here_and_named_after_its_kind(
    kind: str, srgc: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = srgc("new", kind)
    assert (ran.status, ran.err) == (0, "")
    assert [path.name for path in tmp_path.iterdir()] == [f"{kind}.srg"]
    assert (tmp_path / f"{kind}.srg").read_bytes() == starter(kind).encode()
    assert ran.out.startswith(f"{kind}.srg written")
    assert re.findall(r"^  srgc (\w+)", ran.out, re.MULTILINE) == [
        "check", "synth", "verify", "report",
    ]  # fmt: skip


def test_it_goes_where_it_is_told(srgc: Run, tmp_path: Path) -> None:
    path = tmp_path / "my arm.srg"
    ran = srgc("new", "planar", "-o", path)
    assert path.read_text(encoding="utf-8") == starter("planar")
    assert f"srgc synth '{path}'" in ran.out
    printed = srgc("new", "planar", "-o", "-")
    assert (printed.status, printed.out) == (0, starter("planar"))


def test_what_is_there_stays_there(srgc: Run, tmp_path: Path) -> None:
    path = tmp_path / "arm.srg"
    path.write_text("mine", encoding="utf-8")
    ran = srgc("new", "space", "-o", path)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == f"error: {path} is there already; --force replaces it\n"
    assert path.read_text(encoding="utf-8") == "mine"
    assert srgc("new", "space", "-o", path, "--force").status == 0
    assert path.read_text(encoding="utf-8") == starter("space")


def test_a_link_to_nowhere_is_not_followed(srgc: Run, tmp_path: Path) -> None:
    path, target = tmp_path / "arm.srg", tmp_path / "elsewhere.srg"
    path.symlink_to(target)
    assert srgc("new", "space", "-o", path).status == 2
    assert not target.exists()


@pytest.mark.parametrize("force", [[], ["--force"]])
def test_where_nothing_can_be_written(srgc: Run, tmp_path: Path, force: list[str]) -> None:
    ran = srgc("new", "space", "-o", tmp_path, *force)
    assert (ran.status, ran.err) == (2, f"error: {tmp_path} is a folder; `-o` names a file\n")
    ran = srgc("new", "space", "-o", tmp_path / "none" / "arm.srg", *force)
    assert ran.status == 2
    assert "No such file or directory" in ran.err


def test_unknown_kinds(srgc: Run) -> None:
    ran = srgc("new", "plane")
    assert ran.status == 2
    assert ran.err == (
        "error: there is no starter `plane`: choose planar, branching, space, kit; "
        "did you mean `planar`?\n"
    )
    assert srgc("new", "--force").status == 2
    assert srgc("new", "-o", "arm.srg").status == 2


# --- the files ----------------------------------------------------------------------------------


def codes_of(findings: str) -> set[str]:
    """The codes of findings as JSON; SRG0718 says which bodies may touch."""
    return {finding["code"] for finding in json.loads(findings)}


@pytest.mark.parametrize("kind", some(sorted(KINDS, reverse=True), 1))
def test_a_robot_is_found_and_verified(
    kind: str, srgc: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The commands that `srgc new` prints, one after the other."""
    monkeypatch.chdir(tmp_path)
    steps = re.findall(r"^  srgc (.*?)  ", srgc("new", kind).out, re.MULTILINE)
    check, synth, verify, _report = [step.split() for step in steps]
    checked = srgc(*check, "--json")
    assert (checked.status, codes_of(checked.out)) == (0, {"SRG0718"})
    assert srgc("fmt", "--check", f"{kind}.srg").status == 0
    assert srgc(*synth).status == 0
    assert Path(verify[-1], "design.json").is_file()
    assert srgc(*verify).status == 0


def test_what_is_to_be_tried() -> None:
    """So that the next test says something."""
    assert {kind: sum(k == kind for k, _, _ in TRIED) for kind in KINDS} == {
        "planar": 12, "branching": 8, "space": 10, "kit": 4,
    }  # fmt: skip


@pytest.mark.parametrize("case", TRIED, ids=lambda case: f"{case[0]}: {case[1]}")
def test_what_is_to_be_tried_checks(
    case: tuple[str, str, str], srgc: Run, spec: Callable[[str], Path]
) -> None:
    kind, new, text = case
    old = starter(kind)
    assert text != old
    assert new not in old.replace(f"// Try: {new}", "")
    assert new.split()[0] in [line.split()[0] for line in old.splitlines() if line]
    ran = srgc("check", "--json", spec(text))
    assert (ran.status, codes_of(ran.out)) == (0, {"SRG0718"})


@pytest.mark.parametrize("kind", KINDS)
def test_comments_name_what_is_there(kind: str) -> None:
    text = starter(kind)
    assert f"`srgc new {kind}` wrote this file" in text
    code = re.sub(r"//.*", "", text)
    known = {*re.findall(r"\w+", code), "srgc", "new", "Try", *STARTERS, "words", "language"}
    known |= {"srg", "expand"}
    quoted = [
        q for comment in re.findall(r"//(.*)", text) for q in re.findall(r"`([^`]+)`", comment)
    ]
    assert quoted
    assert [
        word for q in quoted for word in re.findall(r"[A-Za-z]\w*", q) if word not in known
    ] == [*(["xyz"] if kind == "planar" else [])]


def first_word(srgc: Run, spec: Callable[[str], Path], kind: str) -> str:
    return srgc("words", spec(starter(kind)), "--limit", 1).out.strip()


def test_the_words_in_the_comments_are_the_shortest(srgc: Run, spec: Callable[[str], Path]) -> None:
    assert f"`{first_word(srgc, spec, 'planar')}`" in starter("planar")
    assert f"//   {first_word(srgc, spec, 'branching')}\n" in starter("branching")
    assert "right-linear" in srgc("language", spec(starter("space"))).out


def box(text: str, name: str) -> list[tuple[float, float]]:
    [line] = re.findall(rf"^  \w+ {name} box (.*) m;", text, re.MULTILINE)
    return [(float(a), float(b)) for a, b in re.findall(rf"\[{NUMBER}, {NUMBER}\]", line)]


def test_one_link_does_not_reach_from_a_shoulder() -> None:
    """As `branching` says of Jig and Scale: the nearest point of the box is farther."""
    text = starter("branching")
    [longest] = re.findall(rf"^module Link .* in \[{NUMBER}, {NUMBER}\] m", text, re.MULTILINE)
    [width] = re.findall(rf"const width = {NUMBER} m", text)[:1]
    for name, side in (("Jig", 1), ("Scale", -1)):
        (left, right), (low, high) = box(text, name)
        x, y = 0.0, side * float(width) / 2
        nearest = (min(max(x, left), right), min(max(y, low), high))
        assert math.dist((x, y), nearest) > float(longest[1])


def test_the_horizon_in_the_comment() -> None:
    [(steps, step, whole)] = re.findall(
        rf"^  horizon (\d+) steps of {NUMBER} s;  // {NUMBER} s in all",
        starter("planar"),
        re.MULTILINE,
    )
    assert int(steps) * float(step) == float(whole)
