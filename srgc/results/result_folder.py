"""The folder a synthesis writes: whose results it holds, and a journal to go on from."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from solvers.run_context import Recorded
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


@dataclass(frozen=True, slots=True)
class Identity:
    """What a folder's results belong to.

    ``least_cells`` is how many a search was to begin with; ``all_designs``: it was to go on after
    the first design; ``solver`` is that of its convex programs, None: our own; ``search`` is that
    of its parameters, None: the usual one; ``paths`` and ``evaluations`` are its budgets, None: the
    usual ones; ``one_by_one``: without lemmas; ``smt`` are the solvers of scripts, None: z3 as
    a library; ``gap``, in percent, is the one that the search was to close, None: none; ``front``:
    of all designs those alone are kept that none dominates; ``mission`` is what the
    tasks, in one text, belong to; ``origin`` tells the robots apart that a step may begin with.
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
    """An opened result folder with its ``files``.  It is also the journal of the synthesis.

    ``kept`` is where the results of an earlier version of the spec are, which were here.
    """

    path: Path
    identity: Identity
    values: dict[str, Recorded] = field(default_factory=dict[str, Recorded])
    kept: Path | None = None
    files: FolderWriter = field(init=False)

    def __post_init__(self) -> None:
        self.files = FolderWriter(self.path)

    def recall(self, key: str) -> Recorded:
        """The result of a step finished in this or an earlier, interrupted run, or None."""
        return self.values.get(key)

    def record(self, key: str, value: Recorded) -> None:
        """A step is finished: one line, written at once."""
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
        """The run is complete: nothing is left to resume."""
        self.files.discard(JOURNAL)


@contextmanager
def open_folder(
    path: Path, identity: Identity, *, force: bool, spec: str | None = None
) -> Iterator[ResultFolder]:
    """Open or make a result folder; an interrupted run of the same synthesis goes on.

    Nobody else writes to it in the block.  Results of the same command before its spec was edited
    are kept: without ``force`` their folder is moved to ``PATH.1`` and so on.

    Args:
        path: the folder.
        identity: what its results are to belong to.
        force: replace what is there.
        spec: the name of the main file of a spec that may have been edited; None: nothing is moved.

    Raises:
        UsageFault: somebody else writes to it; the folder holds other results or other files, and
            ``force`` is not given; a link is where a file or folder of ours is due; or it cannot
            be written.
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
    """In the block nobody else writes to a folder, which is made, and has no links."""
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
    """Whether a folder has the results of the same command, before what it reads was edited.

    That is the spec, and of a step the robot that it begins with, with the prices.
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
    if owner is None and not force and any(item.name not in UNFINISHED for item in path.iterdir()):
        raise UsageFault(
            f"{path} is not empty and holds no results; ",
            argument("force"),
            " uses it all the same",
        )
    ours = [name for name in OWN_FOLDERS if (path / name).exists()]
    if owner is None and ours and force:
        # They are somebody else's: a result must not be mixed with them, nor may they be deleted.
        raise UsageFault(f"{path} has a `{ours[0]}` that is not ours; choose another folder")
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
    """Copy the results of a folder, and of an unfinished run what it needs to go on.

    Raises:
        UsageFault: the source holds no results or a link, or the target cannot be used
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
    """A whole journal, so that a line cut by a kill is gone before the next one is appended."""
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
    """What the folder's results belong to, or None."""
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
    """The steps of a journal; a last line cut by a kill is ignored."""
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


# --- The object that a JSON file of a result folder holds -----------------------------------------


def json_object(path: Path, *, needed: bool = True) -> dict[str, Any]:
    """The object in a file; an empty one where the file is missing and not ``needed``.

    Raises:
        UsageFault: it holds none, or cannot be read.
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
