"""An import as files: the text, and the meshes beside it."""

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
    """What an import gives.

    Attributes:
        name: how its file is called if nothing else is asked for, without the end.
        text: the spec.
        files: by their paths relative to the spec, with ``/``, meshes that it names.
        remarks: what could not be carried over or was changed, one a line.
        warnings: what of it has a place in the file.
    """

    name: str
    text: str
    files: Mapping[str, bytes] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    warnings: tuple[SourceWarning, ...] = ()


def mesh_folder(stem: str) -> str:
    """The folder of the meshes of a spec, beside it: that of ``ur5.srg`` is ``ur5_meshes``.

    What a path in a text would not hold becomes ``_``.
    """
    plain = re.sub(r"[^\w .+-]", "_", stem)
    return f"{plain}_meshes"


def write_import(imported: Imported, path: Path, *, force: bool) -> list[Path]:
    """Write the files of an import, the spec last; the paths written.

    Raises:
        UsageFault: a file is there already and ``force`` is not set, another spec in the folder
            names a mesh that would change, or a file cannot be written; then nothing is left of it.
    """
    if path.is_dir():
        raise UsageFault(f"{path} is a folder; `-o` names a file")
    contents = {path.parent / name: data for name, data in imported.files.items()}
    contents[path] = imported.text.encode()
    changed = [p for p, data in contents.items() if os.path.lexists(p) and not _same(p, data)]
    _refuse_shared([p for p in changed if p != path], path)
    if changed and not force:
        raise UsageFault(f"{changed[0]} is there already; --force replaces it")
    written = list[Path]()
    try:
        for place, data in contents.items():
            place.parent.mkdir(parents=True, exist_ok=True)
            _replace(place, data)
            written.append(place)
    except OSError as error:
        for place in written:
            place.unlink(missing_ok=True)
        raise UsageFault(f"{path}: {error.strerror}") from None
    return written


def _refuse_shared(meshes: list[Path], path: Path) -> None:
    """Refuse to change meshes that other specs in the folder of ``path`` name.

    Raises:
        UsageFault: one does.
    """
    if not meshes:
        return
    for spec in sorted(path.parent.glob("*.srg")):
        if spec.name == path.name or not spec.is_file():
            continue
        text = spec.read_bytes()
        for mesh in meshes:
            if f'"{mesh.relative_to(path.parent).as_posix()}"'.encode() in text:
                raise UsageFault(
                    f"{mesh} is there already, and {spec} needs it as it is; "
                    "`-o` with another name or folder keeps both"
                )


def _same(place: Path, data: bytes) -> bool:
    return place.is_file() and not place.is_symlink() and place.read_bytes() == data


def _replace(place: Path, data: bytes) -> None:
    """Write a file under a name of its own first, so that it is there as a whole or not at all."""
    descriptor, name = tempfile.mkstemp(dir=place.parent, prefix=f".{place.name}.")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        Path(name).chmod(0o666 & ~_umask())
        Path(name).replace(place)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
