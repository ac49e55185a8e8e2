from __future__ import annotations

import json
import os

import pytest

from tests.conftest import srgc_process

FIELDS = [
    "code", "severity", "message", "file", "line", "column", "end_line", "end_column", "hint",
]  # fmt: skip
COMMANDS = [
    ["words"],
    ["accepts"],
    ["graph", "--of", "sra"],
    ["graph", "--of", "workspace"],
    ["plan"],
    ["synth"],
]


def test_the_example_is_without_findings(srgc, arm_file):
    ran = srgc("check", arm_file)
    assert (ran.status, ran.out, ran.err) == (0, "1 file without errors\n", "")
    assert srgc("check", arm_file, arm_file).out == "2 files without errors\n"


def test_a_finding_in_a_file_that_several_include_is_told_once(srgc, spec, tmp_path):
    (tmp_path / "parts.srg").write_text("module A { role base; }\nmodule A { role link; }\n")
    one, two = (spec('include "parts.srg";\n', name=name) for name in ("one.srg", "two.srg"))
    ran = srgc("check", one, two, tmp_path / "parts.srg")
    assert ran.status == 1
    assert ran.out.count("SRG0202") == 1
    assert ran.out.endswith("3 files: 1 error; `srgc explain CODE` explains a code\n")
    found = json.loads(srgc("check", one, two, "--json").out)
    assert [record["code"] for record in found] == ["SRG0202"]


def test_json_is_alone_on_stdout(srgc, arm_file):
    ran = srgc("check", arm_file, "--json")
    assert (ran.status, json.loads(ran.out), ran.err) == (0, [], "")


def test_json_places_an_error(srgc, spec, arm_file):
    text = arm_file.read_text(encoding="utf-8").replace("[0.5, 5] m;", "[5, 0.5] m;")
    path = spec(text)
    ran = srgc("check", path, "--json")
    assert (ran.status, ran.err) == (1, "")
    (record,) = json.loads(ran.out)
    assert list(record) == FIELDS
    line = text.splitlines().index(
        "module L { role link; param length in [5, 0.5] m; const density = 1 kg/m; }"
    )
    assert (record["line"], record["end_line"], record["column"]) == (line + 1, line + 1, 39)
    assert record["end_column"] == 49
    assert record["file"] == str(path)
    assert record["severity"] == "error"
    assert record["hint"]


def test_columns_count_code_points(srgc, spec, arm_file):
    text = arm_file.read_text(encoding="utf-8")
    text = text.replace("module L {", "/* größer 🤖 */ module L {")
    path = spec(text.replace("[0.5, 5] m", "[0.5, 0.1] m"))
    (record,) = json.loads(srgc("check", path, "--json").out)
    line = path.read_text(encoding="utf-8").splitlines()[record["line"] - 1]
    assert line[record["column"] - 1 : record["end_column"] - 1] == "[0.5, 0.1] m"


def test_warnings_do_not_fail(srgc, spec, arm_file):
    path = spec(arm_file.read_text(encoding="utf-8") + "\nmodule Spare { role link; }\n")
    ran = srgc("check", path)
    assert ran.status == 0
    assert "warning[SRG0403]" in ran.out
    assert ran.out.endswith("1 file without errors, 1 warning\n")
    (record,) = json.loads(srgc("check", path, "--json").out)
    assert record["severity"] == "warning"


def test_one_bad_file_among_good_ones_fails(srgc, spec, arm_file):
    ran = srgc("check", arm_file, spec("module"), "--json")
    assert ran.status == 1
    assert len(json.loads(ran.out)) == 1


def test_a_missing_file_is_a_finding(srgc, tmp_path):
    ran = srgc("check", tmp_path / "none.srg")
    assert ran.status == 1
    assert "none.srg:1:1: error[SRG0101]" in ran.out
    assert "hint: " in ran.out
    (record,) = json.loads(srgc("check", tmp_path / "none.srg", "--json").out)
    assert record["code"] == "SRG0101"


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_missing_file_elsewhere(srgc, tmp_path, command):
    ran = srgc(*command, tmp_path / "none.srg")
    assert (ran.status, ran.out) == (5, "")
    assert "error[SRG0101]" in ran.err


@pytest.mark.parametrize("command", [["check"], *COMMANDS], ids=" ".join)
def test_an_unreadable_file(srgc, tmp_path, command):
    ran = srgc(*command, tmp_path)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == f"error: {tmp_path} is not a file\n"
    ran = srgc(*command, tmp_path / ("n" * 300))
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["check"],
        ["nonsense"],
        ["check", "--nonsense", "f.srg"],
        ["words", "f.srg", "--limit", "-1"],
        ["words", "f.srg", "--max-length", "x"],
        ["graph", "f.srg"],
        ["graph", "f.srg", "--of", "nonsense"],
        ["synth", "f.srg", "--jobs", "0"],
        ["synth", "f.srg", "--seed", "-1"],
        ["synth", "f.srg", "--time-limit", "0"],
        ["verify"],
        ["verify", "d", "--jobs", "0"],
    ],
    ids=" ".join,
)
def test_usage(srgc, arguments):
    ran = srgc(*arguments)
    assert (ran.status, ran.out) == (2, "")
    assert "srgc" in ran.err


