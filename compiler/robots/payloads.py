"""A robot with the loads of a task: point masses at its effectors, always or at certain times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from compiler.expressions.scalars import Constant, ScalarTable
from compiler.robots.frame_table import SemanticsError
from compiler.robots.robot import PointBody, RobotModel
from grammar_lang import ir


def with_payloads(
    model: RobotModel, payloads: Sequence[ir.Payload], carries: Sequence[ir.Carry] = ()
) -> RobotModel:
    """The robot with the masses that it carries, which collide with nothing.

    Raises:
        SemanticsError: it lacks an effector that carries, or has several and none is named.
    """
    if not payloads and not carries:
        return model
    scalars = ScalarTable()
    for node in model.scalars:
        scalars.add(node)
    carried: list[tuple[ir.Payload | ir.Carry, int | None]] = [(each, None) for each in payloads]
    carried += [(each, load) for load, each in enumerate(carries)]
    bodies = tuple(
        PointBody(model.effectors[_effector(model, each)], scalars.add(Constant(each.mass)), load)
        for each, load in carried
    )
    first = len(model.bodies)
    numbers = tuple(range(first, first + len(bodies)))
    return replace(
        model,
        scalars=tuple(scalars.nodes),
        bodies=(*model.bodies, *bodies),
        owners=(*model.owners, *(None for _ in bodies)) if model.owners else (),
        covered=(*model.covered, *numbers),
        payloads=numbers,
    )


def _effector(model: RobotModel, carried: ir.Payload | ir.Carry) -> int:
    """The index of the effector that carries a payload or load, from 0."""
    number, count = carried.effector or 1, len(model.effectors)
    what = "payload" if isinstance(carried, ir.Payload) else "load"
    if number > count:
        raise SemanticsError(f"there is no effector {number} to carry the {what}")
    if carried.effector is None and count > 1:
        raise SemanticsError(f"it is not said which effector carries the {what}")
    return number - 1


def loads_of(model: RobotModel) -> tuple[int, ...]:
    """The bodies that are picked up and put down, in the order of their loads' inputs."""
    return tuple(
        number
        for number, body in enumerate(model.bodies)
        if isinstance(body, PointBody) and body.load is not None
    )
