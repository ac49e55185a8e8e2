"""The export of a result folder, written where its user wants it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from srgc.exports.design_export import FOLDER_FILES, FOLDERS, export_bytes, export_folder
from srgc.exports.design_robot import remarks
from srgc.faults import UsageFault
from srgc.results.folder_output import folder_output
from srgc.results.found_design import found_design


@dataclass(frozen=True, slots=True)
class WrittenExport:
    """The files that were written, or the content where none was named; notes for a reader."""

    files: tuple[Path, ...]
    content: bytes | None
    notes: tuple[str, ...]


def written_export(
    folder: Path, form: str, output: Path | None, *, efforts: bool = True
) -> WrittenExport:
    """Export a result folder.

    Args:
        folder: one that ``synth`` has written, with the verdict found.
        form: one of the ``FORMS`` or ``FOLDERS``.
        output: the file to write, or for ``FOLDERS`` the folder, which is made; None: nothing is
            written.
        efforts: whether a ROS 2 message has efforts.

    Raises:
        UsageFault: there is no robot, the format cannot hold it, the output is one of the results
            or cannot be written, or a folder is due and none is named.
    """
    if form in FOLDERS:
        return _written_folder(folder, form, output)
    file = None if output is None else folder_output(folder, output)
    design = found_design(folder)
    content = export_bytes(design, form, efforts=efforts)
    notes = remarks(design)
    if file is None:
        return WrittenExport((), content, notes)
    file.write(content)
    return WrittenExport((file.path,), None, notes)


def _written_folder(folder: Path, form: str, output: Path | None) -> WrittenExport:
    if output is None:
        raise UsageFault(f"--to {form} writes several files; name a folder with -o")
    files = {name: folder_output(folder, output / name) for name in FOLDER_FILES}
    made = export_folder(found_design(folder), form)
    if any(files[name].name is None for name in made.files):
        try:
            output.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageFault(f"{output}: {error.strerror}") from None
    for name, content in made.files.items():
        files[name].write(content)
    return WrittenExport(tuple(output / name for name in sorted(made.files)), None, made.notes)
