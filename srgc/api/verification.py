"""The independent check of a result."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from solvers.verifier.missions.mission_check import MissionReport
    from solvers.verifier.proofs.checked_condition import CheckedCondition
    from solvers.verifier.report import Outcome, Report


@dataclass(frozen=True, slots=True)
class Verification:
    """The verifier's answer, with the margin of every condition.

    Attributes:
        report: the answer itself; not a stable interface.
        of_tasks: of a mission the answers on its designs; not a stable interface.
        mission: the name of the mission that the claim is about; None of a task.
    """

    report: Report
    of_tasks: tuple[tuple[str, Report], ...] = ()
    mission: str | None = None

    @property
    def tasks(self) -> dict[str, Verification]:
        """Of a mission the answer on each design, by the name of its task."""
        return {task: Verification(report) for task, report in self.of_tasks}

    @property
    def valid(self) -> bool:
        """Whether the claim is proved, with nothing taken on trust."""
        return self.report.outcome.value == "valid"

    @property
    def outcome(self) -> Outcome:
        """Its ``value``: "valid", "refuted", "undecided", "not checked" or "not as expected"."""
        return self.report.outcome

    @property
    def verdict(self) -> str | None:
        """What the certificate claims: "found" or "impossible"; None where that is not known."""
        return self.report.verdict

    @property
    def task(self) -> str | None:
        """The name of the task that the certificate is about; None where that is not known."""
        return self.report.task

    @property
    def spec_sha256(self) -> str | None:
        """The digest of the specification that it is about; None where that is not known."""
        return self.report.spec_sha256

    @property
    def control(self) -> str | None:
        """What drives the robot: "open loop" or "feedback"; None where nothing does."""
        return self.report.control

    @property
    def level(self) -> str | None:
        """That of the weakest evidence, as "validated"."""
        return self.report.level

    @property
    def reason(self) -> str | None:
        """Why the claim is not valid, or on what it rests; None where nothing is to be said."""
        return self.report.reason

    @property
    def findings(self) -> tuple[CheckedCondition, ...]:
        """Every condition with its status, margin, unit, and where the margin is attained."""
        return self.report.conditions

    @property
    def margins(self) -> dict[str, float]:
        """By the name of a condition how much is left, in the unit of its finding."""
        return {one.name: one.margin for one in self.findings if isfinite(one.margin)}

    def __repr__(self) -> str:
        return f"<Verification: {str(self).partition(chr(10))[0]}>"

    def __str__(self) -> str:
        if self.mission is not None:
            from srgc.text_reports.mission_report import mission_check_text

            return mission_check_text(self._of_mission)
        from srgc.text_reports.verification_report import verification_text

        return verification_text(self.report)

    @property
    def _of_mission(self) -> MissionReport:
        from solvers.verifier.missions.mission_check import MissionReport

        return MissionReport(self.report, self.of_tasks, self.mission)

    def _repr_html_(self) -> str:
        from srgc.api.displays import verification_html

        return verification_html(self.report, self.of_tasks)


@spoken
def verify(
    result: str | PathLike[str],
    *,
    spec: str | PathLike[str] | None = None,
    task: str | None = None,
    mission: str | None = None,
    expect: Literal["found", "impossible"] | None = None,
    trust: str | None = None,
) -> Verification:
    """Check a result independently of the search that made it.

    Args:
        result: what ``synthesize`` or ``open_result`` gives, or the folder of ``srgc synth``.
        spec: also check that it is about this file.
        task: it has to be about the task of this name.
        mission: it has to be about the mission of this name.
        expect: it has to have this verdict.
        trust: names of SMT solvers, as "z3,cvc5": run the scripts of refutations again, each solver
            in a process of its own, and believe "unsat" if all say so.

    Raises:
        SrgcError: there is no such folder or file.
    """
    from solvers.verifier.missions.mission_check import is_mission, verify_mission
    from solvers.verifier.verification import Expected, verify_directory
    from srgc.search_options import named_smt_solvers

    folder, file = Path(result), None if spec is None else Path(spec)
    if not folder.is_dir():
        raise UsageFault(f"{folder} is not a folder")
    if file is not None and not file.is_file():
        raise UsageFault(f"{file} is not a file")
    named_smt_solvers(trust)
    if expect not in (None, "found", "impossible"):
        raise UsageFault("`expect` is found, impossible or None")
    if mission is not None or is_mission(folder):
        if task is not None:
            raise UsageFault(f"{folder} is about a mission: give the folder of a task in it")
        found = verify_mission(folder, file, trust, mission=mission, verdict=expect)
        return Verification(found.report, found.tasks, found.mission)
    expected = Expected(task, expect)
    return Verification(verify_directory(folder, file, trust, expected=expected))
