"""The robot that exists before the first task of a mission, and where it comes from.

For a mission of the spec it is the robot of a ``from``. For a single step it is the robot of a
result in the history of the folder, which is verified like any other result; the prices and the
free parameters are those that the claim states.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from compiler.expressions.exact_numbers import rational_bounds
from compiler.missions.parameter_ranges import Range, Ranges, single
from compiler.missions.robot_changes import Built, built
from grammar_lang import ir
from solvers.verifier.claims.certificate import CertificateError, FoundClaim, exact
from solvers.verifier.claims.mission_claim import ExistingClaim, MissionClaim, PosedClaim
from solvers.verifier.claims.spec_copy import read_claim, read_copy
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Outcome, Refused
from solvers.verifier.verification import Expected, verify_directory

_SOURCE = re.compile(r"history/[0-9]{1,6}(/tasks/[A-Za-z_][A-Za-z0-9_]*)?")
"""A result in the history of a folder, or the design of a task in it."""


@dataclass(frozen=True, slots=True)
class RobotBefore:
    """The existing robot, None without one; for a single step, ``said`` describes it."""

    robot: Built | None
    said: tuple[CheckedCondition, ...] = ()


def posed_mission(task: str, posed: PosedClaim, program: ir.Program) -> ir.Mission:
    """A mission of one task that starts from an existing robot.

    Raises:
        CertificateError: a price is malformed, or a free parameter does not exist.
    """
    prices = [exact(text) for text in (posed.add, posed.remove, posed.change)]
    most = None if posed.most is None else exact(posed.most)
    if any(price < 0 for price in prices) or (most is not None and most < 0):
        raise CertificateError("the claim of the mission is malformed: a price is negative")
    for module, name in posed.free:
        if module not in program.modules or name not in parameter_names(program.modules[module]):
            raise CertificateError(f"the claim frees `{module}.{name}`, which there is not")
    return ir.Mission(task, (task,), ir.Prices(*prices), frozenset(posed.free), most)


def parameter_names(module: ir.Module) -> frozenset[str]:
    """The names of the parameters of a module."""
    return frozenset(parameter.name for parameter in module.parameters)


def robot_before(
    folder: Path,
    claim: MissionClaim,
    mission: ir.Mission,
    program: ir.Program,
    trust: str | None,
    watch: Watch,
) -> RobotBefore:
    """The robot before the first task, after checking what the claim says about it.

    Raises:
        Refused: it is another robot, or the result that it comes from is not valid.
        CertificateError, OSError: the result cannot be read.
    """
    origin, stated = program.tasks[mission.tasks[0]].origin, claim.existing
    if claim.posed is None:
        if (origin is None or mission.prices is None) is not (stated is None):
            raise Refused("the claim does not have the existing robot before the first task")
        if origin is None or stated is None:
            return RobotBefore(None)
        if stated.word != origin.word:
            raise Refused("the robot before the first task is not that of its `from`")
        values = {
            (each.symbol, each.name): (Range(*rational_bounds(each.value)),)
            for each in origin.fixed
        }
        return RobotBefore(built(origin.word, program.modules, values))
    if stated is None or origin is not None:
        raise Refused("the claim does not say which robot there is before, or the task does")
    _check_source(folder, stated, program, trust, watch)
    known: dict[tuple[int, str], Ranges] = {
        (each.symbol, each.name): single(exact(each.value)) for each in stated.parameters
    }
    said = CheckedCondition(_posed_text(stated, claim.posed), Status.HOLDS, NO_MARGIN, "")
    return RobotBefore(built(stated.word, program.modules, known), (said,))


def _posed_text(stated: ExistingClaim, posed: PosedClaim) -> str:
    """The existing robot in words, with the prices and the parameters that may change."""
    text = f"from {' '.join(stated.word)} of {stated.source}: add {posed.add}, "
    text += f"remove {posed.remove}"
    if posed.free:
        free = ", ".join(f"{module}.{name}" for module, name in posed.free)
        text += f", change {posed.change}; free {free}"
    return text if posed.most is None else f"{text}; changes <= {posed.most}"


def _check_source(
    folder: Path, stated: ExistingClaim, program: ir.Program, trust: str | None, watch: Watch
) -> None:
    """Check that the result that the robot comes from is valid and has this robot."""
    if not _SOURCE.fullmatch(stated.source):
        raise Refused("the robot before is of no result in the history")
    source = folder / stated.source
    report = verify_directory(source, None, trust, watch, Expected(None, "found"))
    if report.outcome is not Outcome.VALID:
        outcome = Outcome.REFUTED if report.outcome is Outcome.UNEXPECTED else report.outcome
        raise Refused(f"{stated.source}, where the robot comes from: {report.reason}", outcome)
    before = read_claim(source)
    if not isinstance(before, FoundClaim):
        raise Refused(f"{stated.source} has no robot")
    if (before.word, before.parameters) != (stated.word, stated.parameters):
        raise Refused(f"the robot before is not that of {stated.source}")
    earlier, _ = read_copy(source / "spec", before.spec, before.spec_sha256)
    for symbol in stated.word:
        if symbol in earlier.modules:
            _check_module(symbol, earlier, program)


def _check_module(name: str, earlier: ir.Program, program: ir.Program) -> None:
    """Check that the spec has a module of the existing robot, with the same parameters."""
    if name not in program.modules:
        raise Refused(f"the robot before has a module `{name}` that the spec does not know")
    if parameter_names(earlier.modules[name]) != parameter_names(program.modules[name]):
        raise Refused(f"module `{name}` of the robot before has other parameters in the spec")
