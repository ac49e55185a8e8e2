"""Write the files of an import: the spec and its meshes."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from srgc.faults import UsageFault
from srgc.imports.source_warning import SourceWarning


@dataclass(frozen=True, slots=True)
class Imported:
    """The result of an import.

    Attributes:
        name: the default name of its file, without the extension.
        text: the spec.
        files: maps the paths of the meshes, relative to the spec and with ``/``, to their bytes.
        remarks: what could not be carried over or was changed, one a line.
        warnings: the same for things that have a place in the file.
    """

    name: str
    text: str
    files: Mapping[str, bytes] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    warnings: tuple[SourceWarning, ...] = ()


def mesh_folder(stem: str) -> str:
    """The name of the folder for the meshes of a spec: ``ur5_meshes`` for ``ur5.srg``.

    It is in the folder of the spec.  Characters that a path in a spec cannot hold become ``_``.
    """
    plain = re.sub(r"[^\w .+-]", "_", stem)
    return f"{plain}_meshes"


def write_import(imported: Imported, path: Path, *, force: bool) -> list[Path]:
    """Write the files of an import, the spec last; return their paths.

    If it fails, no file is written, and existing files are kept.

    Raises:
        UsageFault: a file exists already and ``force`` is not set, another spec in the folder names
            a mesh that would change, or a file cannot be written.
    """
    if path.is_dir():
        raise UsageFault(f"{path} is a folder; `-o` names a file")
    contents = {path.parent / name: data for name, data in imported.files.items()}
    contents[path] = imported.text.encode()
    changed = [p for p, data in contents.items() if os.path.lexists(p) and not _same(p, data)]
    for place in changed:
        if place.is_dir() and not place.is_symlink():
            raise UsageFault(f"{place} is a folder, and a file of that name is to be written")
    _refuse_shared([p for p in changed if p != path], path)
    if changed and not force:
        raise UsageFault(f"{changed[0]} is there already; --force replaces it")
    staged = list[Path]()
    try:
        for place, data in contents.items():
            place.parent.mkdir(parents=True, exist_ok=True)
            staged.append(_empty_beside(place))
            staged[-1].write_bytes(data)
        for before, place in zip(staged, contents, strict=True):
            before.replace(place)
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    finally:
        for before in staged:
            before.unlink(missing_ok=True)
    return list(contents)


def _refuse_shared(meshes: list[Path], path: Path) -> None:
    """Reject changes to meshes that other specs in the folder of ``path`` name.

    Raises:
        UsageFault: another spec names one of them.
    """
    if not meshes:
        return
    for spec in sorted(path.parent.glob("*.srg")):
        if spec.name == path.name or not spec.is_file():
            continue
        try:
            text = spec.read_bytes()
        except OSError as error:
            raise UsageFault(f"{spec}: {error.strerror}; it may name {meshes[0]}") from None
        for mesh in meshes:
            if f'"{mesh.relative_to(path.parent).as_posix()}"'.encode() in text:
                raise UsageFault(
                    f"{mesh} is there already, and {spec} needs it as it is; "
                    "`-o` with another name or folder keeps both"
                )


def _same(place: Path, data: bytes) -> bool:
    try:
        return place.is_file() and not place.is_symlink() and place.read_bytes() == data
    except OSError:  # what cannot be read is not known to be the same
        return False


def _empty_beside(place: Path) -> Path:
    """Create an empty file in the same folder, to replace ``place`` once all files are written."""
    descriptor, name = tempfile.mkstemp(dir=place.parent, prefix=f".{place.name}.")
    os.close(descriptor)
    Path(name).chmod(0o666 & ~_umask())
    return Path(name)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
