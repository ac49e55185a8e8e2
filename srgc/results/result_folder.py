"""The folder that a synthesis writes: the identity of its results, and a journal for resuming."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solvers.verdict import MISSION
from solvers.verifier.claims.spec_copy import bounded_bytes, bounded_text
from srgc.faults import WITH_O, UsageFault, argument
from srgc.paths import unwritable
from srgc.results.earlier_results import keep_aside
from srgc.results.folder_writer import (
    JOURNAL,
    OWN_FILES,
    OWN_FOLDERS,
    UNFINISHED,
    FolderWriter,
    only_writer,
    refuse_links,
)

if TYPE_CHECKING:
    from solvers.run_context import Recorded


@dataclass(frozen=True, slots=True)
class Identity:
    """The search to which a folder's results belong.

    ``least_cells`` is the number of cells that the search began with.  ``all_designs``: the search
    went on after the first design.  ``solver`` solves its convex programs (None for our own), and
    ``search`` searches its parameters (None for the default).  ``paths`` and ``evaluations`` are
    budgets (None for the defaults).  ``one_by_one``: there were no lemmas.  ``smt`` names the
    solvers of scripts (None for z3 as a library).  ``gap`` is the gap to close, in percent (None
    for no gap).  ``front``: only designs that no other dominates are kept.  ``mission`` is the name
    of the mission, whose tasks are listed in ``task``.  ``origin`` is a digest of the robot that a
    step begins with, and of its prices.
    """

    spec_sha256: str
    task: str
    seed: int
    version: str
    least_cells: int | None = None
    all_designs: bool = False
    solver: str | None = None
    search: str | None = None
    paths: int | None = None
    evaluations: int | None = None
    one_by_one: bool = False
    smt: str | None = None
    gap: float | None = None
    front: bool = False
    mission: str | None = None
    origin: str | None = None


@dataclass(slots=True)
class ResultFolder:
    """An opened result folder with its ``files``; it is also the journal of the synthesis.

    ``kept`` is the path to which results of an earlier version of the spec were moved.
    """

    path: Path
    identity: Identity
    values: dict[str, Recorded] = field(default_factory=dict[str, Any])
    kept: Path | None = None
    files: FolderWriter = field(init=False)

    def __post_init__(self) -> None:
        self.files = FolderWriter(self.path)

    def recall(self, key: str) -> Recorded:
        """The result of a step that this or an earlier, interrupted run has finished, or None."""
        return self.values.get(key)

    def record(self, key: str, value: Recorded) -> None:
        """Record a finished step, as one line that is written at once."""
        self.values[key] = value
        self.files.append(JOURNAL, json.dumps([key, value]) + "\n")

    def holds_design(self) -> bool:
        """Whether a run of the same synthesis has left a design with its certificate."""
        try:
            verdict = json_object(self.path / "design.json", needed=False).get("verdict")
        except UsageFault:
            return False
        return verdict == "found" and (self.path / "certificate.json").is_file()

    def finish(self) -> None:
        """Remove the journal: the run is complete."""
        self.files.discard(JOURNAL)


@contextmanager
def open_folder(
    path: Path, identity: Identity, *, force: bool, spec: str | None = None
) -> Iterator[ResultFolder]:
    """Open or make a result folder; an interrupted run of the same synthesis is resumed.

    Nobody else writes to the folder within the block.  Results of the same command from before its
    spec was edited are kept: without ``force``, their folder is moved to ``PATH.1`` and so on.

    Args:
        path: the folder.
        identity: the identity of the new results.
        force: whether to replace other results.
        spec: the name of the main file of a spec that may have been edited; None to move nothing.

    Raises:
        UsageFault: somebody else writes to the folder; it has other results or other files, and
            ``force`` is not given; a link has the name of one of srgc's files or folders; or the
            folder cannot be written.
    """
    kept = None
    with ExitStack() as locks:
        locks.enter_context(_held(path))
        if not force and _is_edited(path, identity, spec):
            kept = keep_aside(path)
            locks.enter_context(_held(path))
        folder = _opened(path, identity, force=force)
        folder.kept = kept
        yield folder


@contextmanager
def _held(path: Path) -> Iterator[None]:
    """Make a folder and lock it in the block; it must have no links."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None
    if not os.access(path, os.W_OK):
        raise UsageFault(f"{path} cannot be written; choose another folder", WITH_O)
    with only_writer(path):
        refuse_links(path)
        yield


def _is_edited(path: Path, identity: Identity, spec: str | None) -> bool:
    """Whether a folder has results of the same command from before its inputs were edited.

    The inputs are the spec and, for a step, its initial robot with the prices.
    """
    owner = _owner(path)
    if spec is None or owner is None or owner == identity:
        return False
    same_file = (path / "spec" / spec).is_file() or not (path / "spec").is_dir()
    same_kind = (owner.origin is None) == (identity.origin is None)
    again = replace(owner, spec_sha256=identity.spec_sha256, origin=identity.origin)
    return same_file and same_kind and again == identity


