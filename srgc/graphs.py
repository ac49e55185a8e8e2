"""``srgc graph``: DOT texts in files, drawn as SVG or PNG where Graphviz is installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from srgc.session import UsageFault

DRAWN = (".svg", ".png")
DRAWING_SECONDS = 120


def write_graph(text: str, output: Path) -> None:
    """Write DOT text, or the picture its file name asks for.

    Raises:
        UsageFault: Graphviz is needed and missing, or the file cannot be written.
    """
    try:
        if output.suffix not in DRAWN:
            output.write_text(text, encoding="utf-8")
            return
        output.write_bytes(_drawn(text, output.suffix[1:]))
    except OSError as error:
        raise UsageFault(f"{output}: {error.strerror}") from None


def _drawn(text: str, form: str) -> bytes:
    program = shutil.which("dot")
    if program is None:
        raise UsageFault("Graphviz (`dot`) is not installed: write a .dot file instead")
    try:
        finished = subprocess.run(  # noqa: S603  (the program found above, fixed arguments)
            [program, f"-T{form}"],
            input=text.encode(),
            capture_output=True,
            timeout=DRAWING_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise UsageFault(f"Graphviz did not finish within {DRAWING_SECONDS} s") from None
    if finished.returncode:
        raise UsageFault(f"Graphviz failed: {finished.stderr.decode(errors='replace').strip()}")
    return finished.stdout
