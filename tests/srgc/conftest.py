from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from srgc.cli import run

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Ran:
    status: int
    out: str
    err: str


@pytest.fixture
def srgc(capsys: pytest.CaptureFixture[str]) -> Callable[..., Ran]:
    """Run a command line in this process."""

    def call(*arguments: object) -> Ran:
        capsys.readouterr()
        status = run([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err
        assert status != 70, captured.err
        return Ran(status, captured.out, captured.err)

    return call


@pytest.fixture(scope="session")
def arm_file() -> Path:
    return ROOT / "specs" / "planar_arm.srg"


@pytest.fixture
def spec(tmp_path: Path) -> Callable[[str | bytes], Path]:
    """A file with this text."""

    def write(content: str | bytes, name: str = "spec.srg") -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write
