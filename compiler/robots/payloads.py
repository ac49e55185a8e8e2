"""A robot with the payloads of a task: point masses at its effectors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from compiler.expressions.scalars import Constant, ScalarTable
from compiler.robots.frame_table import SemanticsError
from compiler.robots.robot import PointBody, RobotModel
from grammar_lang import ir


def with_payloads(model: RobotModel, payloads: Sequence[ir.Payload]) -> RobotModel:
    """The robot with its payloads, which collide with nothing.

    Raises:
        SemanticsError: it lacks the effector of a payload, or has several where none is named.
    """
    if not payloads:
        return model
    scalars = ScalarTable()
    for node in model.scalars:
        scalars.add(node)
    bodies = tuple(
        PointBody(model.effectors[_effector(model, payload)], scalars.add(Constant(payload.mass)))
        for payload in payloads
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


def _effector(model: RobotModel, payload: ir.Payload) -> int:
    """The effector that carries a payload, from 0."""
    number, count = payload.effector or 1, len(model.effectors)
    if number > count:
        raise SemanticsError(f"there is no effector {number} to carry the payload")
    if payload.effector is None and count > 1:
        raise SemanticsError("it is not said which effector carries the payload")
    return number - 1
