"""What is found out about a robot before any motion is searched: refuted, inadmissible, or open.

A robot without a regular mass matrix cannot be driven: it is *inadmissible*.  Samples raise the
suspicion, a proof settles it.  Where M fails at single poses or parameters only (a length of zero,
say), the robot is searched like any other: the certificate proves M along the motion.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.mass_matrix.mass_matrix_check import mass_matrix_check
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.parameters.parameter_space import parameter_space
from solvers.progress import Conduct, Recorded
from solvers.refutation.structure_refutation import Refutation, refute_structure

SAMPLES = 4
SINGULAR = 1e-12
BOXES = 256


@dataclass(frozen=True, slots=True)
class Examination:
    """The refutation that was tried, and why the robot cannot be driven, or None."""

    refutation: Refutation
    inadmissible: str | None

    def record(self) -> Recorded:
        """The examination as a value of JSON."""
        return [asdict(self.refutation), self.inadmissible]


def examination_of(record: Recorded) -> Examination | None:
    """The examination of a record, or None where it is not one of this version."""
    match record:
        case [dict(refutation), None | str() as blocked]:
            try:
                return Examination(Refutation(**refutation), blocked)  # type: ignore[arg-type]
            except TypeError:
                return None
        case _:
            return None


def examine(
    model: RobotModel, numeric: NumericRobot, program: ir.Program, task: ir.Task, conduct: Conduct
) -> Examination:
    """Examine a robot; a refuted one is not looked at further."""
    refutation = refute_structure(model, numeric, program, task, conduct)
    blocked = None if refutation.refuted else inadmissible(model, numeric)
    return Examination(refutation, blocked)


def inadmissible(model: RobotModel, numeric: NumericRobot) -> str | None:
    """Why a robot cannot be driven, or None."""
    if not model.dofs or not _singular_at_all_samples(model, numeric):
        return None
    found = mass_matrix_check(model, budget=BOXES)
    return None if found.status == "proved" else f"the mass matrix is {found.text}"


def _singular_at_all_samples(model: RobotModel, numeric: NumericRobot) -> bool:
    """Whether M is singular, indefinite or not finite at all of a few random points."""
    rng = np.random.default_rng(0)
    space = parameter_space(model)
    for _ in range(SAMPLES):
        theta = rng.uniform(space.lower, space.upper)
        mass = numeric.mass_matrix(rng.uniform(-1, 1, size=(SAMPLES, len(model.dofs))), theta)
        finite = mass[np.isfinite(mass).all(axis=(1, 2))]
        eigenvalues = np.linalg.eigvalsh(finite)
        if np.any(eigenvalues[:, 0] > SINGULAR * eigenvalues[:, -1]):
            return False
    return True
