"""The files of a result folder, plain and of a bounded size; and its copy of the spec."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from errno import ENOENT
from pathlib import Path

from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.partition import Cut
from grammar_lang import ir
from grammar_lang.files.file_tree import LIMIT, NoRegularFile, TooLarge, read_file
from grammar_lang.load import load
from grammar_lang.source import Source
from solvers.verifier.claims.certificate import (
    CertificateError,
    Claim,
    FoundClaim,
    exact_cuts,
    from_text,
    spec_digest,
    spec_files,
)
from solvers.verifier.report import Outcome, Refused

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
        raise FileNotFoundError(ENOENT, "it is not a file of the folder")
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


# --- What a claim is about: the folder's own copy of the spec, its task, its cells ----------------


@dataclass(frozen=True, slots=True)
class ClaimedTask:
    """A claim with the program and the task that it is about; ``cells`` are cut as it says.

    ``task`` is that of the motion that a robot is claimed with, of its number of steps; ``asked``
    is the task as it is stated.
    """

    claim: Claim
    program: ir.Program
    task: ir.Task
    cells: Abstraction
    asked: ir.Task


def read_claim(folder: Path) -> Claim:
    """What the certificate of a result folder claims.

    Raises:
        CertificateError: the certificate is none.
        OSError, UnicodeDecodeError: it cannot be read.
    """
    return from_text(bounded_text(folder / "certificate.json"))


def claimed_task(folder: Path, claim: Claim, spec: Path | None = None) -> ClaimedTask:
    """A claim with what it is about.

    Args:
        folder: the result folder that it is from.
        claim: the claim.
        spec: a spec file it must be about, besides the folder's own copy.

    Raises:
        CertificateError: the copy of the spec is not the one that is claimed.
        Refused: it is about another spec, or cannot be judged.
        OSError: the copy cannot be read.
    """
    program = spec_of(folder, claim.spec, claim.spec_sha256, spec)
    task = program.tasks.get(claim.task)
    if task is None:
        raise Refused(f"the spec has no task `{claim.task}`")
    try:
        program, task = expanded(program, task)
    except MapFault as fault:
        raise Refused(f"the spec has errors: {fault.message}") from None
    cells = _cells(program.workspaces[task.workspace])
    asked = task
    if isinstance(claim, FoundClaim):
        cells, task = _cut(cells, claim), task_of_motion(claim, asked)
    return ClaimedTask(claim, program, task, cells, asked)


def task_of_motion(claim: FoundClaim, task: ir.Task) -> ir.Task:
    """The task of motions of as many steps as a claim has, where the task leaves their number open.

    Raises:
        Refused: they are too many, or none.
    """
    if not task.at_most:
        return task
    if not task.fewest_steps <= claim.steps <= task.steps:
        allowed = f"{task.fewest_steps} to {task.steps}"
        raise Refused(f"the motion has {claim.steps} steps, and {allowed} are allowed")
    return task.lasting(claim.steps)


def spec_of(folder: Path, spec: str, digest: str, other: Path | None) -> ir.Program:
    """The program of a folder's own copy of a spec.

    Args:
        folder: the result folder.
        spec: the main file that a claim names.
        digest: that of all files, which it names, too.
        other: a file that the claim must be about, besides the copy.

    Raises:
        CertificateError: the copy is another one.
        Refused: the other file is.
        OSError: the copy cannot be read.
    """
    program, files = read_copy(folder / "spec", spec, digest)
    if other is not None:
        try:
            path = difference_from(files, spec, other)
        except OSError as error:
            raise Refused(f"{other}: {error.strerror}", Outcome.UNDECIDED) from None
        if path is not None:
            where = "" if path == spec else f" in `{path}`"
            raise Refused(f"the certificate is not about {other}: the files differ{where}")
    return program


def _cells(workspace: ir.Workspace) -> Abstraction:
    """The cells of the spec's workspace, which has errors where it has none."""
    try:
        return abstract(workspace)
    except ValueError as error:
        raise Refused(f"the spec has errors: {error}") from None


def _cut(cells: Abstraction, claim: FoundClaim) -> Abstraction:
    """The cells after the cuts of a claim, which are made in turn."""
    cuts = [Cut(cell, half_space) for cell, half_space in exact_cuts(claim.cuts)]
    if any(len(cut.half_space.normal) != cells.dimension for cut in cuts):
        raise Refused(f"a cut of a cell is not given by {cells.dimension} coordinates")
    try:
        return cells.cut(cuts)
    except ValueError as error:
        raise Refused(f"the cells cannot be cut as claimed: {error}") from None
