"""Spoilt proofs that there is no robot: whatever changes what is claimed is refused."""

from __future__ import annotations

import json
import random
from collections import Counter
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.spec_figures import figures_of
from tests.soundness.spoilt_claims import any_field, other_text

ACCEPTED = (Outcome.VALID, Outcome.UNCHECKED)
STATED = ("format", "kind", "task", "spec", "spec_sha256", "modules", "separation")
SHORT, LONG = 24, 150


def statement(content: dict[str, Any]) -> list[object]:
    """What is claimed, and of which structures; not by what it is shown."""
    listed = content.get("structures")
    if not isinstance(listed, list) or not all(isinstance(item, dict) for item in listed):
        return [None]
    stated = [(name, repr(content.get(name))) for name in STATED]
    return [*stated, *((repr(s.get("word")), repr(s.get("derivation"))) for s in listed)]


def one_link_can(text: str) -> bool:
    """Whether one link of the turner's family can be at the start and in the target.

    Its tip turns about the base at its length, and keeps it: by brute force on circles.
    """
    figures = figures_of(text)
    angles = np.linspace(-np.pi, np.pi, 721)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert figures.reach is not None
    places = [figures.areas[name] for name in (figures.start, figures.reach)]
    for radius in np.linspace(1, 2, 41):
        tips = radius * circle
        clear = figures.bounds.slack(tips) > 0
        for name, _, margin in figures.avoids:
            away = figures.areas[name].distance(np.stack([tips, tips], axis=1))
            clear &= away > margin
        if all((clear & (place.slack(tips) > 0)).any() for place in places):
            return True
    return False


def trial(folder: Path, good: dict[str, Any], text: str, seed: int) -> str:
    """Spoil the certificate, the spec, or a file of evidence, and judge what is said then."""
    chance = random.Random(seed)
    content, spec = deepcopy(good), folder / "spec" / good["spec"]
    kind = chance.choice(("field", "field", "field", "spec", "evidence"))
    kept: tuple[Path, bytes] | None = None
    if kind == "spec":
        changed = other_text(chance, text)
        spec.write_text(changed, encoding="utf-8")
        content["spec_sha256"] = result_files.spec_digest({spec.name: spec.read_bytes()})
    elif kind == "field":
        any_field(chance, content)
    else:
        path = chance.choice(sorted((folder / "proofs").iterdir()))
        kept = (path, path.read_bytes())
        path.write_bytes(spoilt_bytes(chance, kept[1]))
    content["digest"] = result_files.digest(content)
    result_files.write(folder, content)
    outcome = verify_directory(folder).outcome
    if kind == "field" and statement(content) != statement(good):
        assert outcome not in ACCEPTED, (seed, "another claim")
    if kind == "spec":
        if outcome in ACCEPTED:
            assert not _possible(changed), (seed, "a task that is possible")
        spec.write_text(text, encoding="utf-8")
    if kept is not None:
        path, data = kept
        if path.suffix == ".smt2" and named(content, path):
            assert outcome not in ACCEPTED, (seed, "another script")
        path.write_bytes(data)
    return f"{kind} {'accepted' if outcome in ACCEPTED else 'refused'}"


def named(content: dict[str, Any], path: Path) -> bool:
    """Whether a structure rests on this file alone or besides."""
    return any(f"proofs/{path.name}" == s["evidence"] for s in content["structures"])


def _possible(text: str) -> bool:
    try:
        return one_link_can(text)
    except ValueError:
        return False


def spoilt_bytes(chance: random.Random, data: bytes) -> bytes:
    """A byte flipped, some lost or repeated, or all."""
    found = bytearray(data)
    here = chance.randrange(len(found))
    match chance.randrange(4):
        case 0:
            found[here] ^= 1 << chance.randrange(7)
        case 1:
            del found[here : here + chance.randint(1, 9)]
        case 2:
            found[here:here] = found[here : here + 5]
        case _:
            found.clear()
    return bytes(found)


