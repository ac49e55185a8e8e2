"""The command that evaluates rho over parameters of a robot that was found: ``landscape``."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from os.path import realpath
from pathlib import Path
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import FOLDER, QUIET, DocumentedCommand, PathOf
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from srgc.landscapes.landscape_request import Mark

PICTURE, GRID = "figures/landscape.svg", "landscape.csv"


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc landscape out/demo --points 3",
        "srgc landscape out/demo --over 4.length --points 3 -o out/length.svg --csv out/length.csv",
    ],
    reads_spec=False,
    read_on="docs/how-to/designs.md",
)
@FOLDER
@click.option(
    "--over",
    metavar="NAME[,NAME]",
    help="One or two parameters, such as 4.length,8.length: the index of a symbol in the word and "
    "a name.  Default: the first two that can vary.",
)
@click.option(
    "--range",
    "ranges",
    metavar="NAME=LOW:HIGH",
    multiple=True,
    help="The range of a parameter in SI units; default: all.  Can be repeated.",
)
@click.option(
    "--points",
    type=click.IntRange(2, 1000),
    help="Values per axis; default 11, or 41 for one axis.  Finite sets are used completely.",
)
@click.option(
    "--mark", "marks", metavar="X[,Y]", multiple=True, help="Mark this point.  Can be repeated."
)
@click.option(
    "--label", "labels", multiple=True, help="The name of a mark, in the order of the marks."
)
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True)
@click.option(
    "-o",
    "output",
    type=PathOf(path_type=Path, dir_okay=False),
    help="Write the SVG picture here.  Default: FOLDER/figures/landscape.svg.",
)
@click.option(
    "--csv",
    "table",
    type=PathOf(path_type=Path, dir_okay=False),
    help="Write the grid here.  Default: FOLDER/landscape.csv.",
)
@QUIET
def landscape(
    folder: Path,
    over: str | None,
    ranges: tuple[str, ...],
    points: int | None,
    marks: tuple[str, ...],
    labels: tuple[str, ...],
    jobs: int,
    output: Path | None,
    table: Path | None,
    quiet: bool,  # noqa: FBT001
) -> int:
    """Evaluate and draw the robustness of a robot over two of its parameters.

    FOLDER is one that `srgc synth` has written with the verdict found.  The path of cells, the
    times at which they are entered, and all other parameters are those of the design.
    """
    from srgc.landscapes.landscape_request import LandscapeRequest, axes_of, refuse_marks
    from srgc.results.folder_writer import folder_output
    from srgc.results.found_design import found_design, found_record

    picture, grid = output or folder / PICTURE, table or folder / GRID
    if picture.suffix.lower() != ".svg":
        raise UsageFault(f"{picture}: a landscape is drawn as SVG; let the name end in .svg")
    if realpath(grid) == realpath(picture):
        raise UsageFault(f"{picture} cannot be the picture and the table")
    files = [folder_output(folder, path, {PICTURE, GRID}) for path in (picture, grid)]
    found = found_design(folder)
    record = found_record(folder, found)
    names = None if over is None else tuple(over.split(","))
    request = LandscapeRequest(names, parsed_ranges(ranges), points, parsed_marks(marks, labels))
    axes = axes_of(found.model, request)
    refuse_marks(axes, request.marks)
    from srgc.landscapes.landscape import landscape as evaluated
    from srgc.landscapes.landscape import landscape_csv, landscape_text, title
    from srgc.landscapes.landscape_picture import landscape_svg
    from srgc.results.progress_display import progress
    from srgc.search_options import workers_for

    with workers_for(jobs) as workers, progress("landscape", quiet=quiet, unit="points") as display:
        content = evaluated(found, record, folder, axes, request.marks, workers, display.part)
    drawn = landscape_svg(content, title(found, content))
    for file, written in zip(files, (drawn, landscape_csv(found, content)), strict=True):
        if file.name is None:
            _make_room(file.path)
        file.write(written)
    click.echo(landscape_text(found, content))
    click.echo(f"picture: {picture}\ntable:   {grid}")
    return 0


def parsed_ranges(texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """The ranges by name of parameter, parsed from texts ``NAME=LOW:HIGH``.

    Raises:
        UsageFault: a text has another form, or a name occurs twice.
    """
    found: dict[str, tuple[float, float]] = {}
    for text in texts:
        name, _, ends = text.partition("=")
        low, separator, high = ends.partition(":")
        if not separator:
            raise UsageFault(f"--range {text}: write it as in 4.length=1:2.5")
        if name in found:
            raise UsageFault("--range is given twice for one parameter")
        found[name] = _number(low), _number(high)
    return found


def parsed_marks(texts: Sequence[str], labels: Sequence[str]) -> tuple[Mark, ...]:
    """The marks, parsed from ``X`` or ``X,Y``; one without a label is labelled by its place.

    Raises:
        UsageFault: a value is not a number, or there are more labels than marks.
    """
    from srgc.landscapes.landscape_request import Mark

    if len(labels) > len(texts):
        raise UsageFault("there are more --label than --mark")
    names = [*labels, *(f"({text})" for text in texts[len(labels) :])]
    return tuple(
        Mark(tuple(map(_number, text.split(","))), name)
        for text, name in zip(texts, names, strict=True)
    )


def _number(text: str) -> float:
    """Parse a finite number."""
    try:
        value = float(text)
    except ValueError:
        raise UsageFault(f"`{text}` is not a number") from None
    if not isfinite(value):
        raise UsageFault(f"`{text}` is not a number")
    return value


def _make_room(path: Path) -> None:
    """Create the folder of a file."""
    from srgc.paths import unwritable

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path.parent, error) from None
