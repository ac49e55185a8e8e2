"""The command ``import``."""

from __future__ import annotations

from pathlib import Path

import click

from srgc.cli.arguments import FILE, OUTPUT, DocumentedCommand
from srgc.faults import UsageFault

PACKAGES = click.option(
    "--package",
    "packages",
    multiple=True,
    metavar="NAME=DIR",
    help="Where the files of `package://NAME` and `model://NAME` are; may be given several times.",
)


@click.group(name="import")
def import_() -> None:
    """Write specs from the files of other tools."""


def package_folders(given: tuple[str, ...]) -> dict[str, Path]:
    """The folders of packages from ``NAME=DIR``.

    Raises:
        UsageFault: one is not of this form, or is no folder.
    """
    found = dict[str, Path]()
    for each in given:
        name, equals, folder = each.partition("=")
        if not equals or not name or not folder:
            raise UsageFault(f"--package {each}: write NAME=DIR")
        if not Path(folder).is_dir():
            raise UsageFault(f"--package {each}: {folder} is not a folder")
        found[name] = Path(folder)
    return found


@import_.command(
    cls=DocumentedCommand,
    examples=[
        "srgc import scene specs/scenes/bench.scene",
        "srgc import scene specs/scenes/bracket.obj --unit mm --name Cell -o out/cell.srg",
    ],
    reads_spec=False,
    read_on="docs/how-to/scenes.md",
)
@FILE
@OUTPUT
@click.option(
    "--unit",
    type=click.Choice(["mm", "cm", "m", "in"]),
    help="The unit of an STL or OBJ file (metres otherwise), or instead of that of a DAE file.",
)
@click.option("--at", metavar="PLACE", help="Where its origin is, such as `(0.5, 0, 0) m`.")
@click.option(
    "--pieces",
    type=click.IntRange(1),
    help="Convex pieces of each mesh, at most; the volume added is then what it is.",
)
@click.option(
    "--detail",
    type=click.FloatRange(0, min_open=True),
    default=0.1,
    show_default=True,
    help="The volume that pieces may add to a mesh, as a share of its own.",
)
@click.option("--name", help="The name of the workspace, not that of the scene.")
@PACKAGES
def scene(
    file: Path,
    output: Path | None,
    unit: str | None,
    at: str | None,
    pieces: int | None,
    detail: float,
    name: str | None,
    packages: tuple[str, ...],
) -> int:
    """Write a workspace from a scene: STL, OBJ, DAE, MoveIt .scene, SDF .sdf and .world.

    Meshes become convex pieces that hold every triangle, which is checked exactly.  What cannot be
    carried over is listed.
    """
    from srgc.imports.scenes.scene_file import read_scene
    from srgc.imports.scenes.scene_text import Wanted, scene_text
    from srgc.paths import write_output

    read = read_scene(file, unit=unit, at=at, packages=package_folders(packages))
    made = scene_text(read, file.name, Wanted(detail, pieces, name))
    for note in made.notes:
        click.echo(f"note: {note}", err=True)
    if output is None or output == Path("-"):
        click.echo(made.text, nl=False)
    else:
        write_output(output, made.text)
    return 0