def test_help_and_version(srgc):
    ran = srgc("--help")
    assert ran.status == 0
    for command in ("check", "words", "accepts", "graph", "plan", "synth", "verify"):
        assert f"  {command} " in ran.out
        assert srgc(command, "-h").status == 0
    assert srgc("--version").status == 0


def test_a_real_process(arm_file, tmp_path):
    process = srgc_process(["check", arm_file, tmp_path / "none.srg"], tmp_path)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (1, b"")
    assert b"SRG0101" in out
    process = srgc_process([], tmp_path)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (2, b"")
    assert b"Usage: srgc" in err


def test_a_closed_pipe_is_no_fault(arm_file, tmp_path):
    process = srgc_process(["words", arm_file, "--limit", "100000"], tmp_path)
    with process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        # Not 0: that would be a verdict, of `check` and `verify`, that nobody has given.
        assert process.wait(timeout=60) == 141
        assert process.stderr.read() == b""


def test_an_internal_fault_is_one_message(monkeypatch, capsys, arm_file):
    from srgc import cli

    def broken(_path):
        raise RuntimeError("broken")

    monkeypatch.setattr("srgc.session.check_file", broken)
    assert cli.run(["check", str(arm_file)]) == 70
    err = capsys.readouterr().err
    assert err.startswith("internal error: RuntimeError: broken\n")
    assert "Traceback" not in err


def test_the_last_line_counts(srgc, spec, arm_file):
    text = arm_file.read_text(encoding="utf-8")
    two = text.replace("robot PlanarArm;", "robot PlanarAm;").replace("[0.5, 5] m", "[5, 1] m")
    ran = srgc("check", spec(two), arm_file)
    assert ran.status == 1
    assert ran.out.splitlines()[-1].startswith("2 files: 2 errors;")
    loose = text + "module Loose { role link; const weight = 2 kg; }\n"
    assert srgc("check", spec(loose)).out.splitlines()[-1] == "1 file without errors, 1 warning"


def test_of_many_findings_some_are_printed_and_all_as_json(srgc, spec):
    path = spec("edge e;\n" * 1000)
    ran = srgc("check", path)
    assert ran.status == 1
    assert ran.out.count("error[SRG0202]") == 200
    assert "\nand 799 more; `srgc check --json` prints them all\n" in ran.out
    assert len(json.loads(srgc("check", path, "--json").out)) == 999


# --- standard input ------------------------------------------------------------------------------


def test_standard_input_is_checked_like_a_file(srgc, stdin, arm_file, tmp_path, monkeypatch):
    """As `fmt -` reads it; what the text includes is looked for in the current folder."""
    monkeypatch.chdir(tmp_path)
    stdin(arm_file.read_bytes())
    assert srgc("check", "-").out == "1 file without errors\n"
    (tmp_path / "parts.srg").write_text("module A { role base; }\n")
    stdin(b'include "parts.srg";\nmodule A { role link; }\n')
    ran = srgc("check", "-", arm_file)
    assert ran.status == 1
    assert ran.out.startswith("<stdin>:2:8: error[SRG0202]")
    stdin(b"module A { role foot; }\n")
    (record,) = json.loads(srgc("check", "--json", "-").out)
    assert (record["file"], record["line"], record["column"]) == ("<stdin>", 1, 17)


@pytest.mark.parametrize("data", [b"", b"\xff\xfe", b"(" * 5000, b"\0"])
def test_garbage_in_standard_input_is_no_crash(srgc, stdin, data):
    stdin(data)
    ran = srgc("check", "-")
    assert (ran.status, ran.err) == (1, "")
    assert "<stdin>:1:1" in ran.out or "hint: " in ran.out


def test_standard_input_is_read_once(srgc, stdin):
    stdin(b"")
    ran = srgc("check", "-", "-")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "error: `-` is given twice: standard input can be read once\n"


def test_other_commands_say_who_reads_standard_input(srgc, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkfifo(tmp_path / "pipe")
    for path, said in (("-", "`-` is no file"), ("pipe", "pipe is not a file")):
        ran = srgc("synth", path)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.startswith(f"error: {said}\n  hint: `srgc check -` and `srgc fmt -` read")
    assert "hint" in srgc("check", "pipe").err


# --- an empty path -------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["synth", "check", "report"])
def test_an_empty_path_is_not_the_current_folder(srgc, arm_file, tmp_path, monkeypatch, command):
    """`-o ""` began to write among the sources, with `--force` as its advice."""
    monkeypatch.chdir(tmp_path)
    arguments = {"synth": (arm_file, "-o", "", "--force")}.get(command, ("",))
    ran = srgc(command, *arguments)
    said = "error: an empty path names neither a file nor a folder\n"
    assert (ran.status, ran.out, ran.err) == (2, "", said)
    assert list(tmp_path.iterdir()) == []
