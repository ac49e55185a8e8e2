"""Lower bounds on an objective over the robots of a structure, for all its parameters.

The word alone gives the bound that results from the ends of the parameter ranges.  A covering of
the parameters can show more: that no robot of the structure with less than some amount does the
task.  The largest such amount is sought by bisection.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.objectives.cheaper_robots import CheaperRobots, Less
from compiler.objectives.objective_text import objective_name, value_text
from compiler.robots.candidate import Candidate
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.impossibility.box_refutation import box_refutation
from solvers.impossibility.box_search import CoveringBudget
from solvers.run_context import RunContext

BUDGET = CoveringBudget(20_000, 1_500, 1_500)
"""The budget for one amount."""
CLOSELY = 50
"""Bounds are sought to a relative accuracy of 1 / ``CLOSELY``."""
MOST_FAILURES = 3
"""After this many amounts without a covering the bound is kept as it is."""


@dataclass(slots=True)
class ParameterBounds:
    """The search for bounds on structures of a family; ``coverings`` are by derivation."""

    family: RobotFamily
    task: ir.Task
    context: RunContext
    coverings: dict[tuple[str, ...], str] = field(default_factory=dict[tuple[str, ...], str])

    def least(
        self, candidate: Candidate, before: Sequence[Less], less: Less, *, reached: bool
    ) -> Fraction:
        """A lower bound on the objective over all robots of a structure that do the task.

        Args:
            candidate: the structure.
            before: what robots of the structure are already known not to achieve.
            less: the objective, the limits on the others, and the largest useful amount.
            reached: whether a robot has this amount, so that bisection begins below it.

        Returns:
            The bound from the word if nothing better is shown.
        """
        word, model = candidate.derivation.word, candidate.model
        low, high = less.amount.of_robot(word, model), less.bound
        if model is None or not model.parameters or less.amount.exact or low >= high:
            return low
        due, failures = not reached or _is_discrete(model), 0
        while failures < MOST_FAILURES:
            trial = high if due else (low + high) / 2
            asked = CheaperRobots(word, model, (*before, Less(less.limits, less.amount, trial)))
            boxes = self._covering(candidate, asked)
            if boxes is not None:
                self.coverings[candidate.derivation.labels] = boxes
                low = trial
            else:
                failures += 1
                high = trial
            due = False
            if high - low <= high / CLOSELY:
                break
        return low

    def _covering(self, candidate: Candidate, asked: CheaperRobots) -> str | None:
        """A covering that refutes some robots of a structure; the journal is consulted first."""
        less = " or ".join(each.text for each in asked.less)
        key = f"least|{' '.join(candidate.derivation.labels)}|{less}"
        known = self.context.journal.recall(key)
        if not isinstance(known, str):
            self.context.check_time()
            self.context.reporter.note(f"is there a proof that no robot has less {_sought(asked)}?")
            workspace = self.family.program.workspaces[self.task.workspace]
            graph = robot_graph(asked.model, self.task.gravity)
            answer = box_refutation(asked.model, graph, workspace, self.task, BUDGET, asked)
            known = "" if answer is None else answer.boxes
            self.context.journal.record(key, known)
        return known or None


def _sought(asked: CheaperRobots) -> str:
    """The objective and the amount in question, which is the last one, in words."""
    objective, amount = asked.less[-1].amount.objective, asked.less[-1].bound
    return f"{objective_name(objective)} than {value_text(objective, amount)}"


def _is_discrete(model: RobotModel) -> bool:
    """Whether some parameter has discrete values."""
    return any(isinstance(each.domain, ir.Choices) for each in model.parameters)
