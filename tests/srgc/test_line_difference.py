"""The diff is applied again, by a small reader of the format and by `patch` where there is one."""

from __future__ import annotations

import difflib
import random
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from srgc.formatting.canonical_form import unified

HUNK = re.compile(r"@@ -(\d+)(?:,(\d+))? \+(\d+)(?:,(\d+))? @@\n")
NO_END = "\\ No newline at end of file\n"


def applied(before: str, diff: str) -> str:
    """The text that a unified diff makes of another; every number and line in it is compared."""
    lines = re.findall(r"[^\n]*\n|[^\n]+", before)
    parts = re.findall(r"[^\n]*\n", diff)
    if not parts:
        return before
    assert [part[:4] for part in parts[:2]] == ["--- ", "+++ "]
    made: list[str] = []
    here = 0
    position = 2
    while position < len(parts):
        match = HUNK.fullmatch(parts[position])
        assert match is not None, parts[position]
        start, size, other, other_size = (1 if n is None else int(n) for n in match.groups())
        start, other = start - (size > 0), other - (other_size > 0)
        made += lines[here:start]
        assert len(made) == other
        here = start
        position += 1
        while size > 0 or other_size > 0:
            kind, line = parts[position][0], parts[position][1:]
            position += 1
            if position < len(parts) and parts[position] == NO_END:
                line, position = line[:-1], position + 1
            if kind in " -":
                assert lines[here] == line
                here, size = here + 1, size - 1
            if kind in " +":
                made.append(line)
                other_size -= 1
        assert (size, other_size) == (0, 0)
    return "".join(made + lines[here:])


def reblanked(choose: random.Random, words: list[str]) -> str:
    return "".join(choose.choice(["", " ", "\n", "\n", "\n\n"]) + word for word in words)


@given(st.integers(0, 2**32))
def test_what_is_printed_leads_from_one_text_to_the_other(seed: int) -> None:
    choose = random.Random(seed)
    words = [f"w{i};" for i in range(choose.randrange(40))]
    before = reblanked(choose, words) + choose.choice(["", "\n", "\n\n"])
    after = before if choose.random() < 0.1 else reblanked(choose, words) + "\n"
    diff = unified(before, after, "a.srg")
    assert applied(before, diff) == after
    assert (diff == "") == (before == after)


@given(st.integers(0, 2**32))
def test_few_changes_make_a_diff_like_that_of_difflib(seed: int) -> None:
    choose = random.Random(seed)
    lines = [f"line {i}\n" for i in range(60)]
    other = [line.replace(" ", choose.choice([" "] * 20 + ["  "])) for line in lines]
    wanted = "".join(difflib.unified_diff(lines, other, "a", "a", lineterm="\n"))
    assert unified("".join(lines), "".join(other), "a") == wanted.replace("a\t\n", "a\n")


def test_patch_agrees(tmp_path: Path) -> None:
    patch = shutil.which("patch")
    if patch is None:
        pytest.skip("patch is not installed")
    choose = random.Random(1)
    words = [f"w{i};" for i in range(100)]
    before, after = reblanked(choose, words), reblanked(choose, words) + "\n"
    file = tmp_path / "a.srg"
    file.write_text(before, encoding="utf-8")
    diff = unified(before, after, "a.srg")
    subprocess.run([patch, "-p0"], cwd=tmp_path, input=diff.encode(), check=True)
    assert file.read_text(encoding="utf-8") == after


def test_a_small_diff_by_hand() -> None:
    before = "a;\nb;\nc;\nd;\n  e;\nf; g;\nh;"
    wanted = """\
--- x.srg
+++ x.srg
@@ -2,6 +2,7 @@
 b;
 c;
 d;
-  e;
-f; g;
-h;
\\ No newline at end of file
+e;
+f;
+g;
+h;
"""
    assert unified(before, "a;\nb;\nc;\nd;\ne;\nf;\ng;\nh;\n", "x.srg") == wanted


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", ""),
        ("\n\n", ""),
        ("a;", "a;\n"),
        ("\ufeffa;\n", "a;\n"),
        ("a;\r\nb;\r\n", "a;\nb;\n"),
        ("a;\x0cb;\x85\u2028c;\n", "a;\nb;\x85\u2028c;\n"),
        ("\n\n\na;\n", "a;\n"),
        ("a;\n\n\n\n", "a;\n"),
        ("a; b;\n", "a;\nb;\n"),
    ],
)
def test_ends_and_blank_lines(before: str, after: str) -> None:
    assert applied(before, unified(before, after, "a")) == after


def test_colours_are_around_whole_lines() -> None:
    plain = unified("a;\n b;\nc;", "a;\nb;\nc;\n", "x")
    painted = unified("a;\n b;\nc;", "a;\nb;\nc;\n", "x", colour=True)
    assert re.sub(r"\x1b\[\d*m", "", painted) == plain
    assert "\x1b[31m- b;\x1b[0m\n" in painted
    assert "\x1b[32m+b;\x1b[0m\n" in painted
    assert painted.startswith("\x1b[1m--- x\x1b[0m\n")


@pytest.mark.slow
def test_linear_time() -> None:
    """A search for a longest common subsequence would take minutes on so many equal lines."""
    before = "a; \n\n}\nb;\n" * 30_000
    begin = time.process_time()
    assert applied(before, unified(before, before.replace(" \n", "\n"), "a")) == (
        "a;\n\n}\nb;\n" * 30_000
    )
    assert time.process_time() - begin < 20
