"""The wheels that the page serves: srgc's own, and the locked ones of what it imports there.

python editors/playground/wheels.py FOLDER
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LOCK = ROOT / "requirements" / "run.lock"
IMPORTED = ("attrs", "click", "lsprotocol", "python-flint")
"""What srgc imports in the page; python-flint only when it is due."""
BROWSER = (
    "--platform=pyemscripten_2026_0_wasm32", "--python-version=3.14", "--implementation=cp",
    "--abi=cp314",
)  # fmt: skip
"""What the locked Pyodide is (PEP 783)."""


def locked(names: tuple[str, ...], lock: str) -> str:
    """The requirements of these names in the text of a lock file, with their hashes."""
    entries = re.findall(r"^\S+==(?:.*\\\n)*.*\n", lock, re.MULTILINE)
    found = {entry.partition("==")[0]: entry for entry in entries}
    return "".join(found[name] for name in names)


def main(folder: Path) -> None:
    """Download and build into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "download", "--quiet"]
    with tempfile.NamedTemporaryFile("w", suffix=".txt", encoding="utf-8") as asked:
        asked.write(locked(IMPORTED, LOCK.read_text(encoding="utf-8")))
        asked.flush()
        options = ["--require-hashes", "--no-deps", "--only-binary=:all:", *BROWSER]
        subprocess.run(  # noqa: S603
            [*pip, *options, "--dest", folder, "--requirement", asked.name], check=True
        )
    # No compiler, no native code: what is then built runs everywhere.
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT]
    without = {**os.environ, "CC": "false"}
    subprocess.run(build, check=True, env=without, stdout=subprocess.DEVNULL)  # noqa: S603


if __name__ == "__main__":
    main(Path(sys.argv[1]))
