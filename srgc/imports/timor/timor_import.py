"""``srgc import timor``: import a module set of Timor as modules with ports and a grammar."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from srgc.imports.body_meshes import BodyMeshes
from srgc.imports.json_place import json_file
from srgc.imports.module_set import ModuleSet
from srgc.imports.names import Names
from srgc.imports.source_fault import file_fault
from srgc.imports.source_files import source_files
from srgc.imports.spec_text import spec_text
from srgc.imports.timor.mesh_hulls import MeshHulls
from srgc.imports.timor.mounted_module import Mounting, mounted_module
from srgc.imports.timor.mountings import arranged, mountings_of, open_module
from srgc.imports.timor.port_types import PortTypes
from srgc.imports.timor.set_data import EFFECTOR, SetData, read_set
from srgc.imports.written_import import Imported, mesh_folder

FILE = "modules.json"
"""Timor's name for the file of a set, in a folder with the name of the set."""
LIKE_OURS = "rigid_via_joint"
"""The choice of colliding neighbours that matches ``avoid self with body``."""


@dataclass(slots=True)
class ReadSet:
    """A set as modules of the language.

    Attributes:
        name: the name of its grammar.
        modules: the modules to write, with all remarks.
        files: the meshes that they name.
        mounted: maps names of modules of the language to how they stand on others.
        types: the types of ports.
    """

    name: str
    modules: ModuleSet
    files: dict[str, bytes]
    mounted: dict[str, Mounting]
    types: PortTypes


@dataclass(frozen=True, slots=True)
class SetOptions:
    """Options for reading a set.

    Attributes:
        name: the name of the grammar and the prefix of the modules' names; by default the grammar
            has the name of the folder, and modules have no prefix.
        any_end: modules may stand on any of their connectors.
        pieces: the most convex pieces of a mesh.
        detail: the share of the volume of a mesh that its pieces may add.
        stem: the name of the spec without its extension, from which the folder of meshes is named;
            if None, the name of the grammar.
    """

    name: str | None = None
    any_end: bool = False
    pieces: int | None = None
    detail: float | None = None
    stem: str | None = None


def timor_import(
    file: Path,
    *,
    name: str | None = None,
    exact: bool = False,
    any_end: bool = False,
    pieces: int | None = None,
    detail: float | None = None,
    stem: str | None = None,
) -> Imported:
    """The spec of a module set.

    Args:
        file: ``modules.json``, or its folder.
        name: see :class:`SetOptions`.
        exact: keep angles and lengths as they are.
        any_end: see :class:`SetOptions`.
        pieces: see :class:`SetOptions`.
        detail: see :class:`SetOptions`.
        stem: see :class:`SetOptions`.

    Raises:
        UsageFault: the file cannot be read, or violates the schema.
    """
    found = read_modules(file, SetOptions(name, any_end, pieces, detail, stem))
    text = spec_text(found.modules, exact=exact)
    return Imported(_file_name(found.name), text, found.files, tuple(found.modules.remarks))


def read_modules(file: Path, options: SetOptions) -> ReadSet:
    """Read the modules of a set, before they are written as text."""
    path = file / FILE if file.is_dir() else file
    if file.is_dir() and not path.is_file():
        raise file_fault(file, f"there is no {FILE} in it")
    files = source_files(path)
    place = json_file(files)
    data = read_set(place)
    folder = path.absolute().parent.name
    called_like = folder if path.name == FILE else path.stem
    family = Names().camel(options.name or called_like, "Modules")
    prefix = "" if options.name is None else f"{family}_"
    types = PortTypes(each for module in data.modules for each in module.connectors)
    result = ModuleSet(comments=_comments(data, path, folder))
    names = Names()
    folder_of_meshes = mesh_folder(options.stem or _file_name(family))
    meshes = BodyMeshes(files, folder_of_meshes, result.remarks, options.pieces, options.detail)
    named = list[tuple[str, Mounting]]()
    for module in data.modules:
        ways = mountings_of(module, any_end=options.any_end)
        if not ways:
            result.remarks.append(f"{module.place.path}: nothing can carry it; it is left out")
        for way in ways:
            wanted = _wanted(module.id, module.name)
            end = f"_{way.entry.id}" if len(ways) > 1 else ""
            named.append((names.name(f"{prefix}{Names().camel(wanted, 'Module')}{end}"), way))
    arrangement = arranged(named, names, family)
    hulls = MeshHulls(meshes)
    for called, way in named:
        result.modules.append(mounted_module(way, called, types, hulls, result.remarks))
    has_tip = any(each.type == EFFECTOR for m in data.modules for each in m.connectors)
    for called, left_open in arrangement.open_ends.items():
        result.modules.append(open_module(called, left_open, types, effector=not has_tip))
    result.families += arrangement.families
    result.remarks += [*arrangement.remarks, *_remarks(data, any_end=options.any_end)]
    result.remarks += [f"{unread}: an unknown key" for unread in place.unread.places]
    return ReadSet(family, result, meshes.written, dict(named), types)


def _wanted(identifier: str, called: str) -> str:
    """The ID if it begins like a name, otherwise the name of the module."""
    return identifier if identifier[:1].isalpha() or not called[:1].isalpha() else called


def _file_name(family: str) -> str:
    """The file name of a grammar: ``geometric_primitives`` for ``GeometricPrimitives``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", family).lower()


def _comments(data: SetData, path: Path, folder: str) -> list[str]:
    authors = dict.fromkeys(author for module in data.modules for author in module.authors)
    by = f", by {', '.join(authors)}" if authors else ""
    return [
        f"Modules of Timor{by}, imported from {folder}/{path.name}.",
        "",
    ]


def _remarks(data: SetData, *, any_end: bool) -> list[str]:
    found = list[str]()
    bodies = [body for module in data.modules for body in module.bodies]
    visuals = sum(shape.kind != "mesh" for body in bodies for shape in body.visuals)
    if visuals:
        found.append(f"{visuals} shapes for pictures that are no meshes: those show what collides")
    if any(module.cost for module in data.modules):
        found.append("costs stand in comments: write `const price = ...;` to minimize their sum")
    if data.collisions != LIKE_OURS:
        found.append(
            f"ignore_collisions is {data.collisions}: `avoid self with body` does not compare "
            "links that one joint connects, Timor some of their bodies"
        )
    if any_end:
        return found
    for module in data.modules:
        ends = mountings_of(module, any_end=False)
        if len(ends) > 1:
            shown = ", ".join(end.entry.id for end in ends)
            found.append(f"{module.place.path}: it may stand on {shown}: a module for each")
    return found
