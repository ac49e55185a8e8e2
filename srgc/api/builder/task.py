"""Tasks, with a method for each of the most common clauses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, Self

from grammar_lang import syntax as s
from grammar_lang.syntax import formulas as f
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from srgc.api.builder.arguments import (
    Quantity,
    Vector,
    expression,
    ident,
    point,
    read,
    read_all,
    shown,
    whole,
)
from srgc.api.builder.grammar import Grammar, named
from srgc.api.builder.part import Part
from srgc.api.builder.workspace import Workspace
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault


class Task(Part):
    """A task: ``Task("Lift", robot=arms, workspace=bench).reach("Shelf")``.

    A quantity is a text with its unit, such as "1 cm", or a number in SI units.  Each method
    returns a new task with one more clause.

    Args:
        name: the name of the task.
        robot: the grammar, or its name.
        workspace: the workspace, or its name.

    Raises:
        SrgcError: one of the arguments is not a name and has none.
    """

    __slots__ = ()

    @spoken
    def __init__(self, name: str, *, robot: str | Grammar, workspace: str | Workspace) -> None:
        statements = (
            t.Robot(ident(named(robot), "robot")),
            t.TaskWorkspace(ident(named(workspace), "workspace")),
        )
        super().__init__((t.Task(ident(name, "name"), statements),))

    @property
    def name(self) -> str:
        """The name of the task."""
        return self._task.name.text

    @property
    def _task(self) -> t.Task:
        (task,) = self._items
        assert isinstance(task, t.Task)  # noqa: S101 - of no other item it is made
        return task

    def _with(self, *statements: Any) -> Self:
        old = self._task
        return self._copied((t.Task(old.name, (*old.items, *statements)),))

    @spoken
    def start_in(
        self,
        region: str,
        *,
        effector: int | None = None,
        rates: Quantity | None = None,
        held: bool = False,
    ) -> Self:
        """Set the region in which an effector starts, with the robot at rest.

        Args:
            region: the name of the region.
            effector: the number of the effector, from 1; required if there are several.
            rates: the largest rates of joints (rad/s, m/s), instead of rest.
            held: whether some inputs within their bounds have to balance the start pose.

        Raises:
            SrgcError: an argument is invalid.
        """
        number = _effector(effector)
        largest = None if rates is None else expression(rates, "rates")
        if held and rates is not None:
            raise UsageFault("`held` is at rest, which `rates` are not")
        return self._with(t.StartIn(ident(region, "region"), number, largest, held=held))

    @spoken
    def start_at(self, coordinates: Vector) -> Self:
        """Set the pose in which the robot starts, at rest.

        Args:
            coordinates: the coordinates of all joints (rad, m).

        Raises:
            SrgcError: the argument is not a list of coordinates.
        """
        return self._with(t.StartAt(point(coordinates, "coordinates", None)))

    @spoken
    def reach(
        self,
        region: str,
        *,
        effector: int | None = None,
        poses: str = "",
        at_rest: bool = False,
        rates: Quantity | None = None,
        hold: Quantity | None = None,
    ) -> Self:
        """Set the region in which an effector ends.

        Args:
            region: the name of the region.
            effector: the number of the effector, from 1; required if there are several.
            poses: its orientation, such as "aligned z to (0, 0, -1) within 5 deg".
            at_rest: whether the robot has to end at rest.
            rates: the largest rates of joints at the end (rad/s, m/s), instead of rest.
            hold: how long the robot has to be at rest or within these rates before the end (s).

        Raises:
            SrgcError: an argument is invalid.
        """
        target, number = ident(region, "region"), _effector(effector)
        final = None
        if at_rest and rates is not None:
            raise UsageFault("give `at_rest` or `rates`")
        if at_rest or rates is not None:
            largest = None if rates is None else expression(rates, "rates")
            time = None if hold is None else expression(hold, "hold", "s")
            final = t.FinalRates(largest, time)
        elif hold is not None:
            raise UsageFault("`hold` goes with `at_rest` or `rates`")
        return self._with(t.Reach(target, number, _poses(poses), final))

    @spoken
    def avoid(
        self,
        *regions: str,
        subject: Literal["effector", "body"] = "body",
        margin: Quantity | None = None,
        excepted: Sequence[tuple[str, str]] = (),
    ) -> Self:
        """Add regions that the robot avoids at every instant.

        Args:
            regions: the names of regions, or "self" for collisions of the robot with itself.
            subject: the part of the robot that avoids them: its whole "body", or the "effector".
            margin: the least distance from them (m).
            excepted: pairs of modules that may touch.

        Raises:
            SrgcError: an argument is invalid.
        """
        if not regions:
            raise UsageFault("`regions` are one or more")
        if subject not in ("effector", "body"):
            raise UsageFault(f'`subject` is "body" or "effector", not {shown(subject)}')
        names = tuple(ident(region, "regions") for region in regions)
        distance = None if margin is None else expression(margin, "margin", "m")
        return self._with(t.Avoid(names, subject, distance, tuple(map(_pair, excepted))))

    @spoken
    def effort(
        self, bound: Quantity, unit: str | None = None, *, norm: Literal[2] | None = None
    ) -> Self:
        """Bound the efforts, the torques or forces of the drives.

        Args:
            bound: the largest torque or force (N*m, N).
            unit: the unit of a number, "N*m" or "N"; by default "N*m".
            norm: 2 to bound the Euclidean norm of all efforts; by default each one is bounded.

        Raises:
            SrgcError: an argument is invalid.
        """
        if norm not in (None, 2):
            raise UsageFault(f"`norm` is 2 or None, not {shown(norm)}")
        largest = expression(bound, "bound", "N*m" if unit is None else unit)
        return self._with(t.Effort(largest, None if norm is None else s.Ident("2")))

    @spoken
    def horizon(self, steps: int | str, step: Quantity, *, at_most: bool = False) -> Self:
        """Set the horizon, the duration of the motion.

        Args:
            steps: the number of steps.
            step: the duration of a step, during which inputs are constant (s).
            at_most: whether the motion may have fewer steps.

        Raises:
            SrgcError: an argument is invalid.
        """
        length = expression(step, "step", "s")
        return self._with(t.Horizon(whole(steps, "steps"), length, at_most=at_most))

    @spoken
    def gravity(self, vector: Vector) -> Self:
        """Set the gravitational acceleration; without this clause there is none.

        Args:
            vector: its components (m/s^2).

        Raises:
            SrgcError: the argument is not a vector.
        """
        return self._with(t.Gravity(point(vector, "vector", "m/s^2")))

    @spoken
    def modules(self, most: int | str) -> Self:
        """Bound the number of modules of a robot.

        Args:
            most: the largest number of modules.

        Raises:
            SrgcError: the argument is not such a number.
        """
        return self._with(t.Modules("<=", whole(most, "most")))

    @spoken
    def payload(self, mass: Quantity, *, effector: int | None = None) -> Self:
        """Set a load that an effector carries throughout the motion.

        Args:
            mass: the mass of the load (kg).
            effector: the number of the effector, from 1; required if there are several.

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(t.Payload(expression(mass, "mass", "kg"), _effector(effector)))

    @spoken
    def satisfy(self, formula: str) -> Self:
        """Add a formula of temporal logic that the motion has to satisfy.

        Args:
            formula: such as "eventually[0 s, 3 s] (A and eventually B)".

        Raises:
            SrgcError: the text is not a formula.
        """
        found = read("task T { satisfy ", formula, ";}", "formula", "a formula")
        return self._with(_only(found, t.Satisfy, "formula", formula))

    @spoken
    def control(self, loop: Literal["feedback", "open loop"]) -> Self:
        """Set how the robot is controlled.

        Args:
            loop: "feedback" or "open loop".

        Raises:
            SrgcError: the argument is neither of these.
        """
        if loop not in ("feedback", "open loop"):
            raise UsageFault(f'`loop` is "feedback" or "open loop", not {shown(loop)}')
        return self._with(t.Control(loop))

    @spoken
    def minimize(self, *objectives: str) -> Self:
        """Set the objectives to minimise, in order of priority.

        Args:
            objectives: such as "sum(price)" and "mass within 5 %".

        Raises:
            SrgcError: one of the texts is not an objective.
        """
        found = tuple(map(_objective, objectives))
        if not found:
            raise UsageFault("`objectives` are one or more")
        return self._with(m.Minimize(found))

    @spoken
    def statement(self, text: str) -> Self:
        """Add clauses given as a text of the language, for those without a method.

        Args:
            text: such as "robust mass 5 %; slack 1 mm;".

        Raises:
            SrgcError: the text does not consist of clauses of a task.
        """
        return self._with(*read_all("task T {", text, "}", "text", "clauses of a task"))


