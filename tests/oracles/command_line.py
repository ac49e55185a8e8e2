"""The command line, its output elsewhere: in this process, or in a copy of one that is ready."""

from __future__ import annotations

import contextlib
import io
import multiprocessing
import os
import sys
from multiprocessing.forkserver import ensure_running
from pathlib import Path

import pytest

from srgc.cli import main, run

COPIED = [__name__, "solvers.search.synthesis", "srgc.cli.synth", "srgc.render.result_pictures"]
"""Imported once by the process that is copied; to import them takes longer than most syntheses."""


def quiet(*arguments: object) -> int:
    """The exit status of a command."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return run([str(argument) for argument in arguments])


def synthesised(scratch: Path, text: str) -> Path:
    """The result folder of a specification of which a design is found."""
    (scratch / "spec.srg").write_text(text, encoding="utf-8")
    assert quiet("synth", scratch / "spec.srg", "-o", scratch / "out", "-q") == 0
    return scratch / "out"


def copied(folder: Path, *arguments: str) -> int | None:
    """The exit status of a command in a fresh process in a folder, with ``stdout`` and ``stderr``.

    The process is a copy of one that has imported what it needs, and nothing of the tests.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(COPIED)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONHASHSEED", "1")
        ensure_running()
    process = context.Process(target=_run_alone, args=(folder, arguments))
    sys.audit("os.fork")  # In the other process, where no test hears it.
    process.start()
    process.join()
    return process.exitcode


def _run_alone(folder: Path, arguments: tuple[str, ...]) -> None:
    os.setsid()
    os.chdir(folder)
    for name, stream in (("stdout", 1), ("stderr", 2)):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT), stream)
    sys.argv = ["srgc", *arguments]
    main()
