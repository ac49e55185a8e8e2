"""Colours, redrawn lines, and streams that are narrow, closed or no UTF-8."""

from __future__ import annotations

import io
import json
import os
import pty
import re
import select
import shutil
import subprocess
import sys

import pytest

from srgc.cli import run
from srgc.terminal import colours, redraws
from tests.conftest import ROOT, srgc_process
from tests.oracles.small_specs import BEYOND_REACH, TURNER
from tests.oracles.some_cases import some

ESCAPE = "\x1b["
OVERRUN = re.compile(r"; it was passed by [\d.]+ s, in which srgc was started")
"""What is said of a limit that is shorter than the start of srgc, whose length varies."""
WALLED = TURNER.replace(
    "obstacle O box [1.4, 2.5] x [1.4, 2.5] m;", "obstacle O box [-1, 3] x [0.5, 0.9] m;"
)
"""The obstacle is a wall from bound to bound between the start and the target."""
WRONG = "module Größe { role linkk; }\n"


class Terminal(io.StringIO):
    def isatty(self):
        return True


CASES = {
    "nothing said": ({}, True, False),
    "NO_COLOR": ({"NO_COLOR": "1"}, False, False),
    "an empty NO_COLOR": ({"NO_COLOR": ""}, True, False),
    "FORCE_COLOR": ({"FORCE_COLOR": "1"}, True, True),
    "FORCE_COLOR=0": ({"FORCE_COLOR": "0"}, False, False),
    "an empty FORCE_COLOR": ({"FORCE_COLOR": ""}, True, False),
    "both": ({"NO_COLOR": "1", "FORCE_COLOR": "1"}, False, False),
    "a dumb terminal": ({"TERM": "dumb"}, False, False),
    "a dumb terminal, forced": ({"TERM": "dumb", "FORCE_COLOR": "1"}, True, True),
}


