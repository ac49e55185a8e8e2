"""Arguments that several commands share."""

from __future__ import annotations

from pathlib import Path

import click

FILE = click.argument("file", type=click.Path(path_type=Path))
GRAMMAR = click.option("--grammar", help="The grammar, where the file has several.")
