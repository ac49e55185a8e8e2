"""What a fresh interpreter has loaded after a program."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
ENDING = "\nimport json, sys\nprint(json.dumps(sorted(sys.modules)), file=sys.stderr)"


def loaded_after(program: str) -> set[str]:
    """The modules that a fresh interpreter has loaded after running a program."""
    finished = subprocess.run(
        [sys.executable, "-c", program + ENDING],
        cwd=ROOT, capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    return set(json.loads(finished.stderr.splitlines()[-1]))