@pytest.fixture
def plain_environment(monkeypatch):
    for name in ("NO_COLOR", "FORCE_COLOR", "COLUMNS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    return monkeypatch


@pytest.mark.parametrize("case", CASES)
def test_who_decides_on_colours(plain_environment, case):
    environment, terminal, pipe = CASES[case]
    for name, value in environment.items():
        plain_environment.setenv(name, value)
    assert (colours(Terminal()), colours(io.StringIO())) == (terminal, pipe)


def test_lines_are_redrawn_on_terminals_alone(plain_environment):
    plain_environment.setenv("FORCE_COLOR", "1")  # which asks for no more than colours
    assert redraws(Terminal())
    assert not redraws(io.StringIO())
    assert not redraws(None)
    closed = Terminal()
    closed.close()
    assert isinstance(redraws(closed), bool)
    plain_environment.setenv("TERM", "dumb")
    assert not redraws(Terminal())


MAIN = "from srgc.cli import main; main()"


def on_terminal(arguments, folder, columns=80, program=MAIN, **environment):
    """Exit status and what a command writes to a terminal, both streams in one."""
    leader, follower = pty.openpty()
    clean = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR", "COLUMNS")}
    told = {"PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": str(columns)}
    process = subprocess.Popen(
        [sys.executable, "-c", program, *map(str, arguments)],
        cwd=folder, stdin=follower, stdout=follower, stderr=follower, start_new_session=True,
        env={**clean, **told, **environment},
    )  # fmt: skip
    os.close(follower)
    parts = []
    while True:
        select.select([leader], [], [], 120)
        try:
            data = os.read(leader, 65536)
        except OSError:  # the other end has been closed
            break
        if not data:
            break
        parts.append(data)
    os.close(leader)
    return process.wait(timeout=60), b"".join(parts).decode().replace("\r\n", "\n")


COLOURED = [
    ["check", "bad.srg"],
    ["fmt", "--diff", "ugly.srg"],
    ["words", "bad.srg"],
    ["explain", "301"],
]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "bad.srg").write_text(WRONG, encoding="utf-8")
    (tmp_path / "ugly.srg").write_text("edge  a;\n", encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("arguments", some(COLOURED, 2), ids=" ".join)
def test_every_command_asks_the_same_place(folder, arguments):
    def piped(**environment):
        with srgc_process(arguments, folder, TERM="xterm", **environment) as process:
            out, err = process.communicate(timeout=60)
        return (out + err).decode()

    assert ESCAPE in on_terminal(arguments, folder)[1]
    assert ESCAPE not in on_terminal(arguments, folder, NO_COLOR="1")[1]
    assert ESCAPE not in on_terminal(arguments, folder, TERM="dumb")[1]
    assert ESCAPE not in piped(NO_COLOR="", FORCE_COLOR="")
    assert ESCAPE in piped(NO_COLOR="", FORCE_COLOR="1")


VERDICTS = {
    "synth": (["synth", "turner.srg", "-o", "out"], "verdict: ", "found", 32, "srgc verify out"),
    "refuted robots": (
        ["synth", "far.srg", "-o", "out"], "verdict: ", "impossible", 31, "srgc why out",
    ),
    "unknown": (
        ["synth", "turner.srg", "-o", "out", "--time-limit", "1e-9"],
        "verdict: ", "unknown", 33, "run the same command again to continue",
    ),
    "plan": (["plan", "turner.srg"], "verdict: ", "found", 32, "srgc synth turner.srg"),
    "no plan": (["plan", "closed.srg"], "", "no path", 31, "srgc plan -o plan.svg closed.srg"),
    "verify": (["verify", "turner"], "", "valid", 32, "srgc report turner"),
    "refuted": (["verify", "false"], "", "refuted", 31, "do not rely on it"),
    "open": (["verify", "nothing"], "", "undecided", 33, "the same `srgc synth turner.srg`"),
}  # fmt: skip


@pytest.fixture
def results(tmp_path, made):
    """Specs with every verdict, and results with every answer of the verifier."""
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    (tmp_path / "far.srg").write_text(BEYOND_REACH, encoding="utf-8")
    (tmp_path / "closed.srg").write_text(WALLED, encoding="utf-8")
    shutil.copytree(made("turner") / "out", tmp_path / "turner")
    shutil.copytree(made("turner") / "out", tmp_path / "false")
    (tmp_path / "false" / "certificate.json").write_text("{}", encoding="utf-8")
    shutil.copytree(made("turner") / "out", tmp_path / "nothing")
    (tmp_path / "nothing" / "certificate.json").unlink()
    return tmp_path


@pytest.mark.parametrize("case", some([*VERDICTS], 4))
def test_a_verdict_is_first_and_coloured_and_the_next_step_last(results, case):
    arguments, before, word, colour, step = VERDICTS[case]
    shown = on_terminal(arguments, results)[1].rpartition("\x1b[2K")[2]
    text = shown.replace("\x1b[?25h", "").lstrip("\r\n")
    assert text.startswith(f"{before}\x1b[1;{colour}m{word}\x1b[0m")
    assert text.count("\x1b[") == 2
    assert f"\nnext:    {step}" in text
    shutil.rmtree(results / "out", ignore_errors=True)
    with srgc_process(arguments, results) as process:
        out, _ = process.communicate(timeout=600)
    plain = text.replace(f"\x1b[1;{colour}m", "").replace("\x1b[0m", "")
    assert ESCAPE not in out.decode()
    if arguments[0] != "plan":
        assert OVERRUN.sub("", out.decode()) == OVERRUN.sub("", plain)
    else:  # in a pipe the path of cells alone
        assert set(out.decode().splitlines()) <= set(plain.splitlines())
        assert "next:" not in out.decode()


def test_progress_is_one_line_that_is_gone_at_the_end(tmp_path):
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    program = (
        "import srgc.results.progress_display as d; d.SILENCE = 0.0\n"
        "from srgc.cli import main; main()"
    )
    command = ["synth", "turner.srg", "-o", "out"]
    status, text = on_terminal(command, tmp_path, columns=200, program=program)
    assert status == 0
    progress, _, result = text.rpartition("\x1b[2K")
    assert "verdict: \x1b[1;32mfound" in result
    assert "synth Turn" not in result
    # One line: it is erased and drawn, and the cursor never goes down for another.
    drawn = progress.split("\x1b[2K")
    assert any(re.search(r"synth Turn · [12] structures · \d+ s · no estimate", d) for d in drawn)
    assert all("\n" not in each.split("\x1b[?25h")[0].strip("\r\n") for each in drawn)
    assert max(map(len, drawn)) < 200
    assert text.count("\x1b[?25l") == text.count("\x1b[?25h")


def test_quiet_says_nothing_on_standard_error(tmp_path, capfd):
    """Neither do libraries, which write to the descriptor."""
    spec = tmp_path / "turner.srg"
    spec.write_text(TURNER, encoding="utf-8")
    assert run(["synth", str(spec), "-o", str(tmp_path / "out"), "-q"]) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert out.startswith("verdict: found")
    # Errors are said all the same.
    assert run(["synth", str(tmp_path / "none.srg"), "-q"]) == 5
    assert "none.srg" in capfd.readouterr().err


def escaped(letters):
    """As JSON without letters beyond ASCII writes them."""
    return json.dumps(letters)[1:-1]


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252"])
def test_letters_that_a_terminal_does_not_have(tmp_path, encoding):
    (tmp_path / "größe-ρ-𝑞.srg").write_text("module Größeρ𝑞 { role linkk; }\n", encoding="utf-8")
    arguments = ["check", "größe-ρ-𝑞.srg"]
    with srgc_process(arguments, tmp_path, PYTHONIOENCODING=encoding) as process:
        out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (1, b"")
    # Click takes ASCII for a terminal that was never set up, and writes UTF-8 all the same.
    encoding = "utf-8" if encoding == "ascii" else encoding
    shown = out.decode(encoding)
    if encoding == "utf-8":
        assert "größe-ρ-𝑞.srg:1:" in shown
        return
    assert f"-{escaped('ρ')}-{escaped('𝑞')}.srg:1:" in shown
    assert "größe-" in shown
    # JSON remains JSON, and says the same.
    with srgc_process([*arguments, "--json"], tmp_path, PYTHONIOENCODING=encoding) as process:
        found = json.loads(process.communicate(timeout=60)[0].decode(encoding))
    assert {record["file"] for record in found} == {"größe-ρ-𝑞.srg"}


@pytest.mark.parametrize("locale", [{"LANG": "C", "LC_ALL": "C"}, {"LC_ALL": "POSIX"}])
def test_a_bare_locale(folder, locale):
    for arguments in (["check", "bad.srg"], ["--help"], ["synth", "--help"], ["explain"]):
        with srgc_process(arguments, folder, **locale) as process:
            out, err = process.communicate(timeout=60)
        assert (process.returncode, err) == (arguments == ["check", "bad.srg"], b"")
        assert out


def test_a_narrow_terminal(folder):
    for columns in (20, 40):
        for arguments in (["--help"], ["synth", "--help"], ["check", "bad.srg"]):
            status, text = on_terminal(arguments, folder, columns=columns)
            assert status == (arguments[0] == "check")
            assert "Traceback" not in text
    status, text = on_terminal(["--help"], folder, columns=40)
    longest = max(map(len, text.splitlines()))
    assert longest <= 40, text


CLOSED = """\
import os, sys
os.close(int(sys.argv.pop(1)))
os.execv(sys.executable, [sys.executable, *sys.argv[1:]])
"""


@pytest.mark.parametrize("stream", [0, 1, 2])
@pytest.mark.parametrize("arguments", [["check", "bad.srg"], ["fmt", "-"], ["words", "none.srg"]])
def test_a_stream_that_is_closed(folder, stream, arguments):
    """As by ``srgc check bad.srg >&-``."""
    finished = subprocess.run(
        [sys.executable, "-c", CLOSED, str(stream), "-c", MAIN, *arguments],
        cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=60,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert b"Traceback" not in finished.stderr
    expected = {"check": 1, "fmt": 2 if stream == 0 else 0, "words": 5}[arguments[0]]
    assert finished.returncode == expected, finished.stderr


@pytest.mark.parametrize(
    "arguments", [["check", "bad.srg"], ["words", "bad.srg"], ["--help"], ["synth"]]
)
def test_nobody_reads_either_stream(folder, arguments):
    reader, writer = os.pipe()
    os.close(reader)
    finished = subprocess.run(
        [sys.executable, "-c", MAIN, *arguments],
        cwd=folder, stdin=subprocess.DEVNULL, stdout=writer, stderr=writer, check=False, timeout=60,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    os.close(writer)
    # An error has its status all the same; of what should be read it is not 0, which is a success.
    expected = {"check": 141, "words": 5, "--help": 141, "synth": 2}[arguments[0]]
    assert finished.returncode == expected


def _dead_pipe():
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def _full_disk():
    return os.open("/dev/full", os.O_WRONLY)


@pytest.mark.parametrize("stream", some([_dead_pipe, _full_disk], 1))
def test_work_goes_on_where_progress_cannot_be_written(tmp_path, stream):
    """As by ``srgc synth 2>&1 >answer | head -1``: the search is not lost, nor its verdict."""
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    writer = stream()
    try:
        for arguments, expected, said in (
            (["synth", "turner.srg", "-o", "out"], 0, "verdict: found"),
            (["verify", "none"], 2, ""),
            (["words", "none.srg"], 5, ""),
        ):
            finished = subprocess.run(
                [sys.executable, "-c", MAIN, *arguments],
                cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=writer,
                text=True, check=False, timeout=120,
                env={**os.environ, "PYTHONPATH": str(ROOT)},
            )  # fmt: skip
            assert (finished.returncode, finished.stdout[: len(said)]) == (expected, said)
    finally:
        os.close(writer)


LIMITED = """\
import os, resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
os.execv(sys.executable, [sys.executable, *sys.argv[1:]])
"""


def test_a_file_that_may_not_grow(tmp_path):
    """As by ``ulimit -f 4``."""
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    # What records branches writes a file of its own.
    uncovered = {name: x for name, x in os.environ.items() if not name.startswith("COVERAGE")}
    finished = subprocess.run(
        [sys.executable, "-c", LIMITED, "-c", MAIN, "synth", "turner.srg", "-q"],
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120,
        env={**uncovered, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"},
    )  # fmt: skip
    assert (finished.returncode, finished.stdout) == (2, "")
    assert finished.stderr == "error: out/Turn/journal.jsonl: File too large\n"


def test_as_a_module(folder):
    finished = subprocess.run(
        [sys.executable, "-m", "srgc", "--version"],
        cwd=folder, capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    with srgc_process(["--version"], folder) as process:
        assert finished.stdout == process.communicate(timeout=60)[0].decode()
