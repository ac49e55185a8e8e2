"""The seconds that pass inside the convex solvers, whoever calls them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from unittest import mock

import clarabel
import piqp

COUNTED = frozenset({"setup", "update", "solve"})


@dataclass
class Counter:
    """Seconds and calls: making a solver, giving it numbers, solving."""

    seconds: float = 0.0
    solves: int = 0

    def timed(self, call: Any, *arguments: Any, **named: Any) -> Any:
        """The result of a call, which is counted."""
        started = time.perf_counter()
        try:
            return call(*arguments, **named)
        finally:
            self.seconds += time.perf_counter() - started

    def wrapped(self, solver: type) -> Any:
        """A class of solvers whose calls are counted."""
        counter = self

        class Wrapped:
            def __init__(self, *arguments: Any) -> None:
                self.inner = counter.timed(solver, *arguments)

            def __getattr__(self, name: str) -> Any:
                found = getattr(self.inner, name)
                if name not in COUNTED:
                    return found
                counter.solves += name == "solve"
                return lambda *a, **named: counter.timed(found, *a, **named)

        return Wrapped


@contextmanager
def counted() -> Iterator[Counter]:
    """Count what Clarabel and PIQP take in the meantime."""
    counter = Counter()
    with (
        mock.patch("clarabel.DefaultSolver", counter.wrapped(clarabel.DefaultSolver)),
        mock.patch("piqp.SparseSolver", counter.wrapped(piqp.SparseSolver)),
    ):
        yield counter
