"""A proved robot with its motion: what certificates, tables and pictures are made of."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from solvers.search.configuration_search import Configuration
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.trajectory_proof import Motion


@dataclass(frozen=True, slots=True)
class Design:
    """A robot: exact decimals, with the trajectory in floats for tables and pictures.

    ``effector`` starts and reaches, ``leader`` is the one that followed a cell path; ``path`` names
    cells of ``abstraction``.  ``findings`` are what the proof has shown.
    """

    derivation: Derivation
    model: RobotModel
    parameters: tuple[ParameterValue, ...]
    effector: int
    leader: int
    start: tuple[str, ...]
    inputs: tuple[tuple[str, ...], ...]
    path: tuple[tuple[str, ...], ...]
    configuration: Configuration
    abstraction: Abstraction
    findings: tuple[CheckedCondition, ...] = ()

    @property
    def robustness(self) -> float:
        """Rho of the motion."""
        return self.configuration.outcome.robustness


def motion_of(design: Design) -> Motion:
    """The exact numbers of a design."""
    return Motion(
        design.parameters,
        tuple(Fraction(value) for value in design.start),
        tuple(tuple(Fraction(value) for value in row) for row in design.inputs),
        design.effector,
        design.path,
    )
