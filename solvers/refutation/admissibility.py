"""Whether the equations of motion of a robot can be solved for its accelerations anywhere.

A robot without a regular mass matrix cannot be driven: it is *inadmissible*.  Samples raise the
suspicion, a proof settles it.  Where M fails at single poses or parameters only (a length of zero,
say), the robot is searched like any other: the certificate proves M along the motion.
"""

from __future__ import annotations

import numpy as np

from compiler.definiteness.mass_matrix_check import mass_matrix_check
from compiler.discretisation.float_reading import FloatReading
from compiler.robots.robot import RobotModel
from solvers.parameters.parameter_space import parameter_space

SAMPLES = 4
SINGULAR = 1e-12
BOXES = 256


def inadmissible(model: RobotModel, reading: FloatReading) -> str | None:
    """Why a robot cannot be driven, or None."""
    if not model.dofs or not _singular_at_all_samples(model, reading):
        return None
    found = mass_matrix_check(model, budget=BOXES)
    return None if found.status == "proved" else f"the mass matrix is {found.text}"


def _singular_at_all_samples(model: RobotModel, reading: FloatReading) -> bool:
    """Whether M is singular, indefinite or not finite at all of a few random points."""
    rng = np.random.default_rng(0)
    space = parameter_space(model)
    for _ in range(SAMPLES):
        theta = rng.uniform(space.lower, space.upper)
        mass = reading.mass_matrix(rng.uniform(-1, 1, size=(SAMPLES, len(model.dofs))), theta)
        finite = mass[np.isfinite(mass).all(axis=(1, 2))]
        eigenvalues = np.linalg.eigvalsh(finite)
        if np.any(eigenvalues[:, 0] > SINGULAR * eigenvalues[:, -1]):
            return False
    return True
