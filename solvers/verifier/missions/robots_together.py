"""Check a mission's designs together: they are one robot, or rebuilding has its stated cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from compiler.expressions.exact_numbers import exact_text
from compiler.missions.parameter_ranges import Ranges, single
from compiler.missions.robot_changes import Built, built, changes
from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.objective_text import amount_text, value_text
from compiler.objectives.values import MotionValues, value_bounds
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from grammar_lang import ir
from solvers.verifier.claims.certificate import (
    FoundClaim,
    ParameterClaim,
    claimed_values,
    exact,
)
from solvers.verifier.claims.mission_claim import MissionClaim
from solvers.verifier.missions.no_other_robots import least_cost, no_one_robot
from solvers.verifier.missions.refuted_robots import refuted_robots
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.refutations.structure_evidence import FalseClaim
from solvers.verifier.report import Refused


def conditions_together(
    folder: Path,
    claim: MissionClaim,
    program: ir.Program,
    mission: ir.Mission,
    existing: Built | None,
    claims: Sequence[FoundClaim],
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """Check all designs together and return the conditions that hold.

    Raises:
        Refused, FalseClaim: the claim is false.
    """
    if mission.prices is None:
        return _one_robot(folder, claim, program, mission, claims, watch)
    steps = _built(claims, program)
    cost = Fraction(0)
    for before, after in zip([existing, *steps[:-1]], steps, strict=True):
        if before is not None:
            cost += changes(before, after, mission.prices, mission.free).cost
    if claim.cost is None or claim.least is None or claim.objectives:
        raise Refused("the claim does not say what the changes cost")
    if exact(claim.cost) != cost:
        raise Refused(f"the changes cost {exact_text(cost)}, not {claim.cost}")
    if mission.most is not None and cost > mission.most:
        raise Refused(f"the changes cost {exact_text(cost)}, more than {exact_text(mission.most)}")
    least = exact(claim.least)
    if least > cost:
        raise Refused(f"the robots cost {claim.cost}, less than the least that is claimed")
    if least > 0:
        _check_least(folder, claim, program, mission, existing, least, watch)
    said = f"changes {claim.cost}"
    if least > 0 or cost == 0:
        said += ": no robots cost less" + ("" if least == cost else f" than {claim.least}")
    return (CheckedCondition(said, Status.HOLDS, NO_MARGIN, ""),)


def _check_least(
    folder: Path,
    claim: MissionClaim,
    program: ir.Program,
    mission: ir.Mission,
    existing: Built | None,
    least: Fraction,
    watch: Watch,
) -> None:
    robots = refuted_robots(folder, claim, program, mission.tasks, (), watch)
    if not all(each for task in robots for each in task.by_boxes):
        raise FalseClaim("a least cost has no scripts as evidence")
    prices = mission.prices or ir.Prices()
    found = least_cost(mission, prices, robots, existing, claim.modules)
    if found is not None and found < least:
        raise FalseClaim(
            f"robots that cost {exact_text(found)} are not refuted, and {claim.least} is claimed "
            "to be the least"
        )


def _built(claims: Sequence[FoundClaim], program: ir.Program) -> list[Built]:
    """The robots of the designs."""
    return [built(each.word, program.modules, _values(each.parameters)) for each in claims]


def _values(parameters: Sequence[ParameterClaim]) -> dict[tuple[int, str], Ranges]:
    return {(each.symbol, each.name): single(exact(each.value)) for each in parameters}


def _one_robot(
    folder: Path,
    claim: MissionClaim,
    program: ir.Program,
    mission: ir.Mission,
    claims: Sequence[FoundClaim],
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    first = claims[0]
    for name, other in zip(mission.tasks[1:], claims[1:], strict=True):
        if other.derivation != first.derivation or other.word != first.word:
            raise Refused(f"task `{name}` has another robot than task `{mission.tasks[0]}`")
        if _values(other.parameters) != _values(first.parameters):
            raise Refused(f"task `{name}` has other parameters than task `{mission.tasks[0]}`")
    if claim.cost is not None or claim.least is not None or claim.existing is not None:
        raise Refused("the claim is about changes, and one robot is not changed")
    same = CheckedCondition("one robot for all tasks", Status.HOLDS, NO_MARGIN, "")
    return (same, *_objectives(folder, claim, program, mission, first, watch))


def _objectives(
    folder: Path,
    claim: MissionClaim,
    program: ir.Program,
    mission: ir.Mission,
    found: FoundClaim,
    watch: Watch,
) -> list[CheckedCondition]:
    """Check the claimed objectives of the robot and return the conditions that they state."""
    task = program.tasks[mission.tasks[0]]
    known = [
        each
        for each in amounts(program, replace(task, minimize=mission.minimize))
        if each.is_ordering
    ]
    if [amount.text for amount in known] != [each.objective for each in claim.objectives]:
        raise Refused("the objectives of the claim are not those of the mission")
    family = family_of(program, task)
    model = robot_in_task(family, None, family.replay(found.derivation))
    nothing = MotionValues(None, Fraction(0), None)
    said, limits = list[CheckedCondition](), list[tuple[Amount, Fraction]]()
    robots = None
    bounds = [program.tasks[name].modules for name in mission.tasks]
    most = min((bound for bound in bounds if bound is not None), default=None)
    if most is not None and claim.modules != most:
        raise Refused("the bound on modules is not that of the tasks")
    for amount, stated in zip(known, claim.objectives, strict=True):
        value, least = exact(stated.value), exact(stated.least)
        bounds_of = value_bounds(amount, found.word, model, claimed_values(found, model), nothing)
        if bounds_of is None or not bounds_of[0] <= value <= bounds_of[1] + _close(bounds_of):
            raise Refused(f"`{amount.text}` is not {stated.value}")
        if least > value:
            raise Refused(f"the least of `{amount.text}` is more than the robot has")
        if least > 0:
            if robots is None:
                robots = refuted_robots(folder, claim, program, mission.tasks, (), watch)
                if not all(each for task_ in robots for each in task_.by_boxes):
                    raise FalseClaim("a least value has no scripts as evidence")
            no_one_robot(claim, robots, claim.modules, limits, (amount, least))
        limits.append((amount, value))
        text = amount_text(amount.objective, value)
        if least > 0:
            default = most is None and claim.modules is not None
            which = f"no robot with up to {claim.modules} modules" if default else "no robot"
            text += f": {which} has less" + (
                "" if least == value else f" than {value_text(amount.objective, least)}"
            )
        said.append(CheckedCondition(text, Status.HOLDS, NO_MARGIN, ""))
    return said


def _close(bounds: tuple[Fraction, Fraction]) -> Fraction:
    """How far above the bounds a stated value may be; zero if the value is rational."""
    low, high = bounds
    return Fraction(0) if low == high else Fraction(1, 10**9) * max(Fraction(1), abs(high))
