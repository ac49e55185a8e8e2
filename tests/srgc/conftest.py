from __future__ import annotations

import contextlib
import io
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from srgc.cli import run
from tests.oracles.extended_arm import extended_arm
from tests.oracles.priced_slides import priced_slides

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


@pytest.fixture
def stdin(tmp_path: Path) -> Iterator[Callable[[bytes], None]]:
    """Give this process a standard input of these bytes."""
    saved = os.dup(0)

    def give(data: bytes) -> None:
        file = tmp_path / "standard input"
        file.write_bytes(data)
        number = os.open(file, os.O_RDONLY)
        os.dup2(number, 0)
        os.close(number)

    yield give
    os.dup2(saved, 0)
    os.close(saved)


@pytest.fixture(scope="session")
def known_tubes() -> dict[bytes, object]:
    """Tubes by the bytes that they are computed from."""
    return {}


@pytest.fixture
def tubes_once(known_tubes: dict[bytes, object], monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests of what is done with a tube: that of the same files is computed once."""
    from srgc.results import found_design

    computed = found_design.certified_tube

    def certified_tube(folder: Path) -> object:
        files = [folder / "certificate.json", *sorted((folder / "spec").rglob("*"))]
        key = b"".join(b"%b\0%b\0" % (file.name.encode(), file.read_bytes())
                       for file in files if file.is_file())  # fmt: skip
        if key not in known_tubes:
            known_tubes[key] = computed(folder)
        return known_tubes[key]

    monkeypatch.setattr(found_design, "certified_tube", certified_tube)


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


def _all_designs(place: Path, name: str, text: str) -> Path:
    """A folder with a spec, with ``out`` of ``synth --all`` on it, and with what that printed."""
    (place / name).write_text(text, encoding="utf-8")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(place / name), "--all", "-o", str(place / "out")]) == 0
    (place / "stdout").write_text(printed.getvalue(), encoding="utf-8")
    return place


@pytest.fixture(scope="session")
def designs_made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``out`` of ``synth --all`` on an arm that can be extended; beside it spec and stdout."""
    return _all_designs(tmp_path_factory.mktemp("all-designs"), "arm.srg", extended_arm("[0.5, 1]"))


@pytest.fixture
def designs(designs_made: Path, tmp_path: Path) -> Path:
    """A fresh copy of that result folder."""
    target = tmp_path / "designs-made"
    shutil.copytree(designs_made / "out", target)
    return target


@pytest.fixture(scope="session")
def priced_made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same of slides that are to be cheap, and then light."""
    return _all_designs(tmp_path_factory.mktemp("priced"), "slides.srg", priced_slides())


@pytest.fixture
def priced(priced_made: Path, tmp_path: Path) -> Path:
    """A fresh copy of that result folder."""
    target = tmp_path / "priced-made"
    shutil.copytree(priced_made / "out", target)
    return target