def _opened(path: Path, identity: Identity, *, force: bool) -> ResultFolder:
    folder = ResultFolder(path, identity)
    owner = _owner(path)
    ours = [name for name in OWN_FOLDERS if (path / name).exists()]
    if owner is None and ours and (force or holds_claim(path)):
        # They may belong to somebody else: they must neither be mixed with results nor deleted.
        raise UsageFault(
            f"{path} has a `{ours[0]}` but no design.json to tell whose it is; choose another "
            "folder"
        )
    if owner is None and not force and any(item.name not in UNFINISHED for item in path.iterdir()):
        raise UsageFault(
            f"{path} is not empty and holds no results; ",
            argument("force"),
            " uses it all the same",
        )
    if owner is not None and owner != identity and not force:
        raise UsageFault(
            f"{path} holds the results of another {_difference(owner, identity)}; "
            "choose another folder, or ",
            argument("force"),
            " to replace them",
        )
    if owner is None or owner == identity:
        folder.values.update(_journal_values(path / JOURNAL))
    else:
        for name in (*OWN_FILES, *OWN_FOLDERS):
            folder.files.discard(name)
    folder.files.write(JOURNAL, _journal_text(identity, folder.values))
    return folder


def copy_results(source: Path, target: Path, *, force: bool) -> Path:
    """Copy the results of a folder, with the journal of an unfinished run.

    Raises:
        UsageFault: the source has no results or has a link, or the target cannot be used
            (``open_folder``).
    """
    refuse_links(source)
    identity = _owner(source)
    if identity is None:
        raise UsageFault(f"{source} holds no results")
    if source.resolve() == target.resolve():
        return target
    files = {
        path.relative_to(source).as_posix(): path.read_bytes()
        for path in sorted(source.rglob("*"))
        if path.is_file() and path.relative_to(source).parts[0] in (*OWN_FILES, *OWN_FOLDERS)
    }
    with open_folder(target, identity, force=force) as folder:
        for name in (*OWN_FILES, *OWN_FOLDERS):
            if name != JOURNAL and not any(file.split("/")[0] == name for file in files):
                folder.files.discard(name)
        for name, content in files.items():
            folder.files.write(name, content)
        for top in OWN_FOLDERS:
            if (target / top).is_dir():
                folder.files.keep_only(top, {name[len(top) + 1 :] for name in files})
        if JOURNAL not in files:
            folder.finish()
    return target


def _journal_text(identity: Identity, values: Mapping[str, Recorded]) -> str:
    """A whole journal; writing it removes a line cut by a kill before the next one is appended."""
    lines = (asdict(identity), *values.items())
    return "".join(f"{json.dumps(line)}\n" for line in lines)


def _difference(a: Identity, b: Identity) -> str:
    told = {
        "spec_sha256": "spec",
        "least_cells": "number of cells",
        "all_designs": "search, for all designs or for the first",
        "search": "search of parameters",
        "paths": "number of paths",
        "evaluations": "number of evaluations",
        "one_by_one": "search, with lemmas or without",
        "smt": "SMT solver",
        "gap": "gap to be closed",
        "front": "search, for all designs or for those that none dominates",
        "origin": "robot to begin with, or other prices",
    }
    for name in (item.name for item in fields(Identity)):
        if getattr(a, name) != getattr(b, name):
            return told.get(name, name)
    return "run"


def _owner(path: Path) -> Identity | None:
    """The identity of the folder's results, or None."""
    for name in (JOURNAL, "design.json"):
        try:
            text = bounded_text(path / name)
            content = json.loads(text.partition("\n")[0] if name == JOURNAL else text)
            return Identity(
                str(content["spec_sha256"]),
                str(content["task"]),
                int(content["seed"]),
                str(content["version"]),
                None if content.get("least_cells") is None else int(content["least_cells"]),
                bool(content.get("all_designs", False)),
                None if content.get("solver") is None else str(content["solver"]),
                None if content.get("search") is None else str(content["search"]),
                None if content.get("paths") is None else int(content["paths"]),
                None if content.get("evaluations") is None else int(content["evaluations"]),
                bool(content.get("one_by_one", False)),
                None if content.get("smt") is None else str(content["smt"]),
                None if content.get("gap") is None else float(content["gap"]),
                bool(content.get("front", False)),
                None if content.get("mission") is None else str(content["mission"]),
                None if content.get("origin") is None else str(content["origin"]),
            )
        except (OSError, ValueError, LookupError, TypeError, ArithmeticError, RecursionError):
            continue
    return None


def _journal_values(path: Path) -> dict[str, Recorded]:
    """The steps of a journal; a last line that a kill has cut is ignored."""
    values: dict[str, Recorded] = {}
    try:
        lines = bounded_bytes(path).split(b"\n")[1:]
    except OSError:
        return values
    for line in lines:
        try:
            key, value = json.loads(line)
            values[str(key)] = value
        except (ValueError, TypeError, RecursionError):
            break
    return values


def holds_claim(folder: Path) -> bool:
    """Whether a folder has the certificate of a task or of a mission."""
    return any((folder / name).is_file() for name in ("certificate.json", MISSION))


# --- The object in a JSON file of a result folder -------------------------------------------------


def json_object(path: Path, *, needed: bool = True) -> dict[str, Any]:
    """The object in a file; empty if the file is missing and not ``needed``.

    Raises:
        UsageFault: the file has no object, or cannot be read.
    """
    try:
        content = json.loads(bounded_bytes(path))
    except OSError as error:
        if not needed and not path.exists():
            return {}
        raise UsageFault(f"{path}: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise UsageFault(f"{path} is not JSON") from None
    if not isinstance(content, dict):
        raise UsageFault(f"{path} is not a JSON object")
    return content
