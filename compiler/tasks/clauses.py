"""A growing set of clauses, in arrays of equal length, with names for its variables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.time_limits.time_limit import check_time

Ints: TypeAlias = NDArray[np.int64]
TRUE: Final = 1
"""The variable that is true; as a literal, -1 is false."""


class Clauses:
    """Variables count from 1; 0 stands for one that does not exist, which is false."""

    def __init__(self) -> None:
        self.variables = TRUE
        self._arrays: list[Ints] = [np.array([[TRUE]], dtype=np.int64)]
        self._names: list[tuple[int, Callable[[int], str]]] = [(TRUE, lambda _: "always true")]

    def fresh(self, count: int, name: Callable[[int], str]) -> Ints:
        """New variables, shape (count,); ``name(i)`` says what the i-th of them is."""
        first = self.variables + 1
        self.variables += count
        if count:
            self._names.append((first, name))
        return np.arange(first, first + count, dtype=np.int64)

    def one(self, name: str) -> int:
        """One new variable."""
        return int(self.fresh(1, lambda _: name)[0])

    def add(self, clauses: Ints) -> None:
        """Clauses of equal length, shape (clauses, literals)."""
        check_time()
        if clauses.shape[0]:
            self._arrays.append(clauses)

    def clause(self, literals: Iterable[int]) -> None:
        """One clause; constants in it are resolved."""
        check_time()
        found = [literal for literal in literals if literal not in (-TRUE, 0)]
        if TRUE not in found:
            self._arrays.append(np.array([found or [-TRUE]], dtype=np.int64))

    def implications(self, heads: Ints, owners: Ints, bodies: Ints) -> None:
        """Per row of ``heads``, shape (rows, literals), a clause of it and its bodies.

        ``bodies[k]`` is a literal of row ``owners[k]``; owners ascend.
        """
        degrees = np.bincount(owners, minlength=len(heads))
        for degree in np.unique(degrees).tolist():
            rows = np.flatnonzero(degrees == degree)
            body = bodies[degrees[owners] == degree].reshape(len(rows), degree)
            self.add(np.column_stack([heads[rows], body]))

    def taken(self) -> list[Ints]:
        """The clauses added since the last call, in one array for each length."""
        arrays, self._arrays = self._arrays, []
        by_length: dict[int, list[Ints]] = {}
        for array in arrays:
            by_length.setdefault(array.shape[1], []).append(array)
        return [np.concatenate(some) for some in by_length.values()]

    def names(self) -> Iterator[tuple[int, str]]:
        """Every variable with its name."""
        firsts = [first for first, _ in self._names[1:]]
        for (first, name), end in zip(self._names, [*firsts, self.variables + 1], strict=True):
            for variable in range(first, end):
                yield variable, name(variable - first)
