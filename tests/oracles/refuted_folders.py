"""Result folders that claim an impossibility by coverings, which nobody has searched for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from compiler.robots.robot_key import robot_key
from grammar_lang.load import load
from tests.oracles import result_files


def claim_impossible(folder: Path, text: str, modules: int, coverings: Mapping[str, str]) -> Path:
    """A folder in which every structure of the one task has a covering, given by its word.

    A structure that is the same robot as an earlier one has that one's.
    """
    path = folder / "spec" / "robot.srg"
    path.parent.mkdir(parents=True)
    (folder / "proofs").mkdir()
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    structures: list[dict[str, Any]] = []
    known: dict[str, int] = {}
    for candidate in candidates(family_of(program, task), modules, task.origin):
        assert candidate.model is not None
        first = known.setdefault(robot_key(candidate.model), candidate.number)
        name = f"proofs/{first:04d}.boxes"
        word = candidate.derivation.word
        if first == candidate.number:
            (folder / name).write_text(coverings[" ".join(word)], encoding="ascii")
        structures.append(
            {
                "word": list(word),
                "derivation": list(candidate.derivation.labels),
                "evidence": None,
                "same_robot_as": None if first == candidate.number else first,
                "boxes": name,
            }
        )
    content = {
        "format": 3,
        "kind": "impossible",
        "task": task.name,
        "spec": path.name,
        "spec_sha256": result_files.spec_digest({path.name: path.read_bytes()}),
        "modules": modules,
        "structures": structures,
        "separation": None,
    }
    result_files.write(folder, {**content, "digest": result_files.digest(content)})
    return folder
