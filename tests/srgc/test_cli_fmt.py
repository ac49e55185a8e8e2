from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from srgc import cli, standard_input
from srgc.formatting import canonical_form
from tests.conftest import COMMAND, srgc_process
from tests.srgc.conftest import Ran

ROOT = Path(__file__).parents[2]
UGLY = "module  A{role base;}\nedge eps; // e\n"
CANONICAL = "module A { role base; }\nedge eps;  // e\n"
BROKEN = "module {"
HEAVY = {
    "casadi", "clarabel", "cvxpy", "flint", "networkx", "numpy", "pysat", "pysmt",
    "scipy", "sklearn", "z3",
}  # fmt: skip

Run = Callable[..., Ran]
Spec = Callable[..., Path]


# --- in place -----------------------------------------------------------------------------------


def test_files_are_written_in_canonical_form(srgc: Run, spec: Spec) -> None:
    ugly, fine = spec(UGLY), spec(CANONICAL, "fine.srg")
    before = fine.stat()
    ran = srgc("fmt", ugly, fine)
    assert (ran.status, ran.err) == (0, "")
    assert ran.out == "1 file formatted, 1 file left unchanged\n"
    assert ugly.read_text(encoding="utf-8") == CANONICAL
    after = fine.stat()
    assert (before.st_ino, before.st_mtime_ns) == (after.st_ino, after.st_mtime_ns)
    assert srgc("fmt", ugly, fine).out == "2 files left unchanged\n"
    assert sorted(p.name for p in ugly.parent.iterdir()) == ["fine.srg", "spec.srg"]


def test_line_ends_and_a_byte_order_mark(srgc: Run, spec: Spec) -> None:
    path = spec(b"\xef\xbb\xbf" + UGLY.replace("\n", "\r\n").encode())
    assert srgc("fmt", "--check", path).status == 1
    assert srgc("fmt", path).status == 0
    assert path.read_bytes() == CANONICAL.encode()


@pytest.mark.parametrize("content", ["", "\n \n"])
def test_a_file_without_anything(srgc: Run, spec: Spec, content: str) -> None:
    path = spec(content)
    assert srgc("fmt", path).status == 0
    assert path.read_bytes() == b""


def test_only_the_syntax_has_to_be_right(srgc: Run, spec: Spec) -> None:
    path = spec("include 'nothing.srg';task T{robot   Nobody;}")
    assert srgc("check", path).status == 1
    assert srgc("fmt", path).status == 0
    wanted = "include 'nothing.srg';\n\ntask T {\n  robot Nobody;\n}\n"
    assert path.read_text(encoding="utf-8") == wanted


def test_mode_and_link_are_kept(srgc: Run, spec: Spec, tmp_path: Path) -> None:
    folder = tmp_path / "real"
    folder.mkdir()
    real = spec(UGLY, "real/a.srg")
    real.chmod(0o640)
    link, second = tmp_path / "link.srg", tmp_path / "second.srg"
    link.symlink_to("real/a.srg")
    second.symlink_to("link.srg")
    assert srgc("fmt", second).status == 0
    assert str(link.readlink()) == "real/a.srg"
    assert str(second.readlink()) == "link.srg"
    assert real.read_text(encoding="utf-8") == CANONICAL
    assert real.stat().st_mode & 0o777 == 0o640
    assert [p.name for p in folder.iterdir()] == ["a.srg"]


# --- what is not written ------------------------------------------------------------------------


def test_check_names_what_would_change(srgc: Run, spec: Spec) -> None:
    ugly, fine = spec(UGLY), spec(CANONICAL, "fine.srg")
    ran = srgc("fmt", "--check", ugly, fine)
    assert (ran.status, ran.out, ran.err) == (1, f"{ugly}\n", "")
    assert ugly.read_text(encoding="utf-8") == UGLY
    ran = srgc("fmt", "--check", fine)
    assert (ran.status, ran.out, ran.err) == (0, "", "")


DIFF = """\
--- {name}
+++ {name}
@@ -1,2 +1,2 @@
-module  A{{role base;}}
-edge eps; // e
+module A {{ role base; }}
+edge eps;  // e
"""


def test_diff_shows_what_would_change(srgc: Run, spec: Spec) -> None:
    ugly, fine = spec(UGLY), spec(CANONICAL, "fine.srg")
    for options, status in ((["--diff"], 0), (["--diff", "--check"], 1)):
        ran = srgc("fmt", *options, ugly, fine)
        assert (ran.status, ran.out, ran.err) == (status, DIFF.format(name=ugly), "")
        assert ugly.read_text(encoding="utf-8") == UGLY
    assert srgc("fmt", "--diff", "--check", fine).status == 0


