"""The data files of a synthesis: ``design.json``, ``trajectory.csv`` and the certificate."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.exact_numbers import decimal, exact_decimal
from compiler.objectives.objective_text import objective_unit
from compiler.robots.reconfiguration import Reconfiguration
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from grammar_lang import ir
from solvers.conclusion import StructureRecord
from solvers.search.configuration_search import PathSamples, Sample
from solvers.search.objective_result import Optimality
from solvers.search.path_task import Design, design_margins, stated_inputs
from solvers.search.search_state import CounterExampleRecord
from solvers.search.synthesis import Synthesis
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.claims.agreement import satisfied_formulas
from solvers.verifier.claims.bound_claims import bound_entry
from solvers.verifier.claims.certificate import (
    FoundClaim,
    ImpossibleClaim,
    SeparationClaim,
    cut_claim,
    parameter_claims,
    to_text,
)
from solvers.verifier.claims.claimed_inputs import SHARE, held_bounds, robustness_entry
from solvers.verifier.claims.lemma_claims import LemmaClaim, lemma_text
from solvers.verifier.claims.objective_claims import objective_entries
from solvers.verifier.claims.spec_copy import bounded_text
from solvers.verifier.proofs.effort_bounds import planned_efforts
from srgc.results.evidence_claims import Evidence, bound_claim_of, objectives_claim_of
from srgc.results.result_folder import Identity
from srgc.text_reports.nearest_motion import nearest_entry


def efforts(design: Design, task: ir.Task) -> tuple[str, str]:
    """Peak effort and robustness as exact decimals; an irrational norm of inputs is rounded."""
    if design.controller is not None:
        proved = planned_efforts(design.model, task, design.conditions)
        return decimal(proved[0]), decimal(proved[1])
    peak, margins = Fraction(0), list[Fraction]()
    for bound, held in held_bounds(design.model, task, stated_inputs(design)):
        largest, margin = held.largest, held.margin
        if not held.exact:
            largest = Fraction(decimal(float(largest)))
            margin = bound.upper - largest
        margins.append(margin)
        peak = max(peak, largest) if bound.effort else peak
    rho = min(margins, default=Fraction(0))
    try:
        return exact_decimal(peak), exact_decimal(rho)
    except ValueError:
        return exact_decimal(peak), decimal(float(rho))


def certificate_text(
    result: Synthesis,
    task: ir.Task,
    spec: str,
    spec_sha256: str,
    modules: int | None,
    separation: SeparationClaim | None = None,
) -> str | None:
    """The certificate of a verdict; None for unknown.

    All structures within the bound ``modules`` are refuted; with a ``separation`` there is no
    bound, as there are no structures.
    """
    design = result.design
    if design is not None:
        peak, rho = efforts(design, task)
        bound = None if result.bound is None else bound_claim_of(result.bound)
        least = None if result.optimality is None else objectives_claim_of(result.optimality)
        further = design.controller, design.loop, bound, least
        return to_text(
            FoundClaim(
                task.name,
                spec,
                spec_sha256,
                design.derivation.word,
                design.derivation.labels,
                parameter_claims(design.parameters),
                design.effector,
                task.steps,
                str(task.step),
                design.start,
                design.inputs,
                design.path,
                peak,
                rho,
                tuple(cut_claim(cut.cell, cut.half_space) for cut in design.abstraction.cuts),
                tuple(claim for claim in further if claim is not None),
            )
        )
    if separation is not None:
        return to_text(ImpossibleClaim(task.name, spec, spec_sha256, None, (), separation))
    if result.verdict == "impossible":
        lemmas = _evidence(result).lemma_claims()
        claims = _evidence(result).structure_claims()
        return to_text(ImpossibleClaim(task.name, spec, spec_sha256, modules, claims, None, lemmas))
    return None


def _evidence(result: Synthesis) -> Evidence:
    """The records of structures and the lemmas of a result."""
    return Evidence(result.records, result.lemmas)


def _structure(result: Synthesis, index: int, record: StructureRecord) -> dict[str, Any]:
    first = result.records[record.same_robot_as] if record.same_robot_as is not None else record
    script, same, boxes = _evidence(result).of(index)
    about = {} if record.lemma is None else {"lemma": record.lemma}
    return {
        "word": list(record.word),
        "derivation": list(record.derivation),
        "verdict": first.verdict,
        "evidence": _basis(record) or script or boxes or first.reason,
        "same_robot_as": same,
        "boxes": boxes,
        "reason": first.reason,
        **about,
    }


def _basis(record: StructureRecord) -> str | None:
    """The lemma that refutes a structure, counted from 1; None if there is no such lemma."""
    return None if record.lemma is None else f"lemma {record.lemma + 1}"


def _lemma(claim: LemmaClaim) -> dict[str, Any]:
    """A lemma as the certificate states it, and in words."""
    content = asdict(claim) | {"reason": lemma_text(claim)}
    del content["kind"]
    return content


def _counterexample(found: CounterExampleRecord, task: ir.Task) -> dict[str, Any]:
    return {
        "structure": found.structure,
        "path": found.path,
        "effector": found.effector,
        "cells": list(found.cells),
        "ordered": found.ordered,
        "of": found.length,
        "deferred": found.deferred,
        "time": None if found.sample is None else float(found.sample * task.step),
        "robustness": found.robustness if isfinite(found.robustness) else None,
    }


def design_text(
    result: Synthesis,
    task: ir.Task,
    spec: str,
    identity: Identity,
    change: Reconfiguration | None = None,
) -> str:
    """``design.json`` of a verdict; ``change``: how the existing robot becomes the design."""
    design = result.design
    content: dict[str, Any] = {
        "verdict": result.verdict,
        "reason": result.reason,
        "task": task.name,
        "spec": spec,
        "word": None,
        "derivation": None,
        "dofs": [],
        "parameters": [],
        "robustness": None,
        "effort_peak": None,
        "robustness_share": None,
        "robustness_by_unit": None,
        "control": None,
        "held_at_start": None,
        "held_at_end": None,
        "step": float(task.step),
        "horizon": task.steps,
        "path": [],
        "leader": None,
        "satisfy": [],
        "reconfiguration": None if change is None else change.describe(),
        "cells": result.abstraction.describe(),
        "structures_tried": [_structure(result, i, r) for i, r in enumerate(result.records)],
        "nearest": None if design is not None else nearest_entry(result.nearest, task),
        "counterexamples": [_counterexample(each, task) for each in result.counterexamples],
        "iterations": result.counts,
        "seed": identity.seed,
        "least_cells": identity.least_cells,
        "all_designs": identity.all_designs,
        "solver": identity.solver,
        "search": identity.search,
        "paths": identity.paths,
        "evaluations": identity.evaluations,
        "spec_sha256": identity.spec_sha256,
        "version": identity.version,
    }
    if design is not None:
        peak, rho = efforts(design, task)
        content |= {
            "word": list(design.derivation.word),
            "derivation": list(design.derivation.labels),
            "dofs": [
                {"symbols": list(dof.symbols), "kind": dof.kind, "axis": dof.axis}
                for dof in design.model.dofs
            ],
            "parameters": [value.describe() for value in design.parameters],
            "robustness": float(Fraction(rho)),
            "effort_peak": float(Fraction(peak)),
            **robustness_entry(design_margins(design, task)),
            "control": "open loop" if design.controller is None else "feedback",
            "held_at_start": design.held_at_start,
            "held_at_end": design.held_at_end,
            "path": [list(names) for names in design.path],
            "leader": design.leader,
            "satisfy": satisfied_formulas(task, design.conditions),
        }
        if design.loop is not None:
            content["loop"] = design.loop.first
        if identity.gap is not None:
            bound, share = result.bound, content[SHARE]
            content["bound"] = None if bound is None else bound_entry(bound_claim_of(bound), share)
        if result.optimality is not None:
            content["objectives"] = _objectives(result.optimality)
    if identity.one_by_one:
        content["one_by_one"] = True
    if identity.smt is not None:
        content["smt"] = identity.smt
    if identity.gap is not None:
        content["gap"] = identity.gap
    if identity.front:
        content["front"] = True
    if result.lemmas:
        content["lemmas"] = [_lemma(claim) for claim in _evidence(result).lemma_claims()]
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _objectives(found: Optimality) -> list[dict[str, Any]]:
    """What is known about the objectives of a design."""
    units = [objective_unit(each.amount.objective) for each in found.objectives]
    entries = objective_entries(objectives_claim_of(found).values, units)
    return [
        entry | {"undecided": each.undecided, "all_tried": not each.more}
        for entry, each in zip(entries, found.objectives, strict=True)
    ]


def trajectory_csv(design: Design, task: ir.Task) -> str:
    """The sampled trajectory of a design."""
    return samples_csv(design.model, design.configuration.outcome.trajectory, design.inputs, task)


def samples_csv(
    model: RobotModel, trajectory: Trajectory, inputs: Sequence[Sequence[str]], task: ir.Task
) -> str:
    """A sampled trajectory in SI units: t, q, rates, own states, inputs, effector positions."""
    n, d = len(model.dofs), model.dimension
    states, inputs_of = robot_states(model), robot_inputs(model)
    numeric = NumericRobot(robot_graph(model, task.gravity))
    tips = numeric.places(trajectory.x[:, :n], trajectory.theta)
    effectors = len(model.effectors)
    head = ["t", *(f"q{i + 1}" for i in range(n)), *(f"qd{i + 1}" for i in range(n))]
    head += [f"s{i + 1}" for i in range(len(states))]
    head += [f"u{i + 1}" for i in range(len(inputs_of))]
    head += [f"e{e + 1}_{axis}" for e in range(effectors) for axis in "xyz"[:d]]
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(head)
    for i, state in enumerate(trajectory.x):
        row = inputs[i] if i < len(inputs) else ("",) * len(inputs_of)
        writer.writerow(
            [
                decimal(float(i * task.step)),
                *(decimal(value) for value in state),
                *row,
                *(decimal(value) for value in tips[i, :effectors].ravel()),
            ]
        )
    return buffer.getvalue()


# --------------------------------------------------------------------------------------------------
# ``evaluations.csv``: all parameter values that a synthesis evaluated, for tables and pictures.


FIXED = ("structure", "path", "rho", "feasible")


def parameter_names(paths: Sequence[PathSamples]) -> list[str]:
    """The names of all parameters, ``symbol.name``, by symbol and then by first occurrence."""
    names = dict.fromkeys(name for each in paths for name in each.names)
    return sorted(names, key=lambda name: int(name.partition(".")[0]))


def evaluations_csv(paths: Sequence[PathSamples]) -> str:
    """The table: a row per evaluation, in order; parameters that a robot lacks are left empty.

    Columns are ``structure`` and ``path`` (both from 0), the parameters in SI units, ``rho`` and
    ``feasible`` (0 or 1).
    """
    names = parameter_names(paths)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([*FIXED[:2], *names, *FIXED[2:]])
    for each in paths:
        for sample in each.samples:
            own = dict(zip(each.names, map(decimal, sample.theta), strict=True))
            writer.writerow(
                [
                    each.structure,
                    each.path,
                    *(own.get(name, "") for name in names),
                    decimal(sample.robustness),
                    int(sample.feasible),
                ]
            )
    return buffer.getvalue()


def last_samples(path: Path, structure: int, names: Sequence[str]) -> tuple[Sample, ...]:
    """The samples of the last path of a structure in a table; empty if the table is missing.

    Raises:
        ValueError: the file is not a table of evaluations.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(bounded_text(path))))
    except FileNotFoundError:
        return ()
    except (OSError, UnicodeDecodeError, csv.Error):
        raise ValueError(f"{path} is not a table of evaluations") from None
    try:
        own = [row for row in rows if int(row["structure"]) == structure]
        last = max((int(row["path"]) for row in own), default=0)
        return tuple(
            Sample(
                np.array([float(row[name]) for name in names]),
                float(row["rho"]),
                bool(int(row["feasible"])),
            )
            for row in own
            if int(row["path"]) == last
        )
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{path} is not a table of evaluations") from None
