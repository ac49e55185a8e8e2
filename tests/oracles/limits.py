"""Limits of time that count how often they are asked, instead of seconds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from compiler.time_limits.time_limit import time_limit

Value = TypeVar("Value")


@dataclass(slots=True)
class Asked:
    """Reached once it was asked so often; None: never."""

    most: int | None = None
    times: int = 0

    def __call__(self) -> bool:
        self.times += 1
        return self.most is not None and self.times > self.most


def asked_by(stage: Callable[[], Value], most: int | None = None) -> tuple[int, Value]:
    """How often a stage asks for the time, and its value; the limit is reached after ``most``."""
    limit = Asked(most)
    with time_limit(limit):
        value = stage()
    return limit.times, value
