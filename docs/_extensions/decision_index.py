"""The list of decision records with what each says in its first heading."""

from __future__ import annotations

from pathlib import Path


def index(folder: Path) -> str:
    """A table of contents of all records, in their order, as MyST Markdown."""
    files = sorted(folder.glob("[0-9]*.md"))
    lines = "\n".join(file.stem for file in files)
    return f"```{{toctree}}\n:maxdepth: 1\n\n{lines}\n```\n"
