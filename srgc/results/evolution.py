"""The robot of a result as the existing robot of a new task, with the history of results."""

from __future__ import annotations

from pathlib import Path

from compiler.missions.module_differences import module_differences
from grammar_lang import ir
from solvers.verdict import MISSION
from solvers.verifier.claims.certificate import FoundClaim
from solvers.verifier.claims.mission_claim import ExistingClaim
from solvers.verifier.missions.robot_before import parameter_names
from srgc.faults import Argument, UsageFault
from srgc.paths import no_folder
from srgc.results.folder_writer import OWN_FILES, OWN_FOLDERS, refuse_links
from srgc.results.found_design import found_design
from srgc.results.mission_run import Step
from srgc.results.no_robot import no_robot
from srgc.results.rebuilding import Rebuilding
from srgc.results.result_folder import json_object

HISTORY = "history"
_LEFT_OUT = ("journal.jsonl", "log.json", "report.html", "landscape.csv")


def step_from(folder: Path, program: ir.Program, task: ir.Task, rebuilding: Rebuilding) -> Step:
    """A step from the robot of a result to a task.

    Args:
        folder: the result of a task, of a mission (its last robot), or of an earlier step.
        program: the spec of the task.
        task: the task.
        rebuilding: what may change.

    Raises:
        UsageFault: the folder has no robot, or the spec does not declare its modules.
    """
    if task.origin is not None:
        raise UsageFault(
            f"task `{task.name}` gives a robot by `from`, but {folder} has another "
            "one: remove `from` from the task"
        )
    place = _last_robot(folder)
    found = found_design(folder / place)
    _check_known(folder, found.claim, found.program, program, task)
    earlier = _earlier(folder)
    number = len(earlier) + 1
    source = f"{HISTORY}/{number}" + (f"/{place}" if place else "")
    existing = ExistingClaim(found.claim.word, found.claim.parameters, source)
    history = _files(folder, number)
    for before in earlier:
        history |= _files(folder / HISTORY / str(before), before)
    differs = module_differences(
        [symbol for symbol in found.claim.word if symbol in found.program.modules],
        frozenset(found.derivation.labels),
        (found.program, found.program.grammars[found.task.grammar]),
        (program, program.grammars[task.grammar]),
    )
    return Step(rebuilding.posed, existing, history, number, differs)


def refuse_inside(output: Path, folder: Path) -> None:
    """Refuse to write a step inside the folder of its initial robot, or around that folder.

    Raises:
        UsageFault: one of the two folders contains the other.
    """
    new, old = output.resolve(), folder.resolve()
    if new == old or old in new.parents or new in old.parents:
        raise UsageFault(
            f"{output} and {folder}, which has the existing robot, are one folder or one in "
            "the other: an interrupted run would lose that robot; name another place",
            Argument(" with -o", " as `output`"),
        )


def _last_robot(folder: Path) -> str:
    """The subfolder of a result that has its last robot; empty for the folder itself."""
    if not folder.is_dir():
        raise no_folder(folder)
    refuse_links(folder)
    if not (folder / MISSION).is_file():
        content = json_object(folder / "design.json", needed=False)
        if "mission" in content:
            raise no_robot(folder, content.get("verdict"))
        return ""
    content = json_object(folder / "design.json")
    if content.get("verdict") != "found":
        raise no_robot(folder, content.get("verdict"))
    robots = content.get("robots")
    last = robots[-1] if isinstance(robots, list) and robots else None
    name = last.get("task") if isinstance(last, dict) else None
    if not isinstance(name, str) or not (folder / "tasks" / name).is_dir():
        raise UsageFault(f"{folder / 'design.json'} does not say where the last robot is")
    return f"tasks/{name}"


def _check_known(
    folder: Path, claim: FoundClaim, old: ir.Program, new: ir.Program, task: ir.Task
) -> None:
    """Refuse a spec that lacks a module of the robot or declares it with other parameters."""
    for symbol in dict.fromkeys(claim.word):
        if symbol not in old.modules:
            continue
        if symbol not in new.modules:
            raise UsageFault(
                f"the robot of {folder} has a module `{symbol}`, which the spec of "
                f"`{task.name}` does not declare"
            )
        before, after = (parameter_names(each.modules[symbol]) for each in (old, new))
        if before != after:
            raise UsageFault(
                f"module `{symbol}` of the robot of {folder} has the parameters "
                f"{_listed(before)}, and {_listed(after)} in the spec of `{task.name}`: it is "
                "another module, which should have another name"
            )


def _listed(names: frozenset[str]) -> str:
    return ", ".join(f"`{name}`" for name in sorted(names)) or "none"


def _earlier(folder: Path) -> list[int]:
    """The numbers of the results in a history."""
    top = folder / HISTORY
    names = [path.name for path in top.iterdir()] if top.is_dir() else []
    return sorted(int(name) for name in names if name.isdigit())


def _files(folder: Path, number: int) -> dict[str, bytes]:
    """The files of a result without its history, by the names that they get in the new result."""
    found: dict[str, bytes] = {}
    for name in (*OWN_FILES, *OWN_FOLDERS):
        path = folder / name
        if name in _LEFT_OUT or name == HISTORY or not path.exists():
            continue
        for file in [path] if path.is_file() else sorted(path.rglob("*")):
            if file.is_file():
                inner = file.relative_to(folder).as_posix()
                found[f"{HISTORY}/{number}/{inner}"] = file.read_bytes()
    return found
