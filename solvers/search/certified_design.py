"""From a motion to a proved design: round it to decimals and prove it, or say what failed."""

from __future__ import annotations

from dataclasses import replace

from compiler.arrays import Array
from compiler.expressions.exact_numbers import decimal
from compiler.robots.parameter_values import nearest_values
from compiler.robots.state_and_input import dry_friction, joint_names
from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.search.closed_loop import controlled, loop_claim
from solvers.search.configuration_search import Configuration
from solvers.search.constraint_tightening import (
    beyond_loop,
    missing_at_limits,
    missing_margin,
    without_limits,
)
from solvers.search.path_task import Design, motion_of
from solvers.search.search_state import Answer, Blocked, Cause, Found
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.fine_motion import fine_motion, seems_to_satisfy
from solvers.trajectory.friction_inputs import friction_inputs
from solvers.trajectory.held_start import holds_still
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.rubbing_motion import rubbing_inputs, rubbing_loop
from solvers.trajectory.simulated_motion import clear_violations, simulated_motion
from solvers.trajectory.task_limits import final_samples
from solvers.trajectory.trajectory import Trajectory
from solvers.trajectory.visited_cells import cell_names
from solvers.verifier.claims.claimed_inputs import held_bounds, input_margins
from solvers.verifier.proofs.checked_condition import decisive
from solvers.verifier.proofs.effort_bounds import least_share
from solvers.verifier.proofs.scene import Scene, Watch
from solvers.verifier.proofs.trajectory_proof import ENDED, prove_motion, scene_of
from solvers.verifier.proofs.tube_checks import Status


def certified_design(
    program: ir.Program,
    task: ir.Task,
    derivation: Derivation,
    path_problem: PathProblem,
    found: Configuration,
    watch: Watch,
    *,
    last: bool = False,
    roughly: bool = False,
) -> Answer:
    """The design, if the continuous-time nonlinear robot is proved to do the task.

    Args:
        program: the spec.
        task: the task to prove.
        derivation: the derivation of the robot.
        path_problem: the problem that the motion solves.
        found: the motion.
        watch: the callbacks of the proof.
        last: no other motion will be tried, so this one is proved even if it is doubtful.
        roughly: use only the lowest precision, even if it decides nothing.
    """
    trajectory, model = found.outcome.trajectory, path_problem.model
    parameters = nearest_values(model.parameters, trajectory.theta)
    if parameters is None:
        return Blocked(Cause.NO_DECIMALS)
    controller, gains = None, None
    if path_problem.feedback:
        closed = controlled(path_problem, trajectory)
        if closed is None:
            return Blocked(Cause.DIVERGES, f"; {Cause.DIVERGES.value}")
        trajectory, gains, controller = closed
    design = Design(
        derivation,
        model,
        parameters,
        path_problem.constraints.recorded,
        path_problem.effector,
        tuple(decimal(value) for value in trajectory.x[0, : 2 * len(model.dofs)]),
        _decimals(trajectory.u),
        tuple(tuple(names) for names in cell_names(path_problem, trajectory, found.entries)),
        found,
        path_problem.abstraction,
        controller=controller,
    )
    if path_problem.loop is not None:
        loop = loop_claim(path_problem, trajectory, gains)
        if loop is None:
            return Blocked(Cause.NO_SET, f"; {Cause.NO_SET.value}")
        design = replace(design, loop=loop)
    scene = scene_of(program, task, model, path_problem.abstraction, derivation)
    broken = seen_broken(scene, design, path_problem, last=last)
    driven = trajectory.u if broken else _against_friction(path_problem, trajectory, gains)
    design = replace(design, inputs=_decimals(driven))
    broken = broken or _beyond_bounds(design, task)
    if broken is not None:
        return broken
    watch = replace(watch, brief=path_problem.spread is None, roughly=roughly)
    conditions = prove_motion(scene, motion_of(design), watch)
    obstacle = decisive(conditions)
    if obstacle is not None:
        spread = path_problem.spread
        undecided = roughly and obstacle.status is Status.UNDECIDED
        return Blocked(
            Cause.ENDED if obstacle.name == ENDED or undecided else Cause.UNPROVED,
            f"; last proof tried: {obstacle.reason}",
            0.0 if spread is None else missing_margin(without_limits(conditions), spread),
            beyond_loop(conditions),
            missing_at_limits(conditions, joint_names(model)),
            obstacle,
        )
    design = replace(
        design,
        conditions=conditions,
        held_at_start=_held_at_start(path_problem, trajectory),
        held_at_end=_held_at_end(path_problem, trajectory),
    )
    outcome = _outcome(design, path_problem, replace(trajectory, u=driven), gains)
    return Found(replace(design, configuration=replace(found, outcome=outcome)))


