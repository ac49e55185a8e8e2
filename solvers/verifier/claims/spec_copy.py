"""The files of a result folder, plain and of a bounded size; and its copy of the spec."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from errno import ENOENT
from pathlib import Path

from grammar_lang import ir
from grammar_lang.files.source_file import LIMIT, NoRegularFile, TooLarge, read_file
from grammar_lang.load import load
from grammar_lang.source import Source
from solvers.verifier.claims.certificate import CertificateError, spec_digest, spec_files

# --- One file of a result folder, which anybody may have written: plain, and of a bounded size ----


MOST_BYTES = 2**28
"""Far more than any result has; what is larger would only fill the memory."""


def bounded_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        OSError: it cannot be read, or is larger than any result.
    """
    try:
        return read_file(path, MOST_BYTES)
    except TooLarge as large:
        said = f"{path.name} has {large.size:,} bytes, more than {MOST_BYTES:,}"
        raise NoRegularFile(0, said) from None


def bounded_text(path: Path) -> str:
    """The same as text.

    Raises:
        OSError: as of :func:`bounded_bytes`.
        UnicodeDecodeError: it is not UTF-8.
    """
    return bounded_bytes(path).decode("utf-8")


def evidence_bytes(folder: Path, name: str) -> bytes:
    """A file below a folder by the name that a certificate, which may say anything, gives it.

    Raises:
        OSError: the name is none of a file in the folder, or it cannot be read.
    """
    try:
        inside = (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # a name too long, links in a circle, a NUL
        inside = False
    if not inside:
        raise FileNotFoundError(ENOENT, "it is no file of the folder")
    return bounded_bytes(folder / name)


# --- The copy of a spec in a result folder: the file, what it includes, maps and their images -----
#
# A claim is about all of these files, byte for byte, under the paths that they have below the
# folder of the main file.


def files_of(sources: Iterable[Source]) -> dict[str, bytes]:
    """The files of a program by their paths below the folder of the main file."""
    return {source.path: source.data for source in sources}


def read_copy(folder: Path, spec: str, digest: str) -> tuple[ir.Program, dict[str, bytes]]:
    """The program in a folder of copies, and its files.

    Args:
        folder: the folder.
        spec: the path of the main file in it.
        digest: that of all files.

    Raises:
        CertificateError: a file is missing, altered or one too many, or the program has errors.
        OSError: a file cannot be read.
    """
    files = spec_files(folder)
    if spec not in files or "/" in spec:
        raise CertificateError(f"the spec `{spec}` is missing from {folder}")
    if spec_digest(files) != digest:
        raise CertificateError(
            "the spec has been altered: its digest is not the one in the certificate"
        )
    loaded = load(folder / spec)
    if loaded.program is None:
        raise CertificateError("the spec has errors")
    path = difference(files, files_of(loaded.sources))
    if path is not None:
        raise CertificateError(f"the spec does not include `{path}`, which is in {folder}")
    return loaded.program, files


def difference_from(files: Mapping[str, bytes], spec: str, other: Path) -> str | None:
    """Where a copy and another file with all that it includes differ: a path, or None.

    How the other main file is called does not matter; what it includes, it includes by name.

    Raises:
        OSError: the other file cannot be read.
    """
    try:
        content = read_file(other, LIMIT)
    except TooLarge:
        return spec
    theirs = files_of(load(other).sources[1:])
    return difference(files, {**theirs, spec: content})


def difference(files: Mapping[str, bytes], others: Mapping[str, bytes]) -> str | None:
    """The first path at which not both hold the same bytes."""
    paths = sorted(files.keys() | others.keys())
    return next((path for path in paths if files.get(path) != others.get(path)), None)
