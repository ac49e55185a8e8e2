"""What benchmarks printed when they were last recorded, as a page.

``benchmarks/results`` has a file per benchmark, written by ``benchmarks/record.py``. They take the
place of the line ``<!-- results -->`` in ``reference/benchmarks.md``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


def results(folder: Path) -> str:
    """The sections of all recorded benchmarks as MyST Markdown."""
    return "\n".join(line for file in sorted(folder.glob("*.json")) for line in section(file))


def section(file: Path) -> Iterator[str]:
    """The lines of the section of one benchmark."""
    record = json.loads(file.read_text(encoding="utf-8"))
    yield f"## {record['title']}\n"
    yield f"{record['says']}\n"
    yield f"```text\n{record['command']}\n```\n"
    yield f"On {record['machine']}, {record['date']}:\n"
    output = "\n".join(record["output"])
    yield f"```text\n{output}\n```\n"
