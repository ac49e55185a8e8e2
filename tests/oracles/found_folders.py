"""Result folders with a claim that nobody has searched for: as `srgc synth` would write them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from compiler.robots.normal_form import family_of
from compiler.robots.state_and_input import robot_inputs
from compiler.words.structures import derivations_of
from grammar_lang.load import load
from tests.oracles import result_files


def claim_found(
    folder: Path,
    text: str,
    word: str | Sequence[str],
    values: list[str],
    files: Mapping[str, bytes] | None = None,
) -> Path:
    """A folder that claims the first derivation of a word with these parameters, at rest at zero.

    The spec has one task.  A word whose symbols have blanks in them is a sequence.  ``files`` are
    those that the spec reads, by their names beside it.
    """
    symbols = tuple(word.split()) if isinstance(word, str) else tuple(word)
    path = folder / "spec" / "robot.srg"
    path.parent.mkdir(parents=True)
    path.write_text(text, encoding="utf-8")
    for name, data in (files or {}).items():
        (path.parent / name).parent.mkdir(parents=True, exist_ok=True)
        (path.parent / name).write_bytes(data)
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    family = family_of(program, task)
    derivation = next(iter(derivations_of(family.language, symbols)))
    model = family.robot(derivation)
    zeros = ["0"] * len(robot_inputs(model))
    content = {
        "format": 3,
        "kind": "found",
        "task": task.name,
        "spec": path.name,
        "spec_sha256": result_files.spec_digest({path.name: path.read_bytes(), **(files or {})}),
        "word": list(symbols),
        "derivation": list(derivation.labels),
        "parameters": [
            {"symbol": p.symbol, "name": p.name, "value": value}
            for p, value in zip(model.parameters, values, strict=True)
        ],
        "effector": 0,
        "steps": task.steps,
        "step": str(task.step),
        "start": ["0"] * 2 * len(model.dofs),
        "inputs": [zeros] * task.steps,
        "path": [["free"] * (task.steps + 1)] * len(model.effectors),
        "effort_peak": "0",
        "robustness": "0",
        "cuts": [],
    }
    result_files.write(folder, {**content, "digest": result_files.digest(content)})
    return folder
