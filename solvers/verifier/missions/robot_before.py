"""The robot that there is before the first task of a mission, and where it comes from.

Of a mission of the spec that is the robot of a `from`.  Of one step it is the robot of a result in
the history of the folder, which is verified like any other; prices and what is free are those that
the claim states.
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
    """The robot that there is, None without one; ``said`` tells of it where a step begins so."""

    robot: Built | None
    said: tuple[CheckedCondition, ...] = ()


def posed_mission(task: str, posed: PosedClaim, program: ir.Program) -> ir.Mission:
    """A mission of one task, for a robot that there is.

    Raises:
        CertificateError: a price is none, or there is no such parameter.
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
    """The robot that there is before the first task, as the claim has it, where that is true.

    Raises:
        Refused: it is another one, or the result that it comes from is not valid.
        CertificateError, OSError: that cannot be read.
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
    """From which robot a step begins, and what may change at which price."""
    text = f"from {' '.join(stated.word)} of {stated.source}: add {posed.add}, "
    text += f"remove {posed.remove}"
    if posed.free:
        free = ", ".join(f"{module}.{name}" for module, name in posed.free)
        text += f", change {posed.change}; free {free}"
    return text if posed.most is None else f"{text}; changes <= {posed.most}"


def _check_source(
    folder: Path, stated: ExistingClaim, program: ir.Program, trust: str | None, watch: Watch
) -> None:
    """The robot that there is before is that of the result that it comes from, which is valid."""
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
    """The spec has a module of the existing robot, with the same parameters."""
    if name not in program.modules:
        raise Refused(f"the robot before has a module `{name}` that the spec does not know")
    if parameter_names(earlier.modules[name]) != parameter_names(program.modules[name]):
        raise Refused(f"module `{name}` of the robot before has other parameters in the spec")
