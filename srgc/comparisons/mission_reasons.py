"""What each task of a mission refutes, and what would remain without the refutations of a task.

The verifier's code computes what remains, from evidence that it checks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from compiler.missions.robot_changes import built
from compiler.words.structures import InfiniteAmbiguityError
from solvers.verifier.claims.certificate import CertificateError
from solvers.verifier.claims.mission_claim import CutClaim, MissionClaim, TreeClaim
from solvers.verifier.missions.no_other_robots import LeftRobots, cheapest_left, no_one_robot
from solvers.verifier.missions.refuted_robots import RefutedRobots, refuted_robots
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from solvers.verifier.refutations.structure_evidence import FalseClaim
from solvers.verifier.report import Refused
from srgc.faults import UsageFault
from srgc.results.mission_folder import MissionFolder, TaskRefutations, mission_folder
from srgc.results.undecided_robots import StatedUndecided, undecided_by_task


@dataclass(frozen=True, slots=True)
class Without:
    """What would remain without the refutations of one task.

    ``robots`` are the cheapest remaining robots of a mission whose robots are rebuilt; None for
    other missions, or if no robots remain.  ``one_left``: for a mission with one robot, whether
    some robot remains.
    """

    robots: LeftRobots | None
    one_left: bool | None


@dataclass(frozen=True, slots=True)
class TaskReasons:
    """What rules robots out in a task; ``without`` is None if that is not known."""

    refuted: TaskRefutations
    without: Without | None

    @property
    def task(self) -> str:
        """The name of the task."""
        return self.refuted.task

    @property
    def says(self) -> tuple[str, ...]:
        """What was shown, as sentences."""
        said = [*self.refuted.lemmas]
        if self.refuted.separated:
            said.append("obstacles separate the start from the target, for every robot")
        for reason, count, word in self.refuted.reasons:
            many = "1 structure" if count == 1 else f"{count} structures"
            said.append(f"{many}: {reason}, as {' '.join(word)}")
        if self.refuted.boxes == 1:
            said.append("1 box of the parameters of a structure that is not refuted as a whole")
        elif self.refuted.boxes:
            said.append(
                f"{self.refuted.boxes} boxes of the parameters of structures that are not refuted "
                "as a whole"
            )
        return tuple(said)


@dataclass(frozen=True, slots=True)
class MissionReasons:
    """Why a mission has its verdict.

    ``left`` are the cheapest robots that are not refuted, for a mission whose robots are rebuilt;
    None if no robots remain, or if nothing is claimed.
    """

    mission: MissionFolder
    tasks: tuple[TaskReasons, ...]
    left: LeftRobots | None

    @property
    def undecided(self) -> dict[str | None, list[StatedUndecided]]:
        """Maps each task, or None for all together, to its robots neither found nor refuted."""
        return undecided_by_task(self.mission.undecided)


def mission_reasons(folder: Path, watch: Watch = UNWATCHED) -> MissionReasons:
    """What rules robots out of the mission of a result folder.

    Raises:
        UsageFault: the folder has no results of a mission, they have been altered, or the evidence
            does not show what it should.
    """
    mission = mission_folder(folder)
    if mission.claim is None or not mission.refuted:
        return MissionReasons(mission, tuple(TaskReasons(r, None) for r in mission.refuted), None)
    try:
        names = mission.mission.tasks
        robots = refuted_robots(folder, mission.claim, mission.program, names, (), watch)
    except (CertificateError, FalseClaim, Refused, InfiniteAmbiguityError) as error:
        raise UsageFault(f"{folder}: {error}; `srgc verify` says more") from None
    except OSError as error:
        raise UsageFault(f"{folder}: the results cannot be read: {error.strerror}") from None
    tasks = tuple(
        TaskReasons(refuted, _without(mission, mission.claim, robots, number))
        for number, refuted in enumerate(mission.refuted)
    )
    return MissionReasons(mission, tasks, _left(mission, mission.claim, robots))


def _without(
    mission: MissionFolder, claim: MissionClaim, robots: Sequence[RefutedRobots], number: int
) -> Without | None:
    """What would remain without the refutations of task ``number``; None if nothing changes."""
    own = mission.refuted[number]
    needed = own.structures or own.lemmas or own.boxes or own.separated
    if not needed or len(robots) == 1:
        return None
    blank = RefutedRobots(
        robots[number].program, robots[number].task, robots[number].evidence, robots[number].family
    )
    others = [blank if place == number else each for place, each in enumerate(robots)]
    if mission.mission.prices is not None:
        left = _left(mission, claim, others)
        return None if left is None else Without(left, None)
    if mission.verdict == "found":
        return None
    boxes = tuple(replace(each, tree=_left_out(each.tree, number)) for each in claim.boxes)
    return Without(None, _one_left(replace(claim, boxes=boxes), others))


def _left_out(tree: TreeClaim, number: int) -> TreeClaim:
    """The boxes of a robot for all tasks, without the refutations of task ``number``."""
    if isinstance(tree, CutClaim):
        first, second = (_left_out(part, number) for part in tree.parts)
        return replace(tree, parts=(first, second))
    return None if tree is None or tree.task == number else tree


def _left(
    mission: MissionFolder, claim: MissionClaim, robots: Sequence[RefutedRobots]
) -> LeftRobots | None:
    """The cheapest remaining robots; None also if there are too many to compare."""
    prices = mission.mission.prices
    if prices is None or any(each.separated for each in robots):
        return None
    before = mission.before
    existing = None
    if before is not None:
        existing = built(before.word, mission.program.modules, before.values)
    try:
        return cheapest_left(mission.mission, prices, robots, existing, claim.modules)
    except FalseClaim:
        return None


def _one_left(claim: MissionClaim, robots: Sequence[RefutedRobots]) -> bool:
    """Whether a robot remains that no task refutes."""
    if any(each.separated for each in robots):
        return False
    try:
        no_one_robot(claim, robots, claim.modules)
    except FalseClaim:
        return True
    return False