def _held_at_start(path_problem: PathProblem, trajectory: Trajectory) -> bool | None:
    """Whether drives seem to hold the robot where it begins; None if it need not, or has to."""
    task, start = path_problem.task, path_problem.task.start
    moving = isinstance(start, ir.StartIn) and (start.held or start.rates > 0)
    if moving or not any(task.gravity):
        return None
    numeric, groups = path_problem.numeric, path_problem.groups
    return holds_still(numeric, trajectory.x[0], trajectory.theta, groups)


def _held_at_end(path_problem: PathProblem, trajectory: Trajectory) -> bool | None:
    """Whether drives seem to hold the robot where it has to be at rest; None if nothing asks it."""
    task = path_problem.task
    if task.final_rates is None or task.stay or task.repeat or not any(task.gravity):
        return None
    numeric, groups = path_problem.numeric, path_problem.groups
    return holds_still(numeric, trajectory.x[-1], trajectory.theta, groups)


def _against_friction(
    path_problem: PathProblem, trajectory: Trajectory, gains: Array | None
) -> Array:
    """The inputs (k, m) with dry friction compensated; unchanged if there is none.

    In an open loop they are the inputs that feedback would command from sample to sample.  If a
    joint reverses within a step, compensating its mean friction alone lets the robot drift away.
    """
    numeric = path_problem.numeric
    added = friction_inputs(numeric, trajectory)
    if gains is not None or not added.any():
        return trajectory.u + added
    gains, task = path_problem.gains(trajectory), path_problem.task
    return rubbing_inputs(
        numeric, trajectory, added, gains, float(task.step), path_problem.substeps,
        final_samples(task),
    )  # fmt: skip


def _beyond_bounds(design: Design, task: ir.Task) -> Blocked | None:
    """Why open-loop inputs violate their bounds, or None; for a controller this is proved later."""
    if design.controller is not None:
        return None
    held = held_bounds(design.model, task, motion_of(design).inputs)
    if all(each.holds for _, each in held):
        return None
    return Blocked(Cause.BROKEN, "; inputs against dry friction leave their bounds")


def _outcome(
    design: Design, path_problem: PathProblem, trajectory: Trajectory, gains: Array | None
) -> ControlOutcome:
    """The motion of a proved design: from its reference, and from the ``gains`` of a controller."""
    numeric, model, task = path_problem.numeric, path_problem.model, path_problem.task
    rubs = bool(dry_friction(model))
    if gains is None:
        trajectory = fine_motion(numeric, trajectory, float(task.step))
    elif rubs:
        trajectory = rubbing_loop(numeric, trajectory, gains, float(task.step))
    outcome = replace(design.configuration.outcome, trajectory=trajectory)
    if gains is None and not rubs:
        return outcome
    # The bounds in the search were tightened by the shares of feedback and of friction.
    exact = motion_of(design).inputs if gains is None else None
    margins = input_margins(model, task, exact, design.conditions)
    peaks = (float(m.bound.upper) - m.least for m in margins if m.bound.effort)
    peak, rho = max(peaks, default=0.0), least_share(margins)
    return replace(outcome, effort_peak=max(peak, 0.0), robustness=rho)


def _decimals(u: Array) -> tuple[tuple[str, ...], ...]:
    """The inputs (k, m) as decimals."""
    return tuple(tuple(decimal(value) for value in row) for row in u)


def seen_broken(
    scene: Scene, design: Design, path_problem: PathProblem, *, last: bool
) -> Blocked | None:
    """Why no proof is attempted: a condition that the simulated motion certainly violates, or None.

    A formula that seems to fail is not certain to fail, so the ``last`` motion is proved
    nevertheless.
    """
    motion, task = motion_of(design), path_problem.task
    seen = simulated_motion(path_problem.numeric, motion, float(task.step), path_problem.substeps)
    if seen is None:
        return None
    conditions = clear_violations(scene, motion, path_problem.numeric, seen)
    worst = decisive(conditions)
    if worst is not None:
        spread = path_problem.spread
        return Blocked(
            Cause.BROKEN,
            f"; the motion simulated before a proof: {worst.reason}",
            0.0 if spread is None else missing_margin(without_limits(conditions), spread),
            limits=missing_at_limits(conditions, joint_names(path_problem.model)),
            condition=worst,
        )
    if last or seems_to_satisfy(path_problem, seen):
        return None
    return Blocked(Cause.BETWEEN_SAMPLES, f"; {Cause.BETWEEN_SAMPLES.value}")
