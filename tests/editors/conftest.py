"""The VS Code extension, packaged once for all tests of a session."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXTENSION = ROOT / "editors" / "vscode"
LOCK, INSTALLED = EXTENSION / "package-lock.json", EXTENSION / "node_modules" / ".package-lock.json"


def run(*command: str | Path, given: str = "", **environment: str) -> str:
    """What a command prints, run in the folder of the extension."""
    done = subprocess.run(
        [*map(str, command)],
        cwd=EXTENSION,
        env={**os.environ, **environment},
        input=given,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


def install() -> None:
    """The packages of the lock file, where they are not there yet."""
    if not INSTALLED.exists() or INSTALLED.stat().st_mtime < LOCK.stat().st_mtime:
        run("npm", "ci")
        INSTALLED.touch()


@pytest.fixture(scope="session")
def vsix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packaged extension; its bundle is then in `dist`, for the tests of the client."""
    if packaged := os.environ.get("SRGC_VSIX"):
        return ROOT / packaged
    if not (shutil.which("npm") and shutil.which("node")):
        if os.environ.get("SRGC_BROWSER") == "required":
            pytest.fail("npm is missing")
        pytest.skip("npm is missing")
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    packed = base / "srg.vsix"
    with (base / "vsix-lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not packed.exists():
            install()
            run("npm", "run", "--silent", "package", "--", "-o", base / "packing.vsix")
            (base / "packing.vsix").rename(packed)
    return packed
