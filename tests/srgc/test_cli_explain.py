from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from grammar_lang.diagnostics.code_pages import page_text
from grammar_lang.diagnostics.diagnostic import Code

ROOT = Path(__file__).parents[2]
HEAVY = {
    "casadi", "clarabel", "cvxpy", "flint", "networkx", "pysat", "pysmt", "scipy",
    "sklearn", "z3",
}  # fmt: skip


@pytest.mark.parametrize("text", ["SRG0301", "srg0301", "0301", "301"])
def test_a_page_is_printed(srgc, text):
    ran = srgc("explain", text)
    assert (ran.status, ran.out, ran.err) == (0, page_text(Code.UNIT_MISMATCH), "")
    assert ran.out.startswith("# SRG0301: ")
    for part in ("\nFails:\n", "\n```srg\n", "error[SRG0301]", "\nRepaired:\n"):
        assert part in ran.out


def test_several_pages_in_the_order_given(srgc):
    ran = srgc("explain", "0504", "SRG0201")
    assert ran.status == 0
    wanted = f"{page_text(Code.CIRCULAR_ATTRIBUTES)}\n{page_text(Code.UNKNOWN_NAME)}"
    assert ran.out == wanted


def test_the_list_of_all_codes(srgc):
    ran = srgc("explain")
    assert (ran.status, ran.err) == (0, "")
    lines = ran.out.splitlines()
    assert [line[:7] for line in lines] == [code.value for code in Code]
    assert "SRG0301  a value with the wrong unit" in lines
    assert all(line[7:9] == "  " and line[9:].strip() for line in lines)


@pytest.mark.parametrize(
    ("text", "near"),
    [
        ("SRG0399", "SRG0311, SRG0310, SRG0309"),
        ("200", "SRG0201, SRG0202, SRG0203"),
        ("9999", "SRG0804, SRG0803, SRG0802"),
        ("SRGO301", "SRG0301"),
        ("SRG03011", "SRG0301"),
    ],
)
def test_an_unknown_code_is_a_usage_error(srgc, text, near):
    ran = srgc("explain", "SRG0301", text)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.startswith("error: ")
    assert ran.err.count("\n") == 1
    assert text in ran.err
    assert near in ran.err


@pytest.mark.parametrize("text", ["", "units", "\N{ARABIC-INDIC DIGIT THREE}01", "a\nb\x1b[31m"])
def test_what_is_like_no_code_is_a_usage_error(srgc, text):
    ran = srgc("explain", text)
    assert (ran.status, ran.out) == (2, "")
    assert "`srgc explain` lists all codes" in ran.err
    assert ran.err.count("\n") == 1
    assert "\x1b" not in ran.err


def test_a_code_without_a_page_is_no_fault(srgc, monkeypatch, tmp_path):
    monkeypatch.setattr("grammar_lang.diagnostics.code_pages.FOLDER", tmp_path)
    ran = srgc("explain", "SRG0301")
    assert (ran.status, ran.err) == (0, "")
    assert ran.out == "# SRG0301: unit mismatch\n\nThis code has no page yet.\n"
    assert "SRG0301  unit mismatch\n" in srgc("explain").out


def test_headings_are_bold_on_a_terminal_only(srgc, monkeypatch):
    assert "\x1b" not in srgc("explain", "301").out
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.delenv("NO_COLOR", raising=False)
    from srgc.text_reports.findings_text import explanation

    out = explanation(["301"], colour=True)
    assert out.startswith("\x1b[1m# SRG0301: a value with the wrong unit\x1b[0m\n")
    assert out.count("\x1b[1m") == 3


def loaded_by(program):
    """The packages that a fresh interpreter has loaded after running a program."""
    program += "\nimport json, sys; print(json.dumps(sorted(sys.modules)), file=sys.stderr)"
    finished = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT, capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    return {name.partition(".")[0] for name in json.loads(finished.stderr.splitlines()[-1])}


def test_explain_loads_nothing_heavy():
    program = "from srgc.cli import run\nrun(['explain'])\nrun(['explain', '301', 'x'])"
    assert not loaded_by(program) & HEAVY


def test_the_catalogue_is_read_without_the_compiler():
    program = "from grammar_lang.diagnostics.code_pages import catalogue\ncatalogue()"
    assert not loaded_by(program) & {*HEAVY, "numpy", "lark", "click", "rich", "compiler", "srgc"}
