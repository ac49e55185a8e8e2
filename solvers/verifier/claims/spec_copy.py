"""Read the files of a result folder, of bounded size, and its copy of the spec."""

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

# --- One file of a result folder; anybody may have written it, so its size is bounded -------------


MOST_BYTES = 2**28
"""Far more than any result has; a larger file would only fill the memory."""


def bounded_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        OSError: the file cannot be read, or is larger than any result.
    """
    try:
        return read_file(path, MOST_BYTES)
    except TooLarge as large:
        said = f"{path.name} has {large.size:,} bytes, more than {MOST_BYTES:,}"
        raise NoRegularFile(0, said) from None


def bounded_text(path: Path) -> str:
    """The text of a file.

    Raises:
        OSError: as for :func:`bounded_bytes`.
        UnicodeDecodeError: the file is not UTF-8.
    """
    return bounded_bytes(path).decode("utf-8")


def evidence_bytes(folder: Path, name: str) -> bytes:
    """The bytes of a file below a folder, by the name that an untrusted certificate gives it.

    Raises:
        OSError: the name is not that of a file in the folder, or the file cannot be read.
    """
    try:
        inside = (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # a name too long, links in a circle, a NUL
        inside = False
    if not inside:
        raise FileNotFoundError(ENOENT, "it is not a file of the folder")
    return bounded_bytes(folder / name)


# --- The copy of a spec in a result folder: main file, included files, maps, images ---------------
# A claim is about all of these files, byte for byte, under their paths below the folder of the main
# file.


def files_of(sources: Iterable[Source]) -> dict[str, bytes]:
    """The files of a program by their paths below the folder of the main file."""
    return {source.path: source.data for source in sources}


def read_copy(folder: Path, spec: str, digest: str) -> tuple[ir.Program, dict[str, bytes]]:
    """The program in a folder of copies, and its files.

    Args:
        folder: the folder.
        spec: the path of the main file in it.
        digest: the digest of all files.

    Raises:
        CertificateError: a file is missing, altered or superfluous, or the program has errors.
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
    """The first path at which a copy differs from another spec and its included files, or None.

    The name of the other main file does not matter; included files are compared by name.

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
    """The first path at which the two do not hold the same bytes, or None."""
    paths = sorted(files.keys() | others.keys())
    return next((path for path in paths if files.get(path) != others.get(path)), None)


# --- The subject of a claim: the folder's own copy of the spec, its task, its cells ---------------


@dataclass(frozen=True, slots=True)
class ClaimedTask:
    """A claim with its program and task; ``cells`` are cut as it says.

    ``task`` is the task with the number of steps of the claimed motion; ``asked`` is the task as
    stated.
    """

    claim: Claim
    program: ir.Program
    task: ir.Task
    cells: Abstraction
    asked: ir.Task


def read_claim(folder: Path) -> Claim:
    """The claim of the certificate in a result folder.

    Raises:
        CertificateError: the file is not a certificate.
        OSError, UnicodeDecodeError: it cannot be read.
    """
    return from_text(bounded_text(folder / "certificate.json"))


def claimed_task(folder: Path, claim: Claim, spec: Path | None = None) -> ClaimedTask:
    """A claim with its program, task and cells.

    Args:
        folder: the result folder of the claim.
        claim: the claim.
        spec: a spec file that the claim must be about, in addition to the folder's own copy.

    Raises:
        CertificateError: the copy of the spec is not the one that is claimed.
        Refused: the claim is about another spec, or cannot be judged.
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
    """The task with the number of steps of the claim, if the task leaves this number open.

    Raises:
        Refused: the claim has too many or too few steps.
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
        digest: the digest of all files that the claim names.
        other: a file that the claim must be about, in addition to the copy.

    Raises:
        CertificateError: the copy is not the one that is claimed.
        Refused: the other file differs from the copy.
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
    """The cells of the spec's workspace; a spec without them has errors."""
    try:
        return abstract(workspace)
    except ValueError as error:
        raise Refused(f"the spec has errors: {error}") from None


def _cut(cells: Abstraction, claim: FoundClaim) -> Abstraction:
    """The cells after the cuts of a claim, made in order."""
    cuts = [Cut(cell, half_space) for cell, half_space in exact_cuts(claim.cuts)]
    if any(len(cut.half_space.normal) != cells.dimension for cut in cuts):
        raise Refused(f"a cut of a cell is not given by {cells.dimension} coordinates")
    try:
        return cells.cut(cuts)
    except ValueError as error:
        raise Refused(f"the cells cannot be cut as claimed: {error}") from None
