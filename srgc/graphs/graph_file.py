"""``srgc graph``: DOT texts in files, drawn as pictures where Graphviz is installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from srgc.paths import write_output
from srgc.session import UsageFault

DRAWN = (".svg", ".png", ".pdf")
TEXT = (".dot", ".gv", ".txt", "")
DRAWING_SECONDS = 120


def write_graph(text: str, output: Path) -> str:
    """Write DOT text, or the picture its file name asks for; what Graphviz has to say of it.

    Raises:
        UsageFault: a file name of another kind, Graphviz is needed and missing, or the file cannot
            be written.
    """
    suffix = output.suffix.lower()
    if suffix not in (*TEXT, *DRAWN):
        raise UsageFault(f"{output}: give a name that ends in {', '.join((*TEXT[:-1], *DRAWN))}")
    if suffix in TEXT:
        write_output(output, text)
        return ""
    picture, said = drawn_by_graphviz(text, suffix[1:])
    write_output(output, picture)
    return said


def drawn_by_graphviz(text: str, form: str) -> tuple[bytes, str]:
    """The picture of a DOT text as svg, png or pdf, and what Graphviz has to say of it.

    Raises:
        UsageFault: Graphviz is missing, or fails.
    """
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
    said = finished.stderr.decode(errors="replace").strip()
    if finished.returncode:
        raise UsageFault(f"Graphviz failed: {said}")
    return finished.stdout, said
