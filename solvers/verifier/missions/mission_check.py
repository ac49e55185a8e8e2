"""Check a mission: each design on its own, then one robot or the costs, then lower bounds.

No code of the search is used. The designs are verified as results of their own. Whether they are
one robot, and otherwise what rebuilding costs, is computed from their certificates.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from compiler.expressions.exact_numbers import exact_text
from compiler.missions.robot_changes import Built
from compiler.robots.normal_form import family_of
from compiler.words.structures import InfiniteAmbiguityError
from compiler.workspaces.map_header import MapFault
from grammar_lang import ir
from solvers.verdict import MISSION, Claimed
from solvers.verifier.claims.certificate import (
    CertificateError,
    FoundClaim,
)
from solvers.verifier.claims.mission_claim import (
    MissionClaim,
    mission_from_text,
)
from solvers.verifier.claims.spec_copy import bounded_text, read_claim, spec_of
from solvers.verifier.missions.no_other_robots import least_cost, no_one_robot
from solvers.verifier.missions.refuted_robots import refuted_robots
from solvers.verifier.missions.robot_before import posed_mission, robot_before
from solvers.verifier.missions.robots_together import conditions_together
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from solvers.verifier.refutations.solver_process import DisagreementError, named_solvers
from solvers.verifier.refutations.structure_evidence import FalseClaim, trusted_text
from solvers.verifier.report import Outcome, Refused, Report
from solvers.verifier.verification import Expected, verify_directory

TASKS = "tasks"


@dataclass(frozen=True, slots=True)
class MissionReport:
    """The result of checking a ``mission``; ``tasks`` has the reports on its designs."""

    report: Report
    tasks: tuple[tuple[str, Report], ...] = ()
    mission: str | None = None


def is_mission(folder: Path) -> bool:
    """Whether a folder holds the result of a mission."""
    return (folder / MISSION).is_file()


def verify_mission(
    folder: Path,
    spec: Path | None = None,
    trust: str | None = None,
    watch: Watch = UNWATCHED,
    mission: str | None = None,
    verdict: Claimed | None = None,
) -> MissionReport:
    """Check the claim of a mission's result folder.

    Args:
        folder: a folder written by ``srgc synth --mission`` or ``srgc evolve``.
        spec: a spec file that the result must be about, in addition to the folder's own copy.
        trust: names of SMT solvers whose ``unsat`` is trusted, as for a task.
        watch: receives progress.
        mission: the mission that the claim must be about.
        verdict: the verdict that the claim must have.
    """
    claim: MissionClaim | None = None
    try:
        claim = mission_from_text(bounded_text(folder / MISSION))
        other = _differs(claim, mission, verdict)
        if other is not None:
            return MissionReport(Report(Outcome.UNEXPECTED, None, None, other))
        found = _judged(folder, claim, spec, trust, watch)
    except OSError as error:
        reason = f"the results cannot be read: {error.strerror}"
        found = MissionReport(Report(Outcome.UNDECIDED, None, None, reason))
    except DisagreementError as error:
        found = MissionReport(Report(Outcome.DISAGREEMENT, None, None, str(error)))
    except UnicodeDecodeError:
        reason = "the claim of the mission is not UTF-8"
        found = MissionReport(Report(Outcome.REFUTED, None, None, reason))
    except (CertificateError, FalseClaim, InfiniteAmbiguityError) as error:
        found = MissionReport(Report(Outcome.REFUTED, None, None, str(error)))
    except MapFault as fault:
        reason = f"the spec has errors: {fault.message}"
        found = MissionReport(Report(Outcome.REFUTED, None, None, reason))
    except Refused as refusal:
        found = MissionReport(Report(refusal.outcome, None, None, str(refusal)))
    if claim is None:
        return found
    about = replace(
        found.report, verdict=claim.kind, task=None, spec=claim.spec, spec_sha256=claim.spec_sha256
    )
    return replace(found, report=about, mission=claim.mission)


def _differs(claim: MissionClaim, mission: str | None, verdict: Claimed | None) -> str | None:
    if mission not in (None, claim.mission):
        return f"the claim is about mission `{claim.mission}`, not `{mission}`"
    if verdict not in (None, claim.kind):
        return f"the claim says {claim.kind}, not {verdict}"
    return None


def _judged(
    folder: Path, claim: MissionClaim, spec: Path | None, trust: str | None, watch: Watch
) -> MissionReport:
    program = spec_of(folder, claim.spec, claim.spec_sha256, spec)
    mission = _mission(claim, program)
    before = robot_before(folder, claim, mission, program, trust, watch)
    existing = before.robot
    if claim.kind == "impossible":
        found = _impossible(folder, claim, program, mission, existing, trust, watch)
        return replace(found, report=replace(found.report, conditions=before.said))
    reports = tuple(
        (
            name,
            verify_directory(folder / TASKS / name, spec, trust, watch, Expected(name, "found")),
        )
        for name in mission.tasks
    )
    for name, report in reports:
        if report.outcome is not Outcome.VALID:
            reason = f"task `{name}`: {report.reason}"
            outcome = report.outcome
            if outcome is Outcome.UNEXPECTED:
                outcome = Outcome.REFUTED
            return MissionReport(Report(outcome, "found", None, reason), reports)
    claims = [_found(folder, claim, name) for name in mission.tasks]
    conditions = conditions_together(folder, claim, program, mission, existing, claims, watch)
    report = Report(Outcome.VALID, "found", "validated", None, (*before.said, *conditions))
    return MissionReport(report, reports)


def _mission(claim: MissionClaim, program: ir.Program) -> ir.Mission:
    """The mission of the claim: one of the file, or one step from an existing robot."""
    if claim.posed is None:
        mission = program.missions.get(claim.mission)
        if mission is None:
            raise Refused(f"the spec has no mission `{claim.mission}`")
        return mission
    if claim.mission not in program.tasks:
        raise Refused(f"the spec has no task `{claim.mission}`")
    return posed_mission(claim.mission, claim.posed, program)


def _found(folder: Path, claim: MissionClaim, name: str) -> FoundClaim:
    found = read_claim(folder / TASKS / name)
    same = (found.spec, found.spec_sha256) == (claim.spec, claim.spec_sha256)
    if not isinstance(found, FoundClaim) or not same:
        raise Refused(f"the design of task `{name}` is about another spec")
    return found


# --- No robots ------------------------------------------------------------------------------------


def _impossible(
    folder: Path,
    claim: MissionClaim,
    program: ir.Program,
    mission: ir.Mission,
    existing: Built | None,
    trust: str | None,
    watch: Watch,
) -> MissionReport:
    if claim.cost is not None or claim.least is not None or claim.objectives:
        raise Refused("the claim says what robots cost, and that there are none")
    solvers = named_solvers(trust)
    robots = refuted_robots(folder, claim, program, mission.tasks, solvers, watch)
    if not any(each.separated for each in robots):
        if mission.prices is None:
            _check_bound(claim, program, mission)
            no_one_robot(claim, robots, claim.modules)
        else:
            least = least_cost(mission, mission.prices, robots, existing, claim.modules)
            if least is not None and (mission.most is None or least <= mission.most):
                raise FalseClaim(f"robots that cost {exact_text(least)} are not refuted")
    by_boxes = [each for task in robots for each in task.by_boxes]
    left = len(by_boxes) - sum(by_boxes)
    if not left:
        return MissionReport(Report(Outcome.VALID, "impossible", "validated", None))
    if solvers:
        who = trusted_text(solvers)
        return MissionReport(Report(Outcome.VALID, "impossible", who, None))
    reason = (
        f"no solver has run on the scripts of {left} of {len(by_boxes)} structures; "
        "--trust z3 runs z3 on them"
    )
    return MissionReport(Report(Outcome.UNCHECKED, "impossible", None, reason))


def _check_bound(claim: MissionClaim, program: ir.Program, mission: ir.Mission) -> None:
    """Check that the claim is about all robots up to the tasks' least bound on modules."""
    bounds = [program.tasks[name].modules for name in mission.tasks]
    most = min((bound for bound in bounds if bound is not None), default=None)
    if claim.modules != most:
        raise Refused("the bound on modules is not that of the tasks")
    if most is None:
        task = program.tasks[mission.tasks[0]]
        if not family_of(program, task).language.is_finite():
            raise Refused("the language is infinite and no task has a bound on modules")