def _only(found: Any, kind: type[Any], name: str, given: object) -> Any:
    if not isinstance(found, kind):
        raise UsageFault(f"`{name}` is one {name}, not {shown(given)}")
    return found


def _effector(number: int | None) -> s.Expr | None:
    return None if number is None else whole(number, "effector")


def _poses(text: object) -> tuple[f.Pose, ...]:
    found = read("task T { reach R ", text, ";}", "poses", "poses of an effector")
    reach = _only(found, t.Reach, "poses", text)
    if reach.effector is not None or reach.rates is not None:
        raise UsageFault(f"`poses` are poses of an effector alone, not {shown(text)}")
    poses: tuple[f.Pose, ...] = reach.poses
    return poses


def _pair(pair: object) -> tuple[s.Ident, s.Ident]:
    if isinstance(pair, str) or not isinstance(pair, Sequence) or len(pair) != 2:
        raise UsageFault(f'`excepted` are pairs, as [("Hand", "Tube")], not {shown(pair)}')
    one, other = pair
    return ident(named(one), "excepted"), ident(named(other), "excepted")


def _objective(text: object) -> m.Objective:
    what = 'an objective, as "sum(price)"'
    found = read("task T { minimize ", text, ";}", "objectives", what)
    if not isinstance(found, m.Minimize) or len(found.objectives) != 1:
        raise UsageFault(f"`objectives`: each is {what}, not {shown(text)}")
    return found.objectives[0]
