"""Check that ``design.json`` agrees with the certificate; nothing is integrated."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any

from compiler.objectives.objective_text import objective_unit
from compiler.robots.normal_form import family_of
from compiler.robots.reconfiguration import reconfiguration
from compiler.robots.robot import RobotModel
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from grammar_lang.ir.formula_parts import formula_text
from solvers.verifier.claims.bound_claims import bound_entry
from solvers.verifier.claims.certificate import (
    Claim,
    FoundClaim,
    ImpossibleClaim,
    claimed_values,
    control_of,
    exact,
)
from solvers.verifier.claims.objective_claims import ObjectivesClaim, objective_entries
from solvers.verifier.claims.spec_copy import bounded_bytes
from solvers.verifier.proofs.checked_condition import CheckedCondition

# --------------------------------------------------------------------------------------------------
# The certificate is proved, but people read ``design.json``: both have to say the same.


def disagreement(
    folder: Path,
    claim: Claim,
    program: ir.Program,
    task: ir.Task,
    cells: Abstraction,
    model: RobotModel | None,
) -> str | None:
    """Why the folder's ``design.json`` contradicts a claim; None if it does not or is missing.

    Args:
        folder: the result folder.
        claim: the claim of its certificate.
        program: the spec.
        task: the task of the claim, one of the spec's.
        cells: the cells of the task's workspace.
        model: the robot of a found claim.

    Raises:
        CertificateError: a number of the claim is malformed.
    """
    path = folder / "design.json"
    if not path.is_file():
        return None
    try:
        design = json.loads(bounded_bytes(path))
    except (ValueError, RecursionError):
        return "design.json is not JSON"
    if not isinstance(design, dict):
        return "design.json is not a JSON object"
    expected = _expected(claim, model) | {"cells": cells.describe()}
    expected["reconfiguration"] = _reconfiguration(claim, program, task)
    if isinstance(claim, FoundClaim):
        expected |= _further(claim, design, task)
        design["objectives"] = _without_counts(design.get("objectives"))
    for key, value in expected.items():
        if not _says(design.get(key), value):
            return f"design.json and certificate.json differ in `{key}`"
    if isinstance(claim, ImpossibleClaim) and not _says(_tried(design), _claimed(claim)):
        return "design.json and certificate.json differ in `structures_tried`"
    return None


def _further(claim: FoundClaim, design: Mapping[str, Any], task: ir.Task) -> dict[str, Any]:
    """The values that a claim determines for fields that not every ``design.json`` has."""
    found: dict[str, Any] = {}
    if "control" in design:
        found["control"] = control_of(claim)
    if claim.loop is not None or "loop" in design:
        found["loop"] = None if claim.loop is None else claim.loop.first
    if claim.bound is not None or "bound" in design:
        share = design.get("robustness_share")
        found["bound"] = None if claim.bound is None else bound_entry(claim.bound, share)
    if claim.objectives is not None or "objectives" in design:
        found["objectives"] = _objectives(claim.objectives, task)
    return found


def _objectives(claim: ObjectivesClaim | None, task: ir.Task) -> list[dict[str, Any]] | None:
    """The entry of ``design.json`` for the objectives that a claim states."""
    if claim is None:
        return None
    return objective_entries(claim.values, [objective_unit(each) for each in task.minimize])


def _without_counts(stated: object) -> object:
    """The objectives without their counts of undecided robots, which no certificate claims."""
    if not isinstance(stated, list) or not all(isinstance(each, dict) for each in stated):
        return stated
    counts = ("undecided", "all_tried")
    return [{k: value for k, value in each.items() if k not in counts} for each in stated]


def _says(stated: object, meant: object) -> bool:
    """Whether a JSON value is the one meant.

    2 may stand for 2.0, but neither 2.0 nor true for an integer: readers in other languages reject
    2.0 as an index.
    """
    if isinstance(meant, dict):
        return (
            isinstance(stated, dict)
            and stated.keys() == meant.keys()
            and all(_says(stated[key], value) for key, value in meant.items())
        )
    if isinstance(meant, list):
        return (
            isinstance(stated, list)
            and len(stated) == len(meant)
            and all(map(_says, stated, meant))
        )
    if isinstance(meant, float):
        return not isinstance(stated, bool) and stated == meant
    return type(stated) is type(meant) and stated == meant


def _expected(claim: Claim, model: RobotModel | None) -> dict[str, Any]:
    """The fields of ``design.json`` that a claim determines."""
    found = isinstance(claim, FoundClaim)
    fields: dict[str, Any] = {
        "verdict": "found" if found else "impossible",
        "task": claim.task,
        "spec": claim.spec,
        "spec_sha256": claim.spec_sha256,
    }
    if not isinstance(claim, FoundClaim) or model is None:
        return fields | {"word": None, "derivation": None, "parameters": [], "path": []}
    return fields | {
        "word": list(claim.word),
        "derivation": list(claim.derivation),
        "dofs": [
            {"symbols": list(dof.symbols), "kind": dof.kind, "axis": dof.axis} for dof in model.dofs
        ],
        "parameters": [value.describe() for value in claimed_values(claim, model)],
        "path": [list(names) for names in claim.path],
        "robustness": _float(claim.robustness),
        "effort_peak": _float(claim.effort_peak),
        "step": _float(claim.step),
        "horizon": claim.steps,
    }


def _reconfiguration(claim: Claim, program: ir.Program, task: ir.Task) -> dict[str, Any] | None:
    if not isinstance(claim, FoundClaim) or task.origin is None:
        return None
    rules = family_of(program, task).language.srg
    return reconfiguration(rules, task.origin.word, claim.word).describe()


def _float(text: str) -> float:
    return float(exact(text))


def _claimed(claim: ImpossibleClaim) -> list[list[Any]]:
    return [
        [
            list(s.word),
            list(s.derivation),
            "refuted",
            s.evidence or s.boxes,
            s.same_robot_as,
            s.boxes,
        ]
        for s in claim.structures
    ]


def _tried(design: Mapping[str, Any]) -> list[list[Any]]:
    """The structures that were refuted without a lemma, renumbered among themselves."""
    tried = design.get("structures_tried")
    if not isinstance(tried, list):
        return []
    keys = ("word", "derivation", "verdict", "evidence", "same_robot_as", "boxes")
    alone = [i for i, s in enumerate(tried) if not (isinstance(s, dict) and "lemma" in s)]
    place = {index: number for number, index in enumerate(alone)}
    found: list[list[Any]] = []
    for structure in (tried[index] for index in alone):
        entry = [structure.get(key) for key in keys] if isinstance(structure, dict) else []
        if entry and type(entry[4]) is int:
            entry[4] = place.get(entry[4])
        found.append(entry)
    return found


# --- The formulas of a found robot's task in ``design.json`` --------------------------------------


CLOSELY = 1e-9
"""How far a stated robustness may be from the proved one, in m: balls depend on library
versions."""


def satisfied_formulas(
    task: ir.Task, conditions: Sequence[CheckedCondition]
) -> list[dict[str, Any]]:
    """The text of each ``satisfy`` and a lower bound of its robustness in metres.

    The bound is None if the formula holds wherever the effectors are.
    """
    bounds = {condition.clause: condition.margin for condition in conditions}
    return [
        {
            "formula": formula_text(clause.formula),
            "robustness": bounds[number] if bounds[number] < inf else None,
        }
        for number, clause in enumerate(task.satisfy)
    ]


def misstated_formula(
    folder: Path, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> str | None:
    """Why the folder's ``design.json`` misstates a proved formula, or None.

    Args:
        folder: the result folder; its ``design.json``, if it has one, is a JSON object.
        task: the task.
        conditions: the proof of the claim, all of whose conditions hold.
    """
    path = folder / "design.json"
    if not path.is_file():
        return None
    stated = json.loads(bounded_bytes(path)).get("satisfy", [])
    proved = satisfied_formulas(task, conditions)
    if not isinstance(stated, list) or len(stated) != len(proved):
        return "design.json states other formulas than the task in `satisfy`"
    for number, (said, true) in enumerate(zip(stated, proved, strict=True), 1):
        if not isinstance(said, dict) or said.get("formula") != true["formula"]:
            return f"design.json states another formula than the task's `satisfy` {number}"
        if not _near(said.get("robustness"), true["robustness"]):
            return (
                f"the robustness of `satisfy` {number} is {true['robustness']}, "
                f"not {said.get('robustness')} as in design.json"
            )
    return None


def _near(stated: object, proved: float | None) -> bool:
    if stated is None or proved is None:
        return stated is proved
    number = isinstance(stated, float | int) and not isinstance(stated, bool)
    return number and abs(float(str(stated)) - proved) <= CLOSELY
