"""Measure srgc on the case study: whole processes, and the stages that the time goes to.

``front_end.py`` measures the front end, ``language.py`` the language operations, ``planning.py``
the planner.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any
from unittest import mock

from timing import HEAD, ROOT, SPEC, SRGC, Line, machine, paired, process, summary

sys.path.insert(0, str(ROOT))
ARM = ("B", "eps", "JO", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN")


# --- whole processes -----------------------------------------------------------------------------


def measure_synth(runs: int, folder: Path) -> list[Line]:
    """The case study from file to certificate, anew each time."""
    found = []
    for _ in range(runs):
        shutil.rmtree(folder, ignore_errors=True)
        found.append(process([*SRGC, "synth", str(SPEC), "-o", str(folder)]))
    return [summary("srgc synth", found)]


def measure_verify(runs: int, folder: Path) -> list[Line]:
    """The check of a result folder."""
    found = [process([*SRGC, "verify", str(folder)]) for _ in range(runs)]
    return [summary("srgc verify", found)]


# --- stages --------------------------------------------------------------------------------------


def measure_convex_step(runs: int) -> list[Line]:
    """The first convex step of the case study, sparse matrices against cvxpy; both from scratch."""
    import numpy as np

    from compiler.discretisation.numeric_robot import NumericRobot
    from compiler.dynamics.equations_of_motion import robot_graph
    from compiler.robots.normal_form import family_of
    from compiler.tasks.specification import planning_problem
    from compiler.words.structures import derivations_of
    from compiler.workspaces.abstraction import abstract
    from solvers.planner import Planner
    from solvers.trajectory.control_problem import measured
    from solvers.trajectory.convex_step import ConvexStep
    from solvers.trajectory.path_following import PathProblem
    from solvers.trajectory.reference_step import ReferenceStep
    from solvers.trajectory.subproblem import StepResult, SubproblemSpec, TrustRegion, Weights
    from solvers.verdict import Holds
    from srgc.session import program_of

    program = program_of(SPEC)
    task = next(iter(program.tasks.values()))
    family = family_of(program, task)
    model = family.robot(next(iter(derivations_of(family.language, ARM))))
    place = program.workspaces[task.workspace]
    cells = abstract(place)
    found = Planner(planning_problem(cells, task, 0)).next_plan()
    if not isinstance(found, Holds):
        raise SystemExit("the case study has no path")
    numeric = NumericRobot(robot_graph(model, task.gravity))
    path_problem = PathProblem(
        numeric, place, task, cells, 0, found.witness.paths[0].cells, 2e-3, 0
    )
    problem = path_problem.problem(path_problem.waypoints()[1])
    about = measured(problem, path_problem.seeds(np.array([3.0, 2.5]))[0])
    if about is None:
        raise SystemExit("the case study cannot be linearised")
    question = SubproblemSpec(problem.limits, problem.groups, None, Weights())

    def solve(step: ConvexStep | ReferenceStep) -> None:
        if not isinstance(step.solve(about.model, about.rows, TrustRegion(0.5)), StepResult):
            raise SystemExit("the convex step has no optimum")

    names = ("one convex step", "the same in cvxpy, with Clarabel")
    both = (lambda: solve(ConvexStep(question)), lambda: solve(ReferenceStep(question)))
    return paired(names, both, runs)


def measure_proof(runs: int, folder: Path) -> list[Line]:
    """The validated tube of a result, alone and with all conditions checked on it."""
    from compiler.expressions.evaluators.balls import working_precision
    from compiler.robots.normal_form import family_of
    from compiler.workspaces.abstraction import abstract
    from solvers.verifier.claims.certificate import FoundClaim, claimed_values, from_text
    from solvers.verifier.proofs.enclosure import TubeSegment, tube
    from solvers.verifier.proofs.trajectory_proof import Motion, prove_motion, scene_of
    from solvers.verifier.proofs.tube_checks import Status
    from srgc.session import program_of

    claim = from_text((folder / "certificate.json").read_text(encoding="utf-8"))
    if not isinstance(claim, FoundClaim):
        raise SystemExit(f"{folder}: no robot was found")
    program = program_of(folder / "spec" / claim.spec)
    task = program.tasks[claim.task]
    family = family_of(program, task)
    model = family.robot(family.replay(claim.derivation))
    scene = scene_of(program, task, model, abstract(program.workspaces[task.workspace]))
    motion = Motion(
        claimed_values(claim, model),
        tuple(map(Fraction, claim.start)),
        tuple(tuple(map(Fraction, row)) for row in claim.inputs),
        claim.effector,
        claim.path,
    )
    # The arguments are those of the proof itself, so that both integrate the same motion.
    asked: list[tuple[Any, ...]] = []

    def recorded(*arguments: Any, **options: bool) -> Iterator[TubeSegment]:
        asked.append(arguments)
        return tube(*arguments, **options)

    with mock.patch("solvers.verifier.proofs.tube_proof.tube", recorded):
        findings = prove_motion(scene, motion)
    if not findings or any(finding.status is not Status.HOLDS for finding in findings):
        raise SystemExit(f"{folder}: the motion is not proved")
    arguments = asked[-1]
    accuracy = arguments[4]
    # A first accuracy that decides nothing would be paid for by the proof alone.
    attempts = f"{len(asked)} accuracies tried, order {accuracy.order}"

    def tube_alone() -> None:
        with working_precision(accuracy.bits):
            covered = sum(1 for _ in tube(*arguments))
        if covered < task.steps:
            raise SystemExit("the tube ends too early")

    names = ("validated integration", "the whole proof of the motion")
    alone, whole = paired(names, (tube_alone, lambda: prove_motion(scene, motion)), runs)
    return [replace(alone, note=attempts), whole]


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5, help="of everything but synth")
    parser.add_argument("--synth-runs", type=int, default=1)
    parser.add_argument("--result", type=Path, help="measure on this result folder, without synth")
    options = parser.parse_args()
    if options.runs < 1 or options.synth_runs < 1:
        parser.error("at least one run")
    print(machine())
    print(HEAD, flush=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.result or Path(scratch) / "arm"
        stages: list[Callable[[], list[Line]]] = []
        if options.result is None:
            stages.append(lambda: measure_synth(options.synth_runs, folder))
        stages += [
            lambda: measure_verify(options.runs, folder.resolve()),
            lambda: measure_convex_step(options.runs),
            lambda: measure_proof(options.runs, folder),
        ]
        for stage in stages:
            for line in stage():
                print(line, flush=True)


if __name__ == "__main__":
    main()
