"""The independent verifier: re-reads the spec, recomputes everything, believes no searcher.

It shares the compiler and the validated integration with the searchers, and nothing else.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from compiler.candidates.kept_parameters import robot_in_task
from compiler.checks.supported import unsupported
from compiler.geometry.abstraction import Abstraction, abstract
from compiler.geometry.refinement import Cut
from compiler.grammars.derivation import BadDerivation, Derivation
from compiler.maps.map_fault import MapFault
from compiler.maps.obstacle_pieces import expanded
from compiler.robots.parameter_values import ExactValue, stated_value
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from compiler.semantics.attributes import SemanticsError
from compiler.semantics.family import RobotFamily, family_of
from compiler.specifications.task_formula import missing_effector, recorded_effector
from grammar_lang import ir
from solvers.claims.certificate import (
    CertificateError,
    Claim,
    FoundClaim,
    ImpossibleClaim,
    exact,
    exact_cuts,
    from_text,
)
from solvers.claims.design_agreement import disagreement
from solvers.claims.effort_check import check_efforts
from solvers.claims.formula_agreement import misstated_formula
from solvers.claims.impossibility_check import check_impossible
from solvers.claims.outcome import Outcome, Refused
from solvers.claims.spec_copy import difference_from, read_copy
from solvers.proofs.finding import Finding
from solvers.proofs.trajectory_proof import Motion, prove_motion, scene_of
from solvers.proofs.tube_checks import Status

__all__ = ["Outcome", "Report", "verify_directory"]


@dataclass(frozen=True, slots=True)
class Report:
    """What was checked and found; ``level`` is that of the weakest evidence."""

    outcome: Outcome
    verdict: str | None
    level: str | None
    reason: str | None
    findings: tuple[Finding, ...] = ()


def verify_directory(folder: Path, spec: Path | None = None, trust: str | None = None) -> Report:
    """Check the certificate of a result folder.

    Args:
        folder: a folder written by ``srgc synth``.
        spec: a spec file the result must be about, besides its own copy.
        trust: ``"z3"`` runs refutation scripts again in a z3 process and believes its ``unsat``.
    """
    path = folder / "certificate.json"
    if not path.is_file():
        return Report(
            Outcome.UNDECIDED, None, None, f"there is no certificate in {folder}: nothing to verify"
        )
    try:
        claim = from_text(path.read_text(encoding="utf-8"))
        program = _spec_of(folder, claim, spec)
        return _judged(folder, claim, program, trust)
    except OSError as error:
        reason = f"the certificate cannot be read: {error.strerror}"
        return Report(Outcome.UNDECIDED, None, None, reason)
    except UnicodeDecodeError:
        return Report(Outcome.REFUTED, None, None, "the certificate is not UTF-8")
    except CertificateError as error:
        return Report(Outcome.REFUTED, None, None, str(error))
    except Refused as refusal:
        return Report(refusal.outcome, None, None, str(refusal))


def _spec_of(folder: Path, claim: Claim, other: Path | None) -> ir.Program:
    """The program of the folder's own copy of the spec, whose digest the claim must name."""
    program, files = read_copy(folder / "spec", claim.spec, claim.spec_sha256)
    if other is not None:
        try:
            path = difference_from(files, claim.spec, other)
        except OSError as error:
            raise Refused(f"{other}: {error.strerror}", Outcome.UNDECIDED) from None
        if path is not None:
            where = "" if path == claim.spec else f" in `{path}`"
            raise Refused(f"the certificate is not about {other}: the files differ{where}")
    return program


def _judged(folder: Path, claim: Claim, program: ir.Program, trust: str | None) -> Report:
    """The report on a claim; then whether ``design.json`` says the same."""
    task = program.tasks.get(claim.task)
    if task is None:
        raise Refused(f"the spec has no task `{claim.task}`")
    for clause in unsupported(task):
        raise Refused(f"not verified: {clause.message}", Outcome.UNDECIDED)
    try:
        program, task = expanded(program, task)
    except MapFault as fault:
        raise Refused(f"the spec has errors: {fault.message}") from None
    cells = _cells(program.workspaces[task.workspace])
    if isinstance(claim, FoundClaim):
        cells = _cut(cells, claim)
        model, report = _found(claim, program, task, cells)
    else:
        model, report = None, _impossible(folder, claim, program, task, trust)
    if report.outcome is not Outcome.REFUTED:
        reason = disagreement(folder, claim, program, task, cells, model)
        if reason is None and model is not None and report.outcome is Outcome.VALID:
            reason = misstated_formula(folder, task, report.findings)
        if reason is not None:
            raise Refused(reason)
    return report


