"""The command ``import``: robots, module sets, tasks and scenes of other tools."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from srgc.cli.arguments import DocumentedCommand, PathOf
from srgc.faults import UsageFault
from srgc.terminal import colours

if TYPE_CHECKING:
    from srgc.imports.written_import import Imported

KINDS: Mapping[str, tuple[str, frozenset[str]]] = {
    "urdf": (
        "srgc.imports.urdf.urdf_import:urdf_import",
        frozenset(
            {"name", "exact", "module", "ports", "effectors", "fixed", "packages", "density"}
            | {"arguments", "pieces", "detail"}
        ),
    ),
    "timor": (
        "srgc.imports.timor.timor_import:timor_import",
        frozenset({"name", "exact", "any_end", "pieces", "detail"}),
    ),
    "cobra": (
        "srgc.imports.cobra.cobra_import:cobra_import",
        frozenset({"modules", "name", "exact", "base", "any_order", "cost", "pieces", "detail"}),
    ),
    "scene": (
        "srgc.imports.scenes.scene_import:scene_import",
        frozenset({"name", "unit", "at", "packages", "pieces", "detail"}),
    ),
}
"""For each kind, the function that imports it, and the options that this function takes."""
LIBRARIES = ("collada", "lxml", "manifold3d", "trimesh", "xacro", "yourdfpy")
"""The libraries of the extra ``import``; each is imported only where it is needed."""


def _finite(
    _context: click.Context, parameter: click.Parameter, value: float | None
) -> float | None:
    """Refuse nan, which passes every comparison, and infinity."""
    if value is not None and not math.isfinite(value):
        raise click.BadParameter("a finite number is expected", param=parameter)
    return value


@click.command(
    "import",
    cls=DocumentedCommand,
    examples=[
        "srgc import urdf specs/robots/scara.urdf -o out/scara.srg",
        "srgc import timor specs/imports/scara_modules -o out/kit.srg",
        "srgc import cobra specs/imports/sort_parts.json -o out/sort.srg",
        "srgc import scene specs/imports/bench.scene -o out/bench.srg",
    ],
    reads_spec=False,
    read_on="docs/how-to/import.md",
)
@click.argument("kind", type=click.Choice([*KINDS]))
@click.argument("file", type=PathOf(path_type=Path))
@click.option(
    "-o",
    "output",
    type=PathOf(path_type=Path, allow_dash=True),
    help="Write to this file; `-` is stdout, without meshes.  Default: NAME.srg.",
)
@click.option("--name", help="The prefix of names; default: the name of the robot or file.")
@click.option("--exact", is_flag=True, help="Keep all digits of angles and lengths.")
@click.option("--module", is_flag=True, help="urdf: convert the file to one module with ports.")
@click.option(
    "--port",
    "ports",
    multiple=True,
    metavar="NAME=LINK:TYPE",
    help="urdf --module: a port, followed by `:male` or `:female` if it has a gender.",
)
@click.option(
    "--effector",
    "effectors",
    multiple=True,
    metavar="LINK",
    help="urdf: make this link an effector.",
)
@click.option(
    "--fix", "fixed", multiple=True, metavar="JOINT[=VALUE]", help="urdf: hold this joint."
)
@click.option(
    "--package", "packages", multiple=True, metavar="NAME=DIR", help="The folder of package://NAME."
)
@click.option(
    "--density",
    type=click.FloatRange(0, min_open=True),
    callback=_finite,
    metavar="KG_PER_M3",
    help="urdf: compute masses from shapes for links without inertial.",
)
@click.option(
    "--arg", "arguments", multiple=True, metavar="NAME:=VALUE", help="An argument of a xacro file."
)
@click.option(
    "--pieces", type=click.IntRange(1), help="The largest number of convex pieces of a mesh."
)
@click.option(
    "--detail",
    type=click.FloatRange(0, 1, min_open=True),
    callback=_finite,
    help="The share that convex pieces may add to the volume of a mesh; default 0.1.",
)
@click.option("--any-end", is_flag=True, help="timor: modules may stand on any of their ends.")
@click.option(
    "--modules",
    type=PathOf(path_type=Path),
    metavar="SET",
    help="cobra: a module set of Timor, or a spec with a grammar from ports.",
)
@click.option("--base", metavar="MODULE", help="cobra: the module of the set that is the base.")
@click.option("--any-order", is_flag=True, help="cobra: leave the order of goals open.")
@click.option("--cost", metavar="COSTS", help="cobra: what to minimise, for example `mass,cyc`.")
@click.option(
    "--unit",
    type=click.Choice(["mm", "cm", "m", "in"]),
    help="scene: the unit of STL and OBJ (default: m); replaces that of DAE and GLB.",
)
@click.option(
    "--at", metavar="PLACE", help="scene: the position of its origin, such as `(0.5, 0, 0) m`."
)
@click.option("--force", is_flag=True, help="Replace existing files.")
def import_(
    kind: str,
    file: Path,
    output: Path | None,
    force: bool,  # noqa: FBT001
    **options: Any,
) -> int:
    """Convert a robot, modules, a task or a scene from another tool to a spec.

    The first argument is the kind of FILE: `urdf` (or xacro) is a robot or, with --module, one
    module; `timor` is a set of modules, or its folder; `cobra` is a task; `scene` is obstacles.
    Everything that is omitted is listed, also in a comment at the top of the spec.  srgc reads no
    file outside the folder of FILE, except below those that --package and --modules name.
    """
    place, known = KINDS[kind]
    given = {name: value for name, value in options.items() if value not in (None, (), False)}
    _refuse(kind, given, known)
    try:
        # Meshes are written to a folder with the same name as the spec.
        stem = None if output is None or output == Path("-") else output.stem
        imported = _function(place)(file, stem=stem, **{name: options[name] for name in known})
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in LIBRARIES:
            raise
        raise UsageFault(
            f'an import needs the library {error.name}: pip install "srgc[import]"'
        ) from None
    for warning in imported.warnings:
        click.echo(warning.finding(colour=colours(sys.stderr)), err=True, color=True)
    for remark in imported.remarks:
        click.echo(f"note: {remark}", err=True)
    if output == Path("-"):
        click.echo(imported.text.encode(), nl=False)
        return 0
    from srgc.imports.written_import import write_import

    path = output or Path(f"{imported.name}.srg")
    write_import(imported, path, force=force)
    click.echo(f"{path}")
    for folder, count in Counter(name.rpartition("/")[0] for name in imported.files).items():
        meshes = "1 mesh" if count == 1 else f"{count} meshes"
        click.echo(f"{path.parent / folder}: {meshes}")
    return 0


def _refuse(kind: str, given: Mapping[str, object], known: frozenset[str]) -> None:
    """Refuse options that do not apply to this kind of import."""
    spelt = {
        parameter.name: parameter.opts[-1]
        for parameter in import_.params
        if isinstance(parameter, click.Option)
    }
    for name in given:
        if name not in known:
            raise UsageFault(f"{spelt[name]} does not go with `srgc import {kind}`")


def _function(place: str) -> Callable[..., Imported]:
    """Import and return the function at ``module:name``."""
    from importlib import import_module

    module, _, name = place.partition(":")
    found: Callable[..., Imported] = getattr(import_module(module), name)
    return found
