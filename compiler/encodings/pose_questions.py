"""The poses of its effectors and of its whole body that a robot must be able to take for a task."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.encodings.region_terms import PolygonTerms, polygon_terms
from compiler.robots.given_start import given_start
from compiler.robots.robot import RobotModel
from compiler.tasks.necessary import task_visits
from compiler.tasks.specification import missing_effector
from compiler.workspaces.polytope import Polytope, polytope_of, refuting_polytope
from grammar_lang import ir

# --- What a task demands of the whole body of a robot at any instant, in the plane ----------------


MOST = 24
"""If there are more obstacles, those farthest from the middle of the bounds are left out."""


@dataclass(frozen=True, slots=True)
class BodyConditions:
    """Obstacles that bodies and effectors avoid; ``bounds_body``: bodies stay within the bounds.

    Margins and the radii of rods are left out, which can only add poses.
    """

    bodies: tuple[PolygonTerms, ...]
    effectors: tuple[PolygonTerms, ...]
    bounds_body: bool


def body_conditions(workspace: ir.Workspace, task: ir.Task) -> BodyConditions | None:
    """The demands of a task; None if it demands nothing of bodies, or in space."""
    bodies = _avoided(task, "body")
    if workspace.dimension != 2 or not (bodies or task.bounds_body):
        return None
    return BodyConditions(
        _polygons(workspace, bodies),
        _polygons(workspace, _avoided(task, "effector")),
        task.bounds_body,
    )


def _avoided(task: ir.Task, subject: str) -> tuple[str, ...]:
    """The regions that an ``avoid`` with that subject names, each once, in the order named."""
    names = (name for item in task.avoid if item.subject == subject for name in item.regions)
    return tuple(dict.fromkeys(names))


def _polygons(workspace: ir.Workspace, names: tuple[str, ...]) -> tuple[PolygonTerms, ...]:
    shapes = (
        refuting_polytope(workspace.region(name).shape, workspace.dimension) for name in names
    )
    terms = [found for found in map(polygon_terms, shapes) if found is not None]
    middle = polytope_of(workspace.bounds.shape, workspace.dimension)
    if len(terms) > MOST:
        terms.sort(key=lambda polygon: _distance(polygon, middle))
    return tuple(terms[:MOST])


def _distance(polygon: PolygonTerms, bounds: Polytope) -> Fraction:
    """The squared distance between the means of the vertices, m^2."""
    centre = [sum(column, Fraction(0)) / len(polygon.vertices)
              for column in zip(*polygon.vertices, strict=True)]  # fmt: skip
    return sum(((x - y) ** 2 for x, y in zip(centre, bounds.centre, strict=True)), Fraction(0))


# --- The poses that a robot must be able to take to do a task: questions for the solvers ----------
#
# Each is necessary: a robot for which one of them has no answer cannot do the task.


@dataclass(frozen=True, slots=True)
class PoseQuestion:
    """Exact half-spaces of the regions, and the effectors (from 0) that the clauses name.

    ``start`` is None if the task gives the start pose by its coordinates. If ``start_effector`` is
    None, it is the effector that reaches, or any effector with ``any_start``. If ``reach_effector``
    is None, it is any effector. ``start_at`` is a given start pose: a robot that cannot take it is
    not a candidate; nor is one with fewer than ``effectors`` effectors. ``goal`` names the target
    in words, and ``by`` is the time (s) not after which the effector is there, for a stay to the
    end from then on; None is the end.
    """

    start: tuple[ir.HalfSpace, ...] | None
    target: tuple[ir.HalfSpace, ...]
    bounds: tuple[ir.HalfSpace, ...]
    start_effector: int | None = None
    reach_effector: int | None = None
    start_at: ir.StartAt | None = None
    any_start: bool = False
    effectors: int = 0
    goal: str = "the target"
    by: Fraction | None = None

    @property
    def who(self) -> str:
        """The effector of the target pose, in words that follow those for the start pose."""
        same = self.start_effector == self.reach_effector and not self.any_start
        return "it" if same or self.reach_effector is None else "another one"


def pose_questions(workspace: ir.Workspace, task: ir.Task) -> tuple[PoseQuestion, ...]:
    """The questions of a task: each has an answer for every robot that does the task.

    They are about the start and the target, and about the start and every region that the formulas
    make an effector visit; about the start alone if there are neither.
    """
    start = task.start if isinstance(task.start, ir.StartIn) else None
    named = None if start is None else start.effector
    if task.reach is not None:
        named = named or task.reach.effector

    def question(
        target: ir.Region, effector: int | None, goal: str, by: Fraction | None = None
    ) -> PoseQuestion:
        return PoseQuestion(
            None if start is None else _rows(workspace.region(start.region), workspace),
            _rows(target, workspace),
            _rows(workspace.bounds, workspace),
            None if start is None or named is None else named - 1,
            None if effector is None else effector - 1,
            task.start if isinstance(task.start, ir.StartAt) else None,
            start is not None and named is None and effector is not None,
            missing_effector(task, 0) or 0,
            goal,
            by,
        )

    found: list[PoseQuestion] = []
    if task.reach is not None:
        target = workspace.region(task.reach.region)
        found.append(question(target, task.reach.effector, "the target", _arrival(task)))
    for place, by in task_visits(task).items():
        goal = f"{place.region}, which it has to visit"
        found.append(question(workspace.region(place.region), place.effector, goal, by))
    return tuple(found) or (question(workspace.bounds, None, "any place"),)


def _arrival(task: ir.Task) -> Fraction | None:
    """The time (s) from which a stay in the target lasts to the end; None without a stay.

    It is that of the longest motion: a shorter one is there earlier.
    """
    if task.repeat or not task.stay:
        return None
    return max(Fraction(0), task.steps * task.step - task.stay)


def _rows(region: ir.Region, workspace: ir.Workspace) -> tuple[ir.HalfSpace, ...]:
    return refuting_polytope(region.shape, workspace.dimension).rows


def start_fault(model: RobotModel, question: PoseQuestion) -> str:
    """Why a robot cannot take the given start pose, in words; empty if there is no such reason.

    A single joint that is out of its range is not reported here but by a covering, which also
    accounts for how near to the pose a motion must start.
    """
    return "" if question.start_at is None else given_start(model, question.start_at).fault


def effector_choices(model: RobotModel, question: PoseQuestion) -> list[tuple[int, int]]:
    """The pairs (starting, reaching) of effectors that the task admits, from 0.

    If only the start names its effector, any effector may reach.
    """
    count, start, reach = len(model.effectors), question.start_effector, question.reach_effector
    if count < question.effectors or start_fault(model, question):
        return []
    reaching = range(count) if reach is None else [reach]
    if question.any_start:
        pairs = [(s, e) for s in range(count) for e in reaching]
    else:
        pairs = [(e if start is None or question.start is None else start, e) for e in reaching]
    return [pair for pair in pairs if max(pair) < count]
