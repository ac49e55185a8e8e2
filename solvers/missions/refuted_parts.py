"""Coverings of the parts of a structure that only a solver refutes as a whole.

A covering is about all values between the least and the greatest choice of a parameter, a solver
only about the choices.  A structure may therefore have a covering only after its choices are split.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compiler.missions.parameter_boxes import BoxTree, choices_halved
from compiler.time_limits.time_limit import OutOfTimeError
from compiler.words.derivation import Derivation
from solvers.missions.mission_result import BoxEvidence, CutRobot
from solvers.missions.task_robots import Labels, TaskRobots

MOST_PARTS = 32
"""The most coverings sought for one structure."""
MOST_FAILED = 8
"""After this many structures without coverings no further ones are tried."""


@dataclass(slots=True)
class RefutedParts:
    """Structures refuted part by part, by the index of the task and the derivation.

    ``shared`` says that one robot does all tasks, so that a structure is refuted if it is in one.
    """

    tasks: Sequence[TaskRobots]
    shared: bool
    cut: dict[tuple[int, Labels], CutRobot] = field(
        default_factory=dict[tuple[int, Labels], CutRobot]
    )
    late: bool = False
    """Whether the time limit was reached."""
    _failed: set[tuple[int, Labels]] = field(default_factory=set[tuple[int, Labels]])

    def refutes(self, number: int, derivation: Derivation) -> bool:
        """Whether a structure is refuted in a task by coverings of its parts."""
        key = number, derivation.labels
        if key in self.cut:
            return True
        if self.late or key in self._failed or len(self._failed) == MOST_FAILED:
            return False
        robots = self.tasks[number]
        if not robots.is_known(derivation) or robots.model(derivation) is None:
            return False
        try:
            found = self._covered(number, derivation)
        except OutOfTimeError:
            self.late = True
            return False
        if found is None:
            self._failed.add(key)
            return False
        self.cut[key] = found
        return True

    def _covered(self, number: int, derivation: Derivation) -> CutRobot | None:
        robots = self.tasks[number]
        tree = BoxTree(robots.box(derivation))
        task = None if self.shared else number
        found = CutRobot(task, derivation.word, derivation.labels, tree)
        waiting, asked = [tree], 0
        while waiting:
            node = waiting.pop(0)
            asked += 1
            boxes = robots.covering(derivation, node.box) if asked <= MOST_PARTS else None
            if boxes is not None:
                node.refuted, found.evidence[id(node)] = True, BoxEvidence(number, boxes)
                continue
            cut = choices_halved(node.box)
            if cut is None or asked >= MOST_PARTS:
                return None
            waiting += node.split(cut)
        return found
