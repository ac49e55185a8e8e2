"""Prints what each library takes that is installed beside this Python, with its compiled files."""

from __future__ import annotations

import sys
from importlib.metadata import Distribution, distributions
from importlib.util import cache_from_source
from pathlib import Path

INSTALLERS = {"pip", "setuptools"}


def size(library: Distribution) -> int:
    """The bytes of its files, and of what they are compiled to, whoever compiled them."""
    files = {Path(str(library.locate_file(file))) for file in library.files or ()}
    compiled = {Path(cache_from_source(str(file))) for file in files if file.suffix == ".py"}
    return sum(file.stat().st_size for file in files | compiled if file.is_file())


def main() -> None:
    """Print a line for each library, the largest first, and their sum."""
    found = {one.metadata["Name"]: size(one) for one in distributions()}
    kept = {name: count for name, count in found.items() if name not in INSTALLERS}
    lines = [
        f"{count / 1e6:7.1f} MB  {name}"
        for name, count in sorted(kept.items(), key=lambda item: (-item[1], item[0]))
    ]
    sys.stdout.write("\n".join([*lines, f"{sum(kept.values()) / 1e6:7.1f} MB  all\n"]))


if __name__ == "__main__":
    main()
