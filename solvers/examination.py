"""What is found out about a robot before any motion is searched: refuted, inadmissible, or open."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.progress import Conduct, Recorded
from solvers.refutation.admissibility import inadmissible
from solvers.refutation.structure_refutation import Refutation, refute_structure


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
