"""The export of a result folder, written where its user wants it."""

from __future__ import annotations

from dataclasses import dataclass
from os.path import realpath
from pathlib import Path

from srgc.exports.design_export import FOLDER_FILES, FOLDERS, export_bytes, export_folder
from srgc.exports.design_robot import remarks
from srgc.faults import UsageFault
from srgc.output_file import write_output
from srgc.results.found_design import found_design
from srgc.results.result_folder import OWN_FILES, OWN_FOLDERS


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
    if output is not None:
        _spare_results(output, folder)
    design = found_design(folder)
    content = export_bytes(design, form, efforts=efforts)
    notes = remarks(design)
    if output is None:
        return WrittenExport((), content, notes)
    write_output(output, content)
    return WrittenExport((output,), None, notes)


def _written_folder(folder: Path, form: str, output: Path | None) -> WrittenExport:
    if output is None:
        raise UsageFault(f"--to {form} writes several files; name a folder with -o")
    for name in FOLDER_FILES:
        _spare_results(output / name, folder)
    made = export_folder(found_design(folder), form)
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageFault(f"{output}: {error.strerror}") from None
    for name, content in made.files.items():
        write_output(output / name, content)
    return WrittenExport(tuple(output / name for name in sorted(made.files)), None, made.notes)


def _spare_results(output: Path, folder: Path) -> None:
    """Refuse a path that is, links followed, where ``synth`` writes in its folder.

    Raises:
        UsageFault: it is.
    """
    top, target = Path(realpath(folder)), Path(realpath(output))
    if top in target.parents and target.relative_to(top).parts[0] in (*OWN_FILES, *OWN_FOLDERS):
        raise UsageFault(f"{output} is one of the results; write the export elsewhere")