def test_diff_is_coloured_on_a_terminal_only(
    srgc: Run, spec: Spec, monkeypatch: pytest.MonkeyPatch
) -> None:
    ugly = spec(UGLY)
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b" not in srgc("fmt", "--diff", ugly).out
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert "\x1b[32m+module" in canonical_form.formatted_file(ugly).difference(colour=True)
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in srgc("fmt", "--diff", ugly).out


# --- standard input -----------------------------------------------------------------------------


def test_standard_input_to_standard_output(srgc: Run, stdin: Callable[[bytes], None]) -> None:
    stdin(UGLY.encode())
    ran = srgc("fmt", "-")
    assert (ran.status, ran.out, ran.err) == (0, CANONICAL, "")
    stdin(CANONICAL.encode())
    assert srgc("fmt", "-").out == CANONICAL
    stdin(UGLY.encode())
    ran = srgc("fmt", "--check", "-")
    assert (ran.status, ran.out) == (1, "<stdin>\n")
    stdin(UGLY.encode())
    ran = srgc("fmt", "--diff", "-")
    assert (ran.status, ran.out) == (0, DIFF.format(name="<stdin>"))


@pytest.mark.parametrize(
    ("data", "code"),
    [(BROKEN.encode(), "SRG0104"), (b"edge \xff;", "SRG0102"), (b"edge a;\0", "SRG0103")],
)
@pytest.mark.parametrize("options", [[], ["--check"], ["--diff"]], ids=" ".join)
def test_errors_in_standard_input(
    srgc: Run, stdin: Callable[[bytes], None], data: bytes, code: str, options: list[str]
) -> None:
    stdin(data)
    ran = srgc("fmt", *options, "-")
    assert (ran.status, ran.out) == (5, "")
    assert f"<stdin>:1:{8 if code != 'SRG0102' else 6}: error[{code}]" in ran.err


