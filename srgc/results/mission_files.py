"""The data files of a mission: ``mission.json`` with its claim, and its ``design.json``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from fractions import Fraction
from typing import Any

from compiler.expressions.exact_numbers import exact_text
from compiler.missions.module_differences import ModuleDifference
from compiler.missions.parameter_boxes import BoxTree
from compiler.missions.robot_changes import Changes
from grammar_lang import ir
from solvers.missions.mission_result import CutRobot, Existing, MissionResult
from solvers.search.path_task import Design
from solvers.verifier.claims.mission_claim import (
    BoxesClaim,
    CutClaim,
    ExistingClaim,
    LeafClaim,
    LeastClaim,
    MissionClaim,
    PosedClaim,
    TaskClaim,
    TreeClaim,
    mission_text,
)
from srgc.results.evidence_claims import Evidence
from srgc.results.result_folder import Identity
from srgc.results.undecided_robots import undecided_entry


def proofs_of(task: str) -> str:
    """The folder of the evidence that refutes robots in a task."""
    return f"proofs/{task}"


def _boxes_name(result: MissionResult, robot: int, task: int, number: int) -> str:
    """The file of a covering for a box of a robot whose parameter box was cut."""
    return f"{proofs_of(result.mission.tasks[task])}/cut{robot:03d}.{number:03d}.boxes"


def evidence_files(result: MissionResult) -> dict[str, str]:
    """Maps the names of files to the evidence of all tasks."""
    found: dict[str, str] = {}
    for name, own in zip(result.mission.tasks, result.evidence, strict=False):
        found |= Evidence(own.records, own.lemmas, proofs_of(name)).files()
    for robot, cut in enumerate(result.cut):
        for number, leaf in enumerate(cut.tree.leaves()):
            evidence = cut.of(leaf)
            if evidence is not None and leaf.refuted:
                found[_boxes_name(result, robot, evidence.task, number)] = evidence.boxes
    return found


def claim_text(
    result: MissionResult,
    identity: Identity,
    spec: str,
    posed: PosedClaim | None,
    existing: ExistingClaim | None,
) -> str | None:
    """The claim of a result; None for unknown."""
    if result.verdict == "unknown":
        return None
    found = result.verdict == "found"
    tasks = tuple(
        TaskClaim(
            name,
            Evidence(own.records, own.lemmas, proofs_of(name)).structure_claims(),
            Evidence(own.records, own.lemmas, proofs_of(name)).lemma_claims(),
            own.separation,
        )
        for name, own in zip(result.mission.tasks, result.evidence, strict=True)
    )
    return mission_text(
        MissionClaim(
            "found" if found else "impossible",
            result.mission.name,
            spec,
            identity.spec_sha256,
            posed,
            result.modules if not result.by_default else None,
            existing,
            _exact(result.cost) if found else None,
            _exact(result.least) if found and result.cost is not None else None,
            tuple(
                LeastClaim(each.text, exact_text(each.value), exact_text(each.least))
                for each in result.values
            ),
            tasks,
            tuple(_boxes(result, number, cut) for number, cut in enumerate(result.cut)),
        )
    )


def _exact(value: Fraction | None) -> str | None:
    return None if value is None else exact_text(value)


def _boxes(result: MissionResult, robot: int, cut: CutRobot) -> BoxesClaim:
    leaves = {id(leaf): number for number, leaf in enumerate(cut.tree.leaves())}

    def tree(node: BoxTree) -> TreeClaim:
        if node.cut is not None and node.parts is not None:
            at = node.cut.at if isinstance(node.cut.at, int) else exact_text(node.cut.at)
            return CutClaim(node.cut.parameter, at, (tree(node.parts[0]), tree(node.parts[1])))
        evidence = cut.of(node)
        if evidence is None or not node.refuted:
            return None
        name = _boxes_name(result, robot, evidence.task, leaves[id(node)])
        return LeafClaim(evidence.task, name)

    return BoxesClaim(cut.task, cut.word, cut.labels, tree(cut.tree))


def existing_claim(
    existing: Existing | None, origin: ir.Origin | None, source: ExistingClaim | None
) -> ExistingClaim | None:
    """The robot before the first task, as the claim states it.

    Raises:
        ValueError: there is an existing robot, but neither a source nor an origin.
    """
    if existing is None or source is not None:
        return source
    if origin is None:
        raise ValueError("the robot before the first task comes from nowhere")
    return ExistingClaim(origin.word, (), "from")


# --- The description of a mission for people and other programs -----------------------------------


def mission_design_text(
    result: MissionResult,
    identity: Identity,
    spec: str,
    existing: ExistingClaim | None,
    before: int,
    differs: Sequence[ModuleDifference],
) -> str:
    """``design.json`` of a mission.

    ``before`` is the number of results in its history; ``differs`` are the modules of the existing
    robot that the spec builds differently.
    """
    content: dict[str, Any] = {
        "verdict": result.verdict,
        "reason": result.reason,
        "mission": result.mission.name,
        "task": identity.task,
        "spec": spec,
        "kind": "one robot" if result.mission.prices is None else "reconfigure",
        "cost": None if result.cost is None else float(result.cost),
        "least": None if result.least is None else float(result.least),
        "objectives": [
            {
                "objective": each.text,
                "value": float(each.value),
                "least": float(each.least),
                "unit": each.unit,
            }
            for each in result.values
        ],
        "existing": None if existing is None else asdict(existing),
        "differs": [{"module": each.module, "what": list(each.what)} for each in differs],
        "robots": [
            _robot(name, design, step)
            for name, design, step in zip(
                result.mission.tasks, result.designs, result.steps, strict=False
            )
        ],
        "undecided": result.undecided,
        "open": [undecided_entry(result, each) for each in result.open_robots],
        "ended_by": None if result.ended is None else result.ended.by,
        "try_first": None if result.ended is None else result.ended.try_first,
        "refuted": [_refuted(result, number) for number in range(len(result.evidence))],
        "modules": result.modules,
        "history": before,
        "origin": identity.origin,
        "iterations": result.counts,
        "seed": identity.seed,
        "solver": identity.solver,
        "search": identity.search,
        "paths": identity.paths,
        "evaluations": identity.evaluations,
        "one_by_one": identity.one_by_one,
        "smt": identity.smt,
        "spec_sha256": identity.spec_sha256,
        "version": identity.version,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _robot(task: str, design: Design, step: Changes | None) -> dict[str, Any]:
    return {
        "task": task,
        "folder": f"tasks/{task}",
        "word": list(design.derivation.word),
        "parameters": [value.describe() for value in design.parameters],
        "robustness": design.robustness,
        "changes": None if step is None else change_entry(step),
    }


def _refuted(result: MissionResult, number: int) -> dict[str, Any]:
    """The number of refutations in task ``number``, and the reasons in words."""
    own = result.evidence[number]
    refuted = [each for each in own.records if each.verdict == "refuted"]
    alone = [each for each in refuted if each.same_robot_as is None and each.lemma is None]
    reasons: dict[str, list[tuple[str, ...]]] = {}
    for record in alone:
        reasons.setdefault(record.reason, []).append(record.word)
    boxes = [
        evidence for cut in result.cut for evidence in cut.evidence.values()
        if evidence.task == number
    ]  # fmt: skip
    return {
        "task": result.mission.tasks[number],
        "structures": len(alone),
        "lemmas": [lemma.text for lemma in own.lemmas],
        "boxes": len(boxes),
        "separated": own.separation is not None,
        "reasons": [
            {"reason": reason, "robots": len(words), "word": list(words[0])}
            for reason, words in reasons.items()
        ],
    }


def change_entry(step: Changes) -> dict[str, Any]:
    """A step between robots; modules are numbered from 0 in the old or the new robot."""
    return {
        "cost": float(step.cost),
        "kept": [list(pair) for pair in step.kept],
        "removed": list(step.removed),
        "added": list(step.added),
        "changed": [list(each) for each in step.changed],
    }
