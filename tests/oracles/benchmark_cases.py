"""The specs of a benchmark, read in another process, since benchmarks are no package."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from grammar_lang import ir
from grammar_lang.load import load_text
from srgc.session import check_loaded

ROOT = Path(__file__).parents[2]


def programs_of(benchmark: str) -> dict[str, ir.Program]:
    """The cases of a benchmark with `cases()`, checked, by their names."""
    code = f"import sys; sys.path.insert(0, 'benchmarks'); import {benchmark}, json; "
    code += f"print(json.dumps({{each.name: each.text for each in {benchmark}.cases()}}))"
    ran = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    found = {}
    for name, text in json.loads(ran.stdout).items():
        checked = check_loaded(load_text(text, f"{name}.srg"))
        assert checked.program is not None, name
        found[name] = checked.program
    return found
