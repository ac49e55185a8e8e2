"""The robot of a result folder, rebuilt from its certificate and its own copy of the spec.

Nothing is proved here: that the robot does its task is what ``srgc verify`` shows.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.family import family_of
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from compiler.words.derivation import BadDerivation, Derivation
from grammar_lang import ir
from solvers.verifier.claims.certificate import (
    CertificateError,
    FoundClaim,
    claimed_values,
    exact,
    from_text,
)
from solvers.verifier.claims.spec_copy import bounded_text, read_copy
from srgc.near_places import no_folder
from srgc.results.folder_layout import refuse_links
from srgc.session import UsageFault


@dataclass(frozen=True, slots=True)
class FoundDesign:
    """A design: the claim of the certificate, and what it is about."""

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
    def stated(self) -> tuple[Fraction, ...]:
        """The rationals that the certificate states the parameters by."""
        return tuple(value.stated for value in self.parameters)


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
    except (CertificateError, BadDerivation, SemanticsError) as error:
        raise UsageFault(f"{folder}: {error}") from None


def _found_claim(folder: Path) -> FoundClaim:
    if not folder.is_dir():
        raise no_folder(folder)
    refuse_links(folder)
    path = folder / "certificate.json"
    if not path.exists():
        raise UsageFault(f"{folder} has no certificate: no robot was found")
    claim = from_text(bounded_text(path))
    if not isinstance(claim, FoundClaim):
        raise UsageFault(f"{folder}: the verdict is impossible, so there is no robot")
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
    return FoundDesign(claim, program, task, derivation, model, parameters, start)