# --- found ---------------------------------------------------------------------------------------


def _found(
    claim: FoundClaim, program: ir.Program, task: ir.Task, cells: Abstraction
) -> tuple[RobotModel, Report]:
    """The robot and the report on it."""
    family = family_of(program, task)
    derivation = _derivation(claim, family)
    try:
        model = robot_in_task(family, task.origin, derivation)
    except SemanticsError as error:
        raise Refused(f"the derivation defines no robot: {error}") from None
    _modules(derivation, program, task)
    motion = _motion(claim, model, task)
    findings = [*check_efforts(claim, model, motion, task)]
    _claimed_path(claim, model, task)
    _path_avoids(claim, task, cells)
    if all(finding.status is Status.HOLDS for finding in findings):
        findings += prove_motion(scene_of(program, task, model, cells), motion)
    return model, _conclusion(findings)


def _cells(workspace: ir.Workspace) -> Abstraction:
    """The cells of the spec's workspace, which has errors where it has none."""
    try:
        return abstract(workspace)
    except ValueError as error:
        raise Refused(f"the spec has errors: {error}") from None


def _cut(cells: Abstraction, claim: FoundClaim) -> Abstraction:
    """The cells after the cuts of a claim, which are made in turn."""
    cuts = [Cut(cell, half_space) for cell, half_space in exact_cuts(claim.cuts)]
    if any(len(cut.half_space.normal) != cells.dimension for cut in cuts):
        raise Refused(f"a cut of a cell is not given by {cells.dimension} coordinates")
    try:
        return cells.cut(cuts)
    except ValueError as error:
        raise Refused(f"the cells cannot be cut as claimed: {error}") from None


def _conclusion(findings: list[Finding]) -> Report:
    """One violated condition refutes, one open condition leaves open."""
    failed = next((f for f in findings if f.status is Status.FAILS), None)
    open_one = next((f for f in findings if f.status is Status.UNDECIDED), None)
    if failed is not None:
        reason = f"{failed.name}: violated{_at(failed)}"
        return Report(Outcome.REFUTED, "found", None, reason, tuple(findings))
    if open_one is not None:
        reason = f"{open_one.name}: not decided{_at(open_one)}"
        return Report(Outcome.UNDECIDED, "found", None, reason, tuple(findings))
    return Report(Outcome.VALID, "found", "validated", None, tuple(findings))


def _at(finding: Finding) -> str:
    return "" if finding.time is None else f" at {finding.time:.4g} s"


def _derivation(claim: FoundClaim, family: RobotFamily) -> Derivation:
    """The claimed derivation, of the claimed word, which is accepted."""
    try:
        derivation = family.replay(claim.derivation)
    except BadDerivation as error:
        raise Refused(f"the derivation is none of the grammar: {error}") from None
    if derivation.word != claim.word:
        raise Refused("the derivation does not derive the word")
    # Replaying has shown that the grammar derives the word; the condition remains.
    if not family.language.accept.accepts(claim.word):
        raise Refused(f"the word is not accepted: {' '.join(claim.word)}")
    return derivation


def _modules(derivation: Derivation, program: ir.Program, task: ir.Task) -> None:
    count = sum(program.is_module(symbol) for symbol in derivation.word)
    if task.modules is not None and count > task.modules:
        raise Refused(f"the robot has {count} modules, the task allows {task.modules}")


