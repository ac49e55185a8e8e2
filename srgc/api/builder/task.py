"""Tasks: a method for each clause that most of them have."""

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
    """A task, as ``Task("Lift", robot=arms, workspace=bench).reach("Shelf")``.

    A quantity is a text with its unit, as "1 cm", or a number in SI units.  Each method gives a new
    task with one clause more.

    Args:
        name: that of the task.
        robot: the grammar, or its name.
        workspace: the workspace, or its name.

    Raises:
        SrgcError: one of them has no name.
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
        """Where an effector starts, at rest.

        Args:
            region: the name of the region.
            effector: the number of the effector, from 1; needed where there are several.
            rates: the largest rates of joints instead of rest (rad/s, m/s).
            held: also without accelerations.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        number = _effector(effector)
        largest = None if rates is None else expression(rates, "rates")
        if held and rates is not None:
            raise UsageFault("`held` is at rest, which `rates` are not")
        return self._with(t.StartIn(ident(region, "region"), number, largest, held=held))

    @spoken
    def start_at(self, coordinates: Vector) -> Self:
        """The coordinates with which the robot starts, at rest.

        Args:
            coordinates: of all joints (rad, m).

        Raises:
            SrgcError: they are none.
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
        """Where an effector is at the end.

        Args:
            region: the name of the region.
            effector: the number of the effector, from 1; needed where there are several.
            poses: how it is turned, as "aligned z to (0, 0, -1) within 5 deg".
            at_rest: whether the robot is at rest then.
            rates: the largest rates of joints then, instead of rest (rad/s, m/s).
            hold: for how long, up to the end, it is at rest or has such rates (s).

        Raises:
            SrgcError: an argument is not what it has to be.
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
        """What the robot keeps clear of, at every instant.

        Args:
            regions: names of regions, and "self".
            subject: its whole "body", or its "effector" alone.
            margin: how far it keeps from them (m).
            excepted: pairs of modules that may touch.

        Raises:
            SrgcError: an argument is not what it has to be.
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
        """How large efforts may be.

        Args:
            bound: the largest torque or force (N*m, N).
            unit: of a number: which of both it is; without it "N*m" is meant.
            norm: 2 for the Euclidean norm of all together; by default each on its own.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        if norm not in (None, 2):
            raise UsageFault(f"`norm` is 2 or None, not {shown(norm)}")
        largest = expression(bound, "bound", "N*m" if unit is None else unit)
        return self._with(t.Effort(largest, None if norm is None else s.Ident("2")))

    @spoken
    def horizon(self, steps: int | str, step: Quantity, *, at_most: bool = False) -> Self:
        """How long the task is.

        Args:
            steps: how many.
            step: how long each is; inputs are constant within one (s).
            at_most: any number of steps up to that.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        length = expression(step, "step", "s")
        return self._with(t.Horizon(whole(steps, "steps"), length, at_most=at_most))

    @spoken
    def gravity(self, vector: Vector) -> Self:
        """The acceleration of falling, none where it is left out.

        Args:
            vector: its coordinates (m/s^2).

        Raises:
            SrgcError: they are none.
        """
        return self._with(t.Gravity(point(vector, "vector", "m/s^2")))

    @spoken
    def modules(self, most: int | str) -> Self:
        """How many modules a robot may have.

        Args:
            most: the largest number of them.

        Raises:
            SrgcError: it is no such number.
        """
        return self._with(t.Modules("<=", whole(most, "most")))

    @spoken
    def payload(self, mass: Quantity, *, effector: int | None = None) -> Self:
        """What an effector carries all the time.

        Args:
            mass: of it (kg).
            effector: the number of the effector, from 1; needed where there are several.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        return self._with(t.Payload(expression(mass, "mass", "kg"), _effector(effector)))

    @spoken
    def satisfy(self, formula: str) -> Self:
        """What is true of the motion, in temporal logic.

        Args:
            formula: as "eventually[0 s, 3 s] (A and eventually B)".

        Raises:
            SrgcError: it is no formula.
        """
        found = read("task T { satisfy ", formula, ";}", "formula", "a formula")
        return self._with(_only(found, t.Satisfy, "formula", formula))

    @spoken
    def control(self, loop: Literal["feedback", "open loop"]) -> Self:
        """How the robot is controlled.

        Args:
            loop: "feedback" or "open loop".

        Raises:
            SrgcError: it is neither.
        """
        if loop not in ("feedback", "open loop"):
            raise UsageFault(f'`loop` is "feedback" or "open loop", not {shown(loop)}')
        return self._with(t.Control(loop))

    @spoken
    def minimize(self, *objectives: str) -> Self:
        """What is to be least, the most important first.

        Args:
            objectives: as "sum(price)" and "mass within 5 %".

        Raises:
            SrgcError: one of them is none.
        """
        found = tuple(map(_objective, objectives))
        if not found:
            raise UsageFault("`objectives` are one or more")
        return self._with(m.Minimize(found))

    @spoken
    def statement(self, text: str) -> Self:
        """Clauses as a text of the language, for what has no method.

        Args:
            text: as "robust mass 5 %; slack 1 mm;".

        Raises:
            SrgcError: they are no clauses of a task.
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
