"""A replay of a result folder from its arguments: the runs and the tube they are compared with."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from pathlib import Path

from solvers.verifier.certified_tube import CertifiedTube, certified_tube
from solvers.verifier.claims.certificate import CertificateError
from solvers.verifier.proofs.enclosure import EnclosureFailure
from solvers.verifier.report import Refused, Report
from solvers.verifier.verification import verify_directory
from srgc.exports.design_names import design_names, design_tree
from srgc.exports.exported_motion import POSITION_UNITS
from srgc.exports.mjcf import substeps
from srgc.faults import NoAnswer, UsageFault
from srgc.replays.mujoco_replay import refuse_unsimulable, replay_in_mujoco
from srgc.replays.replayed_motion import ReplayedMotion
from srgc.replays.tube_comparison import TubeComparison, tube_comparison
from srgc.results.found_design import FoundDesign, found_design


@dataclass(frozen=True, slots=True)
class ReplayRequest:
    """What to replay in, and how.

    ``timestep`` is the longest step in seconds, None: the usual; each of the ``halvings`` divides
    it by two.
    """

    simulator: str
    timestep: Fraction | None
    integrator: str
    halvings: int


@dataclass(frozen=True, slots=True)
class Replay:
    """The runs, one per timestep, and what the tube is.

    ``half_width`` is the largest of coordinates and rates at the instants compared in the last run
    (SI), None without any.  ``verified`` is what the verifier says of the certificate.
    """

    runs: tuple[TubeComparison, ...]
    disturbed: bool
    half_width: float | None
    verified: Report


def replay(folder: Path, request: ReplayRequest) -> Replay:
    """Replay the inputs of a result folder and compare with its tube.

    Raises:
        UsageFault: there is no robot, or it cannot be simulated there.
        NoAnswer: the motion cannot be enclosed.
    """
    design = found_design(folder)
    if request.simulator == "mujoco":
        refuse_unsimulable(design, _count(design, request) * 2**request.halvings)
    # Before the motions: what has no tube may spin as fast as it likes.
    tube = _tube(folder)
    motions = list(_motions(design, request))
    names = design_names(design, design_tree(design))
    units = [POSITION_UNITS[dof.kind] for dof in design.model.dofs]
    joints = list(zip(names.joints, units, strict=True))
    runs = tuple(tube_comparison(tube, motion, joints, names.effectors) for motion in motions)
    width = _half_width(tube, motions[-1])
    return Replay(runs, tube.disturbed, width, verify_directory(folder))


def _motions(design: FoundDesign, request: ReplayRequest) -> Iterator[ReplayedMotion]:
    if request.simulator == "python":
        from srgc.replays.python_replay import replay_in_python

        yield replay_in_python(design)
        return
    count = _count(design, request)
    for halving in range(request.halvings + 1):
        yield replay_in_mujoco(design, count * 2**halving, request.integrator)


def _count(design: FoundDesign, request: ReplayRequest) -> int:
    """Into how many steps of the first simulation a step of the task is divided."""
    if request.timestep is None:
        return substeps(design.task.step)
    return max(1, ceil(design.task.step / request.timestep))


def _tube(folder: Path) -> CertifiedTube:
    try:
        return certified_tube(folder)
    except (CertificateError, Refused) as error:
        raise UsageFault(f"{folder}: {error}") from None
    except OSError as error:
        raise UsageFault(f"{folder}: the results cannot be read: {error.strerror}") from None
    except EnclosureFailure as failure:
        raise NoAnswer(str(failure)) from None


def _half_width(tube: CertifiedTube, motion: ReplayedMotion) -> float | None:
    widths = [
        float((bounds[:, 1] - bounds[:, 0]).max(initial=0.0)) / 2
        for time in motion.times
        if (bounds := tube.at(min(float(time), float(tube.times[-1])))).size
    ]
    return max(widths, default=None)
