"""Check a claim of *found*: this robot, with this start and these inputs, does the task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from compiler.tasks.specification import missing_effector, recorded_effector
from compiler.words.derivation import BadDerivation, Derivation
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.verifier.claims.certificate import (
    CertificateError,
    FoundClaim,
    claimed_values,
    control_of,
    exact,
)
from solvers.verifier.claims.claimed_inputs import (
    check_efforts,
    check_planned_efforts,
)
from solvers.verifier.claims.further_claims import exact_law, exact_loop, unknown_claims
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.loop_set import Loop
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.proofs.trajectory_proof import Motion, prove_motion, scene_of
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Outcome, Refused, Report, concluded


@dataclass(frozen=True, slots=True)
class ClaimedRobot:
    """The robot of a claim, rebuilt from the spec, and the motion claimed for it."""

    derivation: Derivation
    model: RobotModel
    motion: Motion


def claimed_robot(claim: FoundClaim, program: ir.Program, task: ir.Task) -> ClaimedRobot:
    """The robot of a claim, once it is shown to be a robot of the task.

    Raises:
        CertificateError: the parameters are not the robot's, or the claim has a malformed number.
        Refused: the derivation gives no robot of the task, or the numbers of the claim do not fit
            it.
    """
    family = family_of(program, task)
    derivation = _derivation(claim, family)
    try:
        model = robot_in_task(family, task.origin, derivation)
    except SemanticsError as error:
        raise Refused(f"the derivation defines no robot: {error}") from None
    _modules(derivation, program, task)
    return ClaimedRobot(derivation, model, _motion(claim, model, task))


def check_found(
    claim: FoundClaim,
    program: ir.Program,
    task: ir.Task,
    cells: Abstraction,
    watch: Watch,
) -> tuple[RobotModel, Report]:
    """The robot of a claim, and the report on the claim about it.

    ``cells`` are the cells of the workspace after the cuts of the claim.

    Raises:
        CertificateError, Refused: the claim is refuted before anything is integrated.
    """
    claimed = claimed_robot(claim, program, task)
    model, motion = claimed.model, claimed.motion
    conditions = unknown_claims(claim.claims)
    # An unknown claim may be a control law, which commands other inputs than those stated.
    if motion.law is None and not conditions:
        conditions += check_efforts(claim, model, motion, task)
    _claimed_path(claim, model, task)
    _path_avoids(claim, task, cells)
    if all(condition.status is Status.HOLDS for condition in conditions):
        scene = scene_of(program, task, model, cells, claimed.derivation)
        conditions += prove_motion(scene, motion, watch, refute=True)
    report = concluded(conditions)
    if motion.law is not None and report.outcome is Outcome.VALID:
        check_planned_efforts(claim, model, task, conditions)
    return model, report


def _derivation(claim: FoundClaim, family: RobotFamily) -> Derivation:
    """The claimed derivation, checked to derive the claimed word, and the word to be accepted."""
    try:
        derivation = family.replay(claim.derivation)
    except BadDerivation as error:
        raise Refused(f"the derivation is not one of the grammar: {error}") from None
    if derivation.word != claim.word:
        raise Refused("the derivation does not derive the word")
    # Replaying has shown that the grammar derives the word. The ``accept`` condition is still open.
    if not family.language.accept.accepts(claim.word):
        raise Refused(f"the word is not accepted: {' '.join(claim.word)}")
    return derivation


def _modules(derivation: Derivation, program: ir.Program, task: ir.Task) -> None:
    count = sum(program.is_module(symbol) for symbol in derivation.word)
    if task.modules is not None and count > task.modules:
        raise Refused(f"the robot has {count} modules, the task allows {task.modules}")


def _motion(claim: FoundClaim, model: RobotModel, task: ir.Task) -> Motion:
    """The claimed motion: exact numbers of the right shapes, every parameter in its domain."""
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
        claimed_values(claim, model),
        tuple(exact(text) for text in claim.start),
        tuple(tuple(exact(text) for text in row) for row in claim.inputs),
        claim.effector,
        claim.path,
        _law(claim, n, m, task),
        _loop(claim, model, task),
    )


def _law(claim: FoundClaim, n: int, m: int, task: ir.Task) -> ControlLaw | None:
    """The claimed control law, with its shapes checked; None without a controller."""
    controller = claim.controller
    # Without inputs there is nothing to control. An unknown claim may be a control law.
    asked = task.control if m and not unknown_claims(claim.claims) else None
    if asked is not None and asked != control_of(claim):
        raise Refused(f"the task asks for {asked}, the claim is {control_of(claim)}")
    if controller is None:
        return None
    reference, gains = controller.reference, controller.gains
    if len(reference) != task.steps or any(len(row) != 2 * n for row in reference):
        raise Refused(f"the reference is not {task.steps} rows of {2 * n}")
    if len(gains) != task.steps or any(
        len(rows) != m or any(len(row) != 2 * n for row in rows) for rows in gains
    ):
        raise Refused(f"the gains are not {task.steps} times {m} rows of {2 * n}")
    if controller.rounding is not None and len(controller.rounding) != m:
        raise Refused(f"the rounding is not one allowance for each of {m} inputs")
    try:
        law = exact_law(controller)
    except ValueError as error:
        raise CertificateError(f"the certificate is malformed: {error}") from None
    if any(allowance < 0 for allowance in law.rounding):
        raise Refused("an allowance for rounding is negative")
    return law


def _loop(claim: FoundClaim, model: RobotModel, task: ir.Task) -> Loop | None:
    """The claimed loop, with its shape checked; None for a motion that ends."""
    if (claim.loop is not None) is not task.repeat and not unknown_claims(claim.claims):
        said = "goes on for ever" if task.repeat else "ends"
        raise Refused(f"the motion of the task {said}, the claim is about another one")
    if claim.loop is None:
        return None
    if not 0 <= claim.loop.first < task.steps:
        raise Refused(f"the loop does not begin within the {task.steps} steps")
    size = 2 * len(model.dofs) + len(robot_states(model))
    if len(claim.loop.centre) != size:
        raise Refused(f"the set of the loop is not one of {size} states")
    turns = claim.loop.turns
    if turns is not None:
        if len(turns) != len(model.dofs):
            raise Refused(f"the turns of the loop are not those of {len(model.dofs)} joints")
        for number, (turn, periodic) in enumerate(zip(turns, model.periodic, strict=True)):
            if turn and not periodic:
                raise Refused(
                    f"joint {number + 1} has a range, or its angle is read: whole turns change it"
                )
    try:
        return exact_loop(claim.loop)
    except ValueError as error:
        raise CertificateError(f"the certificate is malformed: {error}") from None


def _claimed_path(claim: FoundClaim, model: RobotModel, task: ir.Task) -> None:
    shape_fits = len(claim.path) == len(model.effectors) and all(
        len(names) == task.steps + 1 for names in claim.path
    )
    if not shape_fits:
        raise Refused(f"the path is not {task.steps + 1} cells per effector")


def _path_avoids(claim: FoundClaim, task: ir.Task, cells: Abstraction) -> None:
    """Check that the path starts and ends where the task says and stays out of avoided regions."""
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
    reach = None if task.repeat else task.reach
    if reach is not None and known[last] not in cells.within([reach.region]):
        raise Refused("the path does not end in the target")


def _start_cells(task: ir.Task, cells: Abstraction, effector: int) -> Sequence[int]:
    """The cells in which an effector may start: all, unless the task gives its start region."""
    start = task.start
    if isinstance(start, ir.StartIn) and start.effector in (None, effector + 1):
        return cells.within([start.region])
    return range(len(cells.cells))
