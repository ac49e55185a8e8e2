"""Squares to plan through: grids with obstacles, and mazes; all with a fixed seed."""

from __future__ import annotations

import random
from collections import deque
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise


@dataclass(frozen=True)
class World:
    """Cells numbered row by row, those that are neighbours, and a question."""

    name: str
    side: int
    neighbours: tuple[tuple[int, ...], ...]
    blocked: frozenset[int]
    start: int
    target: int
    steps: int

    @cached_property
    def free(self) -> tuple[int, ...]:
        """The cells that may be entered."""
        return tuple(c for c in range(len(self.neighbours)) if c not in self.blocked)

    def checked(self, path: list[int], most: int) -> None:
        """End the benchmark unless a path answers the question with at most so many changes."""
        good = path[0] == self.start and path[-1] == self.target and len(path) <= most + 1
        good &= self.blocked.isdisjoint(path)
        if not good or any(b not in self.neighbours[a] for a, b in pairwise(path)):
            raise SystemExit(f"{self.name}: no path: {path}")


def beside(side: int) -> tuple[tuple[int, ...], ...]:
    """The neighbours of every square of a full grid, ascending."""
    return tuple(
        tuple(
            r * side + c
            for r, c in ((row - 1, col), (row, col - 1), (row, col + 1), (row + 1, col))
            if 0 <= r < side and 0 <= c < side
        )
        for row in range(side)
        for col in range(side)
    )


def from_start(
    neighbours: tuple[tuple[int, ...], ...], start: int, blocked: frozenset[int]
) -> dict[int, int]:
    """The distances of all squares that can be reached."""
    found = {start: 0}
    waiting = deque([start])
    while waiting:
        cell = waiting.popleft()
        for other in neighbours[cell]:
            if other not in found and other not in blocked:
                found[other] = found[cell] + 1
                waiting.append(other)
    return found


def grid(side: int, steps: int, obstacles: int) -> World:
    """A grid with so many blocked squares, from a corner to the farthest square within reach."""
    rng = random.Random(1)
    neighbours = beside(side)
    blocked = frozenset(rng.sample(range(1, side * side), obstacles))
    near = from_start(neighbours, 0, blocked)
    target = max((c for c in near if near[c] <= steps), key=lambda c: (near[c], c))
    return World(f"grid {side} x {side}", side, neighbours, blocked, 0, target, steps)


def maze(side: int) -> World:
    """A maze without cycles, from corner to corner; the steps are those of the only path."""
    rng = random.Random(1)
    around = beside(side)
    near: list[set[int]] = [set() for _ in around]
    seen, stack = {0}, [0]
    while stack:
        ways = [other for other in around[stack[-1]] if other not in seen]
        if not ways:
            stack.pop()
            continue
        other = rng.choice(ways)
        near[stack[-1]].add(other)
        near[other].add(stack[-1])
        seen.add(other)
        stack.append(other)
    neighbours = tuple(tuple(sorted(cells)) for cells in near)
    none: frozenset[int] = frozenset()
    target = side * side - 1
    steps = from_start(neighbours, 0, none)[target]
    return World(f"maze {side} x {side}", side, neighbours, none, 0, target, steps)
