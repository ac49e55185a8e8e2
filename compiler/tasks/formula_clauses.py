"""Clauses for a SAT solver, and a formula about samples as clauses."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass
from typing import Final, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.sampled_formula import (
    Eventually,
    Every,
    Literal,
    SampledFormula,
    Some,
    SomewhereFrom,
    Throughout,
    ThroughoutFrom,
    Until,
)
from compiler.time_limits.time_limit import check_time

# --- A growing set of clauses, in arrays of equal length, with names for its variables ------------


Ints: TypeAlias = NDArray[np.int64]
TRUE: Final = 1
"""The variable that is true; as a literal, -1 is false."""


class Clauses:
    """A set of clauses. Variables count from 1; 0 stands for a missing variable, which is false."""

    def __init__(self) -> None:
        self.variables = TRUE
        self._arrays: list[Ints] = [np.array([[TRUE]], dtype=np.int64)]
        self._names: list[tuple[int, Callable[[int], str]]] = [(TRUE, lambda _: "always true")]

    def fresh(self, count: int, name: Callable[[int], str]) -> Ints:
        """New variables, shape (count,); ``name(i)`` is the name of the i-th of them."""
        first = self.variables + 1
        self.variables += count
        if count:
            self._names.append((first, name))
        return np.arange(first, first + count, dtype=np.int64)

    def one(self, name: str) -> int:
        """One new variable."""
        return int(self.fresh(1, lambda _: name)[0])

    def add(self, clauses: Ints) -> None:
        """Add clauses of equal length, shape (clauses, literals)."""
        check_time()
        if clauses.shape[0]:
            self._arrays.append(clauses)

    def clause(self, literals: Iterable[int]) -> None:
        """Add one clause; constants in it are resolved."""
        check_time()
        found = [literal for literal in literals if literal not in (-TRUE, 0)]
        if TRUE not in found:
            self._arrays.append(np.array([found or [-TRUE]], dtype=np.int64))

    def implications(self, heads: Ints, owners: Ints, bodies: Ints) -> None:
        """For each row of ``heads``, shape (rows, literals), add a clause of it and its bodies.

        ``bodies[k]`` is a literal of row ``owners[k]``; owners ascend.
        """
        degrees = np.bincount(owners, minlength=len(heads))
        for degree in np.unique(degrees).tolist():
            rows = np.flatnonzero(degrees == degree)
            body = bodies[degrees[owners] == degree].reshape(len(rows), degree)
            self.add(np.column_stack([heads[rows], body]))

    def taken(self) -> list[Ints]:
        """The clauses added since the last call: an array (clauses, literals) for each length."""
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


# --- A formula about samples as clauses -----------------------------------------------------------
#
# Source: Biere, Heljanko, Junttila, Latvala & Schuppan, *Linear encodings of bounded LTL model
# checking* (2006), for finite words. Formulas are in negation normal form, so a variable only has
# to imply what its node requires (Plaisted & Greenbaum 1986). Every node is encoded once per layer,
# when something asks for it there. A variable of a layer that does not exist is false.


@dataclass(frozen=True, slots=True)
class Layers:
    """Layers 0 .. ``last``; a word uses those that exist.

    ``exists(j)`` is the literal that layer j exists; with ``open_end``, words may end before
    ``last``, and what has no layer up to there is true if words go on.  A proof that there is no
    word then rests on ``-exists(last + 1)`` wherever longer words might do.
    """

    last: int
    exists: Callable[[int], int]
    open_end: bool

    def beyond(self) -> int:
        """The literal that a word has a layer after the last."""
        return self.exists(self.last + 1) if self.open_end else -TRUE


class Regions(Protocol):
    """Gives the literals of a formula their meaning."""

    def ask(self, literal: Literal, layer: int, variable: int) -> None:
        """Make the variable imply the literal at that layer."""


class FormulaClauses:
    """The clauses of a formula that holds at layer 0.

    Args:
        clauses: the clauses to which new ones are added.
        formula: the formula.
        layers: the layers of words.
        regions: gets every literal and layer that matters.
    """

    def __init__(
        self,
        clauses: Clauses,
        formula: SampledFormula,
        layers: Layers,
        regions: Regions,
    ) -> None:
        self._clauses = clauses
        self._layers = layers
        self._regions = regions
        self._known: dict[tuple[Hashable, int], int] = {}
        self._waiting: dict[int, list[tuple[SampledFormula, int]]] = {}
        self._always: list[tuple[SampledFormula, int]] = []
        self._laid_out = -1
        self._numbers: dict[int, int] = {}
        clauses.clause([self._literal(formula, 0)])

    def lay_out(self, last: int) -> None:
        """Define everything that is asked for up to layer ``last``."""
        for layer in range(self._laid_out + 1, last + 1):
            self._laid_out = layer
            for node, literal in self._always:
                self._at_last(node, literal, layer)
            self._define_waiting(layer)

    # --- variables -------------------------------------------------------------------------------

    def _literal(self, node: SampledFormula, layer: int) -> int:
        """The literal of a node at a layer; false beyond the last, unless words go on there."""
        if layer > self._layers.last:
            return self._layers.beyond()
        match node:
            case Every(parts=()):
                return self._layers.exists(layer)
            case Some(parts=()):
                return -TRUE
            case SomewhereFrom() | ThroughoutFrom():
                layer = 0
            case _:
                pass
        key = (node if isinstance(node, Literal) else id(node), layer)
        if key not in self._known:
            self._known[key] = self._made(node, layer)
        return self._known[key]

    def _made(self, node: SampledFormula, layer: int) -> int:
        variable = self._clauses.one(f"{self._text(node)} at {layer}")
        self._clauses.clause([-variable, self._layers.exists(layer)])
        if isinstance(node, Literal):
            self._regions.ask(node, layer, variable)
        elif layer <= self._laid_out:
            self._waiting.setdefault(self._laid_out, []).append((node, layer))
        else:
            self._waiting.setdefault(layer, []).append((node, layer))
        return variable

    def _text(self, node: SampledFormula) -> str:
        if isinstance(node, Literal):
            sign = "" if node.positive else "not "
            return f"{sign}{node.region} by effector {node.effector}"
        number = self._numbers.setdefault(id(node), len(self._numbers))
        return f"subformula {number} ({type(node).__name__.lower()})"

    def _define_waiting(self, layer: int) -> None:
        waiting = self._waiting.setdefault(layer, [])
        while waiting:
            node, at = waiting.pop()
            for body in self._bodies(node, at):
                self._clauses.clause([-self._literal(node, at), *body])

    # --- definitions -----------------------------------------------------------------------------

    def _bodies(self, node: SampledFormula, j: int) -> Iterator[list[int]]:
        """The clauses that a node implies at a layer."""
        match node:
            case Every(parts=parts):
                yield from ([self._literal(part, j)] for part in parts)
            case Some(parts=parts):
                yield [self._literal(part, j) for part in parts]
            case Until(left=left, right=right):
                now, later = self._literal(right, j), self._literal(node, j + 1)
                yield [now, self._literal(left, j)]
                yield [now, later]
            case Eventually(part=part, first=first, last=None):
                yield [self._literal(part, j + first), self._literal(node, j + 1)]
            case Throughout(part=part, first=first, last=None):
                yield self._if_there(part, j, first)
                if j + first < self._layers.last:
                    yield [self._literal(node, j + 1), -self._layers.exists(j + 1)]
            case Eventually(part=part, first=first, last=int() as last):
                beyond = self._layers.last + 1  # It stands for all layers that are not there.
                window = range(min(j + first, beyond), min(j + last, beyond) + 1)
                yield [self._literal(part, i) for i in window]
            case Throughout(part=part, first=first, last=int() as last):
                for i in self._window(j + first, j + last):
                    yield self._if_there(part, i, 0)
            case _:
                yield from self._absolute(node)

    def _window(self, first: int, last: int) -> Iterable[int]:
        return range(first, min(last, self._layers.last) + 1)

    def _if_there(self, part: SampledFormula, j: int, later: int) -> list[int]:
        """A clause: ``part`` holds at a later layer, if that layer exists."""
        if j + later > self._layers.last:
            return [TRUE]
        return [self._literal(part, j + later), -self._layers.exists(j + later)]

    def _absolute(self, node: SampledFormula) -> Iterator[list[int]]:
        if self._layers.open_end:
            # An untimed formula is about the last position, wherever that is.
            literal = self._literal(node, 0)
            self._always.append((node, literal))
            for layer in range(self._laid_out + 1):
                self._at_last(node, literal, layer)
            return
        match node:
            case SomewhereFrom(part=part, sample=sample):
                yield [self._literal(part, i) for i in self._window(sample, self._layers.last)]
            case ThroughoutFrom(part=part, sample=sample):
                for i in self._window(sample, self._layers.last):
                    yield [self._literal(part, i)]
            case _:
                raise TypeError(node)

    def _at_last(self, node: SampledFormula, literal: int, layer: int) -> None:
        """If a layer is the last that exists, the node's part holds at it."""
        if not isinstance(node, SomewhereFrom | ThroughoutFrom):
            raise TypeError(node)
        end = layer == self._layers.last
        following = self._layers.beyond() if end else self._layers.exists(layer + 1)
        part = self._literal(node.part, layer)
        self._clauses.clause([-literal, -self._layers.exists(layer), following, part])