def test_standard_input_too_large(
    srgc: Run, stdin: Callable[[bytes], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(standard_input, "LIMIT", 10)
    stdin(b"edge eps;\n")
    assert srgc("fmt", "-").status == 0
    stdin(b"edge eps; \n")
    ran = srgc("fmt", "-")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "error: standard input has more than 10 bytes\n"


def test_a_real_pipe_in_any_locale() -> None:
    finished = subprocess.run(
        [*COMMAND, "fmt", "-"],
        input="edge 'ü' ; // é".encode(),
        capture_output=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "C", "PYTHONIOENCODING": "latin-1"},
    )
    assert finished.stdout == "edge 'ü';  // é\n".encode()


# --- errors -------------------------------------------------------------------------------------


def test_a_file_with_syntax_errors_is_left_alone_and_the_others_formatted(
    srgc: Run, spec: Spec
) -> None:
    first, bad, last = spec(UGLY), spec(BROKEN, "bad.srg"), spec(UGLY, "last.srg")
    ran = srgc("fmt", first, bad, last)
    assert (ran.status, ran.out) == (5, "2 files formatted\n")
    assert ran.err == srgc("words", bad).err
    assert f"{bad}:1:8: error[SRG0104]" in ran.err
    assert bad.read_text(encoding="utf-8") == BROKEN
    assert last.read_text(encoding="utf-8") == CANONICAL
    assert srgc("fmt", "--check", spec(UGLY), bad).status == 5


def test_a_missing_file(srgc: Run, spec: Spec, tmp_path: Path) -> None:
    last = spec(UGLY)
    ran = srgc("fmt", tmp_path / "none.srg", last)
    assert (ran.status, ran.out) == (5, "1 file formatted\n")
    assert "none.srg:1:1: error[SRG0101]" in ran.err


@pytest.mark.parametrize("options", [[], ["--check"], ["--diff"]], ids=" ".join)
def test_what_is_no_file(srgc: Run, tmp_path: Path, options: list[str]) -> None:
    ran = srgc("fmt", *options, tmp_path)
    assert (ran.status, ran.out, ran.err) == (2, "", f"error: {tmp_path} is not a file\n")
    pipe = tmp_path / "pipe.srg"
    os.mkfifo(pipe)
    assert srgc("fmt", *options, pipe).err.startswith(f"error: {pipe} is not a file\n")


def test_a_read_only_file(srgc: Run, spec: Spec) -> None:
    path, last = spec(UGLY), spec(UGLY, "last.srg")
    path.chmod(0o444)
    ran = srgc("fmt", path, last)
    assert (ran.status, ran.out) == (2, "1 file formatted\n")
    assert ran.err == f"error: {path}: cannot write it: it is read-only\n"
    assert path.read_text(encoding="utf-8") == UGLY
    assert srgc("fmt", "--check", path).status == 1
    fine = spec(CANONICAL, "fine.srg")
    fine.chmod(0o444)
    assert srgc("fmt", fine).status == 0


def test_a_read_only_folder(srgc: Run, spec: Spec, tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    path = spec(UGLY, "folder/a.srg")
    folder.chmod(0o555)
    try:
        ran = srgc("fmt", path)
    finally:
        folder.chmod(0o755)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == f"error: {path}: cannot write it: its folder is read-only\n"
    assert path.read_text(encoding="utf-8") == UGLY


@pytest.mark.parametrize("step", ["os.fsync", "shutil.copymode"])
def test_a_write_that_fails_leaves_the_file(
    srgc: Run, spec: Spec, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = spec(UGLY)
    monkeypatch.setattr(f"srgc.formatting.canonical_form.{step}", full)
    ran = srgc("fmt", path)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == f"error: {path}: cannot write it: No space left on device\n"
    assert path.read_text(encoding="utf-8") == UGLY
    assert [p.name for p in path.parent.iterdir()] == ["spec.srg"]


def test_a_fault_of_the_formatter_writes_nothing(
    spec: Spec, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from grammar_lang.formatting import formatter

    right = formatter.lay_out
    monkeypatch.setattr(
        formatter, "lay_out", lambda text: "edge b;\n" if "base" in text.texts else right(text)
    )
    path, last = spec(UGLY), spec("edge  a;", "last.srg")
    assert cli.run(["fmt", str(path), str(last)]) == 70
    out, err = capsys.readouterr()
    assert err.startswith("internal error: NotFaithful: the canonical form has other tokens")
    assert out == "1 file formatted\n"
    assert path.read_text(encoding="utf-8") == UGLY
    assert last.read_text(encoding="utf-8") == "edge a;\n"


def test_an_interrupt_ends_it(
    spec: Spec, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from srgc.formatting import canonical_form as format_run

    first, second, third = spec(UGLY), spec(UGLY, "second.srg"), spec(UGLY, "third.srg")
    right = format_run.formatted_file

    def interrupted(path: Path) -> canonical_form.Formatted:
        if path == second:
            raise KeyboardInterrupt
        return right(path)

    monkeypatch.setattr(format_run, "formatted_file", interrupted)
    assert cli.run(["fmt", str(first), str(second), str(third)]) == 130
    assert capsys.readouterr() == ("1 file formatted\n", "interrupted\n")
    assert third.read_text(encoding="utf-8") == UGLY
    assert cli.run(["fmt", str(spec(BROKEN, "bad.srg")), str(second)]) == 5


def test_the_worst_status_is_that_of_the_command(
    srgc: Run, spec: Spec, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ugly, bad = spec(UGLY), spec(BROKEN, "bad.srg")
    for files, status in (
        ((ugly, bad), 5),
        ((bad, ugly), 5),
        ((bad, tmp_path, ugly), 2),
        ((tmp_path, bad), 2),
    ):
        assert srgc("fmt", "--check", *files).status == status

    def broken(_: object) -> str:
        raise RuntimeError("broken")

    monkeypatch.setattr("grammar_lang.formatting.formatter.lay_out", broken)
    arguments = ["fmt", "--check", str(bad), str(tmp_path), str(ugly)]
    assert cli.run(arguments) == 70


@pytest.mark.parametrize(
    "arguments", [[], ["--nonsense", "a.srg"], ["-", "a.srg"], ["-", "-"]], ids=" ".join
)
def test_usage(srgc: Run, arguments: list[str]) -> None:
    ran = srgc("fmt", *arguments)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err


def test_a_closed_pipe_is_no_fault(spec: Spec, tmp_path: Path) -> None:
    path = spec("edge  a;" * 20_000)
    process = srgc_process(["fmt", "--diff", path], tmp_path)
    with process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.wait(timeout=60) == 0
        assert process.stderr.read() == b""


def test_nothing_heavy_is_loaded() -> None:
    program = (
        "from srgc.cli import run\n"
        "run(['fmt', '--diff', 'specs/planar_arm.srg'])\n"
        "import json, sys; print(json.dumps(sorted(sys.modules)), file=sys.stderr)"
    )
    finished = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT, capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    loaded = set(finished.stderr.splitlines()[-1].strip("[]").replace('"', "").split(", "))
    assert "srgc.formatting.canonical_form" in loaded
    assert not {name.partition(".")[0] for name in loaded} & HEAVY