def outcomes(folder: Path, seeds: range) -> Counter[str]:
    good = result_files.read(folder)
    text = (folder / "spec" / good["spec"]).read_text(encoding="utf-8")
    (folder / "design.json").unlink()
    return Counter(trial(folder, good, text, seed) for seed in seeds)


@pytest.mark.slow
def test_spoilt_proofs(result):
    seen = outcomes(result("beyond_reach"), range(SHORT))
    assert seen["field refused"] >= 5
    assert seen["spec refused"] >= 1
    assert seen["evidence refused"] >= 1


@pytest.mark.slow
@pytest.mark.parametrize("part", range(2))
def test_three_hundred_spoilt_proofs(result, part):
    first = 1000 + part * LONG
    seen = outcomes(result("beyond_reach"), range(first, first + LONG))
    assert seen["field refused"] >= LONG / 4
    assert seen["spec refused"] >= LONG / 20
    assert seen["evidence refused"] >= LONG / 20


def test_the_brute_force_knows_what_one_link_can(made):
    turner = (made("turner") / "turner.srg").read_text(encoding="utf-8")
    beyond = (made("beyond_reach") / "beyond_reach.srg").read_text(encoding="utf-8")
    assert one_link_can(turner)
    assert not one_link_can(beyond)


# --- forged claims about tasks that are possible -------------------------------------------------


@pytest.fixture
def forged(result: Callable[[str], Path]) -> Callable[[bool], Path]:
    """The proof for one task, told of another one that is possible; the same structures."""

    def make(keep_boxes: bool) -> Path:
        folder = result("beyond_reach")
        good = result_files.read(folder)
        spec = folder / "spec" / good["spec"]
        text = spec.read_text(encoding="utf-8")
        moved = text.replace("[0.5, 0.8] x [-0.2, 0.2]", "[1.2, 1.9] x [-0.3, 0.3]")
        assert moved != text
        assert one_link_can(moved)
        spec.write_text(moved, encoding="utf-8")
        good["spec_sha256"] = result_files.spec_digest({spec.name: spec.read_bytes()})
        for item in good["structures"]:
            item["boxes"] = item["boxes"] if keep_boxes else None
        good["digest"] = result_files.digest(good)
        result_files.write(folder, good)
        (folder / "design.json").unlink()
        return folder

    return make


def test_a_proof_of_another_task_is_refused(forged):
    folder = forged(True)
    assert any(item["boxes"] for item in result_files.read(folder)["structures"])
    assert verify_directory(folder).outcome is Outcome.REFUTED


def test_boxes_alone_of_another_task_are_refused(forged):
    folder = forged(True)
    content = result_files.read(folder)
    for item in content["structures"]:
        item["evidence"] = None if item["boxes"] else item["evidence"]
    content["digest"] = result_files.digest(content)
    result_files.write(folder, content)
    assert verify_directory(folder).outcome is Outcome.REFUTED


def test_scripts_made_for_a_possible_task_are_refused_by_z3(forged):
    """The forger writes the right scripts; they are satisfiable."""
    folder = forged(False)
    for path, script in right_scripts(folder):
        path.write_text(script, encoding="utf-8")
    assert verify_directory(folder).outcome is Outcome.UNCHECKED
    report = verify_directory(folder, trust="z3")
    assert report.outcome is Outcome.REFUTED
    assert "z3 does not refute structure" in str(report.reason)


def right_scripts(folder: Path) -> list[tuple[Path, str]]:
    """The first script of every structure, for the spec in the folder."""
    from compiler.robots.normal_form import family_of
    from grammar_lang.load import load
    from solvers.verifier.refutations.structure_evidence import refutation_scripts

    content = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    program = load(folder / "spec" / content["spec"]).program
    assert program is not None
    task = program.tasks[content["task"]]
    family = family_of(program, task)
    found = []
    for item in content["structures"]:
        if item["same_robot_as"] is None:
            model = family.robot(family.replay(tuple(item["derivation"])))
            scripts = refutation_scripts(model, program.workspaces[task.workspace], task)
            found.append((folder / item["evidence"], next(iter(scripts))))
    return found
