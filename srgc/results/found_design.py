"""The robot of a result folder, rebuilt from its certificate and its copy of the spec.

Nothing is proved here: ``srgc verify`` shows that the robot does its task.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from compiler.arrays import Array
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from compiler.tasks.obstacle_pieces import expanded
from compiler.words.derivation import BadDerivation, Derivation
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.partition import Cut
from grammar_lang import ir
from solvers.verifier.certified_tube import CertifiedTube, certified_tube
from solvers.verifier.claims.agreement import disagreement
from solvers.verifier.claims.certificate import (
    CertificateError,
    FoundClaim,
    claimed_values,
    exact,
    exact_cuts,
    from_text,
)
from solvers.verifier.claims.further_claims import exact_law
from solvers.verifier.claims.spec_copy import bounded_text, read_copy, task_of_motion
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.enclosure import EnclosureFailure
from solvers.verifier.report import Refused
from srgc.faults import NoAnswer, UsageFault
from srgc.paths import no_folder
from srgc.results.folder_writer import refuse_links
from srgc.results.lost_file import no_certificate, no_design
from srgc.results.mission_refusal import refuse_mission
from srgc.results.no_robot import no_robot
from srgc.results.result_folder import json_object
from srgc.version import VERSION


@dataclass(frozen=True, slots=True, eq=False)
class Feedback:
    """The controller of a design in doubles, in SI units.

    Attributes:
        reference: (k, 2n) coordinates, then rates, at each sample.
        gains: (k, m, 2n); times the deviation from the reference, subtracted from the inputs.
    """

    reference: Array
    gains: Array

    def commanded(self, step: int, planned: Array, state: Array) -> Array:
        """The inputs (m,) of a step, from the planned inputs and the measured state."""
        off = state[: self.reference.shape[1]] - self.reference[step]
        held: Array = planned - self.gains[step] @ off
        return held


@dataclass(frozen=True, slots=True)
class FoundDesign:
    """A design: the claim of the certificate, with the program, task and robot that it is about."""

    claim: FoundClaim
    program: ir.Program
    task: ir.Task
    derivation: Derivation
    model: RobotModel
    parameters: tuple[ParameterValue, ...]
    start: tuple[Fraction, ...]

    @property
    def theta(self) -> Array:
        """The parameters as doubles (p,), in SI units."""
        return np.array([float(value) for value in self.parameters], dtype=np.float64)

    @property
    def feedback(self) -> Feedback | None:
        """The controller; None for open loop.

        Raises:
            UsageFault: it does not fit the robot, or one of its numbers is invalid.
        """
        controller = self.claim.controller
        if controller is None:
            return None
        k, m, size = len(self.claim.inputs), len(robot_inputs(self.model)), 2 * len(self.model.dofs)
        try:
            law = exact_law(controller)
            if not _fits(law, k, m, size):
                raise ValueError("the shapes are others")
            reference = np.array(law.reference, dtype=np.float64).reshape(k, size)
            gains = np.array(law.gains, dtype=np.float64).reshape(k, m, size)
        except (ValueError, OverflowError):
            raise UsageFault("the controller of the certificate does not fit the robot") from None
        return Feedback(reference, gains)

    @property
    def stated(self) -> tuple[Fraction, ...]:
        """The rationals by which the certificate states the parameters."""
        return tuple(value.stated for value in self.parameters)


def _fits(law: ControlLaw, steps: int, inputs: int, measured: int) -> bool:
    """Whether a law has gains for these numbers of steps, inputs and measured quantities."""
    rows = [measured] * inputs
    return [len(row) for row in law.reference] == [measured] * steps and [
        [len(row) for row in gain] for gain in law.gains
    ] == [rows] * steps


def found_design(folder: Path) -> FoundDesign:
    """The design in a result folder.

    Raises:
        UsageFault: there is none, or the certificate or the spec has been altered.
    """
    try:
        claim = _found_claim(folder)
        program, _ = read_copy(folder / "spec", claim.spec, claim.spec_sha256)
        return _design(claim, program)
    except OSError as error:
        raise UsageFault(f"{folder}: the results cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UsageFault(f"{folder}: the certificate is not UTF-8") from None
    except (CertificateError, BadDerivation, SemanticsError, Refused) as error:
        raise UsageFault(f"{folder}: {error}") from None


def found_tube(folder: Path) -> CertifiedTube:
    """The tube of the design in a result folder, computed as ``srgc verify`` does.

    Raises:
        UsageFault: there is no design, or its certificate is refuted before any integration.
        NoAnswer: the tube does not reach the end of the motion.
    """
    try:
        return certified_tube(folder)
    except (CertificateError, Refused) as error:
        raise UsageFault(f"{folder}: {error}") from None
    except OSError as error:
        raise UsageFault(f"{folder}: the results cannot be read: {error.strerror}") from None
    except EnclosureFailure as failure:
        raise NoAnswer(str(failure)) from None


def _found_claim(folder: Path) -> FoundClaim:
    if not folder.is_dir():
        raise no_folder(folder)
    refuse_links(folder)
    refuse_mission(folder)
    path = folder / "certificate.json"
    if not path.exists():
        raise no_certificate(folder)
    claim = from_text(bounded_text(path))
    if not isinstance(claim, FoundClaim):
        raise no_robot(folder, "impossible")
    return claim


def _design(claim: FoundClaim, program: ir.Program) -> FoundDesign:
    task = program.tasks.get(claim.task)
    if task is None:
        raise CertificateError(f"the spec has no task `{claim.task}`")
    family = family_of(program, task)
    derivation = family.replay(claim.derivation)
    if derivation.word != claim.word:
        raise CertificateError("the derivation does not derive the word")
    model = robot_in_task(family, task.origin, derivation)
    parameters = claimed_values(claim, model)
    n, m = len(model.dofs), len(robot_inputs(model))
    if len(claim.start) < 2 * n or any(len(row) != m for row in claim.inputs):
        raise CertificateError("the start or the inputs are not those of the robot")
    start = tuple(exact(text) for text in claim.start)
    task = task_of_motion(claim, task)
    return FoundDesign(claim, program, task, derivation, model, parameters, start)


# --- What ``design.json`` adds to the certificate of a design, checked against it -----------------


@dataclass(frozen=True, slots=True)
class FoundRecord:
    """How a design was found.

    ``structure`` is its number among the structures tried, ``leader`` the effector that followed
    its cell path, ``robustness`` its rho; ``cells`` are the cells that the path names.
    """

    seed: int
    structure: int
    leader: int
    robustness: float
    cells: Abstraction


def found_record(folder: Path, found: FoundDesign) -> FoundRecord:
    """How a design was found, according to ``design.json`` in its folder.

    Raises:
        UsageFault: the file is missing, of another version, or differs from the certificate.
    """
    if not (folder / "design.json").exists():
        raise no_design(folder)
    content = json_object(folder / "design.json")
    ours, theirs = VERSION, content.get("version")
    if theirs != ours:
        raise UsageFault(
            f"{folder} holds results of srgc {theirs}; this is {ours}: run `srgc synth` again"
        )
    try:
        program, task = expanded(found.program, found.task)
        cells = _cells(found, program, task)
        reason = disagreement(folder, found.claim, program, task, cells, found.model)
    except (CertificateError, MapFault, ValueError) as error:
        raise UsageFault(f"{folder}: {error}") from None
    if reason is not None:
        raise UsageFault(f"{folder}: {reason}")
    return _record(folder, content, cells, len(found.model.effectors))


def _cells(found: FoundDesign, program: ir.Program, task: ir.Task) -> Abstraction:
    """The cells of the claim: those of the workspace with the cuts that it states."""
    cuts = [Cut(cell, half_space) for cell, half_space in exact_cuts(found.claim.cuts)]
    return abstract(program.workspaces[task.workspace]).cut(cuts)


def _record(
    folder: Path, content: dict[str, Any], cells: Abstraction, effectors: int
) -> FoundRecord:
    try:
        verdicts = [each["verdict"] for each in content["structures_tried"]]
        record = FoundRecord(
            int(content["seed"]),
            verdicts.index("found"),
            int(content["leader"]),
            float(content["robustness"]),
            cells,
        )
    except (KeyError, TypeError, ValueError):
        record = None
    if record is None or not 0 <= record.leader < effectors or record.seed < 0:
        raise UsageFault(f"{folder / 'design.json'} does not say how the design was found")
    return record