def _motion(claim: FoundClaim, model: RobotModel, task: ir.Task) -> Motion:
    """The claim's numbers, exact, of the right shapes, with every parameter in its domain."""
    n, m = len(model.dofs), len(robot_inputs(model))
    if claim.steps != task.steps or exact(claim.step) != task.step:
        raise Refused("the horizon is not the task's")
    if len(claim.inputs) != task.steps or any(len(row) != m for row in claim.inputs):
        raise Refused(f"the inputs are not {task.steps} rows of {m}")
    if len(claim.start) != 2 * n:
        raise Refused(f"the start is not {n} coordinates and {n} rates")
    if not 0 <= claim.effector < len(model.effectors):
        raise Refused(f"the robot has no effector {claim.effector + 1}")
    wanted = recorded_effector(task)
    if wanted is not None and wanted != claim.effector:
        raise Refused(f"the task names effector {wanted + 1}, the claim {claim.effector + 1}")
    missing = missing_effector(task, len(model.effectors))
    if missing is not None:
        raise Refused(f"the robot has no effector {missing}, which the task names")
    return Motion(
        _theta(claim, model),
        tuple(exact(text) for text in claim.start),
        tuple(tuple(exact(text) for text in row) for row in claim.inputs),
        claim.effector,
        claim.path,
    )


def _theta(claim: FoundClaim, model: RobotModel) -> tuple[ExactValue, ...]:
    expected = [(p.symbol, p.name) for p in model.parameters]
    if [(p.symbol, p.name) for p in claim.parameters] != expected:
        raise Refused("the parameters are not those of the robot")
    theta = list[ExactValue]()
    for claimed, parameter in zip(claim.parameters, model.parameters, strict=True):
        value = stated_value(parameter.domain, exact(claimed.value))
        if value is None:
            raise Refused(
                f"`{parameter.module}.{parameter.name}` = {claimed.value} "
                f"at symbol {parameter.symbol} is outside its range"
            )
        theta.append(value)
    return tuple(theta)


def _claimed_path(claim: FoundClaim, model: RobotModel, task: ir.Task) -> None:
    shape_fits = len(claim.path) == len(model.effectors) and all(
        len(names) == task.steps + 1 for names in claim.path
    )
    if not shape_fits:
        raise Refused(f"the path is not {task.steps + 1} cells per effector")


def _path_avoids(claim: FoundClaim, task: ir.Task, cells: Abstraction) -> None:
    """The path starts and ends where the task says and keeps out of what effectors avoid."""
    known = {cell.name: index for index, cell in enumerate(cells.cells)}
    forbidden = cells.within(
        name for avoid in task.avoid if avoid.subject == "effector" for name in avoid.regions
    )
    for effector, names in enumerate(claim.path):
        for sample, name in enumerate(names):
            if name not in known:
                raise Refused(f"the path names an unknown cell `{name}`")
            if known[name] in forbidden:
                raise Refused(
                    f"the path of effector {effector + 1} goes through `{name}` "
                    f"at sample {sample}, which the task avoids"
                )
    first, last = claim.path[claim.effector][0], claim.path[claim.effector][-1]
    if known[first] not in _start_cells(task, cells, claim.effector):
        raise Refused(f"the path starts in `{first}`, not in the start region")
    if task.reach is not None and known[last] not in cells.within([task.reach.region]):
        raise Refused("the path does not end in the target")


def _start_cells(task: ir.Task, cells: Abstraction, effector: int) -> Sequence[int]:
    """The cells in which an effector may start; all where its pose or another one is given."""
    start = task.start
    if isinstance(start, ir.StartIn) and start.effector in (None, effector + 1):
        return cells.within([start.region])
    return range(len(cells.cells))


# --- impossible ----------------------------------------------------------------------------------


def _impossible(
    folder: Path, claim: ImpossibleClaim, program: ir.Program, task: ir.Task, trust: str | None
) -> Report:
    reason, proved = check_impossible(folder, claim, program, task, trust)
    if reason is not None:
        return Report(Outcome.REFUTED, "impossible", None, reason)
    if proved:
        level = "z3" if claim.separation is None else "validated"
        return Report(Outcome.VALID, "impossible", level, None)
    return Report(Outcome.ASSUMING_Z3, "impossible", "z3", "only z3 decided; see --trust z3")


def main() -> int:  # pragma: no cover
    """``python -m solvers.verifier DIR``: the verifier without the rest of the command line."""
    report = verify_directory(Path(sys.argv[1]))
    sys.stdout.write(f"{report.outcome.value}{': ' + report.reason if report.reason else ''}\n")
    return {Outcome.VALID: 0, Outcome.REFUTED: 1}.get(report.outcome, 4)


if __name__ == "__main__":
    sys.exit(main())
