"""The command line, run in this process without its output."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

from srgc.cli import run


def quiet(*arguments: object) -> int:
    """The exit status of a command."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return run([str(argument) for argument in arguments])


def synthesised(scratch: Path, text: str) -> Path:
    """The result folder of a specification of which a design is found."""
    (scratch / "spec.srg").write_text(text, encoding="utf-8")
    assert quiet("synth", scratch / "spec.srg", "-o", scratch / "out", "-q") == 0
    return scratch / "out"
