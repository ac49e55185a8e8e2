"""Verify a result, independently of the search."""

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
    """The answer of the verifier, with the margin of every condition.

    Attributes:
        report: the whole answer; not a stable interface.
        of_tasks: for a mission, the answers for its designs; not a stable interface.
        mission: the name of the mission that the claim is about; None for a task.
    """

    report: Report
    of_tasks: tuple[tuple[str, Report], ...] = ()
    mission: str | None = None

    @property
    def tasks(self) -> dict[str, Verification]:
        """For a mission, the answer for each design, by the name of its task."""
        return {task: Verification(report) for task, report in self.of_tasks}

    @property
    def valid(self) -> bool:
        """Whether the claim is proved; ``level`` names the SMT solvers that had to be believed."""
        return self.report.outcome.value == "valid"

    @property
    def outcome(self) -> Outcome:
        """The outcome of the check.

        Its ``value`` is "valid", "refuted", "undecided", "not checked", "not as expected" or, if
        two trusted solvers contradict each other, "disagreement".
        """
        return self.report.outcome

    @property
    def verdict(self) -> str | None:
        """The verdict that the certificate claims: "found", "impossible", or None if unknown."""
        return self.report.verdict

    @property
    def task(self) -> str | None:
        """The name of the task that the certificate is about; None if unknown."""
        return self.report.task

    @property
    def spec_sha256(self) -> str | None:
        """The digest of the specification that the certificate is about; None if unknown."""
        return self.report.spec_sha256

    @property
    def control(self) -> str | None:
        """How the robot is controlled: "open loop" or "feedback"; None if nothing is driven."""
        return self.report.control

    @property
    def level(self) -> str | None:
        """The level of the weakest evidence, such as "validated"."""
        return self.report.level

    @property
    def reason(self) -> str | None:
        """Why the claim is not valid, or what it rests on; None if there is nothing to add."""
        return self.report.reason

    @property
    def findings(self) -> tuple[CheckedCondition, ...]:
        """Every condition with its status, margin and unit, and where its margin is attained."""
        return self.report.conditions

    @property
    def margins(self) -> dict[str, float]:
        """The margins of conditions by name, in the units given in ``findings``."""
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
        result: a result of ``synthesize``, ``evolve`` or ``open_result``, or its folder.
        spec: the path of the file that the result has to be about.
        task: the name of the task that it has to be about.
        mission: the name of the mission that it has to be about.
        expect: the verdict that it has to have.
        trust: the names of SMT solvers, such as "z3,cvc5".  Each runs the scripts of refutations in
            its own process, and a refutation is believed if all of them answer "unsat".

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
