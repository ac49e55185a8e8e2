"""Outcomes of control syntheses as values of JSON, with every bit of their numbers."""

from __future__ import annotations

from base64 import b64decode, b64encode
from dataclasses import fields

import numpy as np

from compiler.arrays import Array
from solvers.motions.control_problem import ControlOutcome
from solvers.motions.trajectory import Trajectory
from solvers.progress import Recorded

ARRAY = "float64"
TRAJECTORY = "trajectory"


def record_of(outcome: ControlOutcome) -> dict[str, Recorded]:
    """An outcome as a value of JSON."""
    return {field.name: _recorded(getattr(outcome, field.name)) for field in fields(outcome)}


def outcome_of(record: Recorded) -> ControlOutcome | None:
    """The outcome of a record, or None where it is not one of this version."""
    try:
        if not isinstance(record, dict):
            return None
        outcome = ControlOutcome(**{name: _value(value) for name, value in record.items()})  # type: ignore[arg-type]
    except (TypeError, ValueError, KeyError):
        return None
    found: object = outcome.trajectory  # by its type only where the record is a true one
    if not isinstance(found, Trajectory):
        return None
    return outcome


def _recorded(value: object) -> Recorded:
    if isinstance(value, Trajectory):
        arrays = (value.x, value.u, value.theta)
        return {TRAJECTORY: [_recorded(array) for array in arrays]}
    if isinstance(value, np.ndarray):
        return {ARRAY: b64encode(value.astype("<f8").tobytes()).decode(), "shape": [*value.shape]}
    if isinstance(value, np.generic):
        return _recorded(value.item())
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"{type(value).__name__} cannot be recorded")


def _value(value: Recorded) -> object:
    if isinstance(value, list):
        raise TypeError("an outcome has no lists")
    if not isinstance(value, dict):
        return value
    if TRAJECTORY in value:
        parts = value[TRAJECTORY]
        if not isinstance(parts, list):
            raise TypeError("a trajectory has three arrays")
        return Trajectory(*(_array(part) for part in parts))
    return _array(value)


def _array(value: Recorded) -> Array:
    match value:
        case {"float64": str(text), "shape": list(shape)}:
            numbers = np.frombuffer(b64decode(text, validate=True), dtype="<f8")
            return numbers.reshape([int(str(size)) for size in shape]).astype(np.float64)
        case _:
            raise TypeError("an array has numbers and a shape")
