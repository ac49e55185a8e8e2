"""Measure the planner against what a user would write instead, from the graph of cells to a path.

Every time includes building the problem.  Ours gives the path with the fewest changes of cell; the
others any path within the steps, or, Drake's graph of convex sets, a short one.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from statistics import median
from typing import Any

from timing import ROOT, machine, seconds

sys.path.insert(0, str(ROOT))  # the meaning of formulas is among the tests' oracles

from planning_peers import TooSlow, drake_graph, pysat_clauses, within, z3_one_hot
from planning_worlds import World, from_start, grid, maze

LEAST = 50.0
"""So many times faster than z3 we are to be on paths; of the formula nothing is required."""
LIMIT = 60.0
LARGE = 2.0
"""Seconds for 10,000 cells and 160 steps."""


@dataclass(frozen=True)
class Peer:
    """Another way to a path, within so many seconds."""

    name: str
    solve: Callable[[World, float], list[int]]


def ours(world: World, formula: Any = None) -> tuple[list[int], tuple[int, ...] | None]:
    """The cells in order, and when they are entered."""
    from compiler.tasks.specification import PlannedEffector, PlanningProblem
    from solvers.planner import Planner
    from solvers.verdict import Holds

    none: frozenset[str] = frozenset()
    marked = {} if formula is None else marks(world)
    problem = PlanningProblem(
        world.neighbours,
        tuple(marked.get(cell, none) for cell in range(len(world.neighbours))),
        (
            PlannedEffector(
                0, (world.start,), tuple(world.blocked), None if formula else (world.target,)
            ),
        ),
        formula,
        formula is not None,
        world.steps,
        world.steps,
    )
    verdict = Planner(problem).next_plan()
    if not isinstance(verdict, Holds):
        raise SystemExit(f"{world.name}: our planner has no path")
    (path,) = verdict.witness.paths
    return list(path.cells), path.entries


def compared(
    what: str,
    us: Callable[[], object],
    others: Sequence[tuple[str, Callable[[], object]]],
    rounds: int,
    limit: float,
) -> dict[str, float]:
    """Print the medians, measured in turn; per other the median ratio of its time to ours."""
    us()
    mine: list[float] = []
    theirs: dict[str, list[float]] = {name: [] for name, _ in others}
    slow: set[str] = set()
    for _ in range(rounds):
        mine.append(seconds(us))
        for name, call in others:
            if name in slow:
                continue
            try:
                with within(limit):
                    theirs[name].append(seconds(call))
            except TooSlow:
                slow.add(name)
    print(f"{what:<44}{median(mine):>11.4f}", flush=True)
    found: dict[str, float] = {}
    for name, times in theirs.items():
        if name in slow:
            found[name] = limit / median(mine)
            print(f"  {name:<42}{f'> {limit:.0f}':>11}  more than {found[name]:.0f} times ours")
        else:
            found[name] = median(t / m for t, m in zip(times, mine, strict=True))
            print(f"  {name:<42}{median(times):>11.4f}  {found[name]:.1f} times ours", flush=True)
    return found


def path_line(world: World, peers: Sequence[Peer], rounds: int, limit: float) -> dict[str, float]:
    """A path through a world, every answer checked."""
    near = from_start(world.neighbours, world.start, world.blocked)
    fewest = near[world.target]

    def us() -> None:
        path, _ = ours(world)
        world.checked(path, fewest)

    def them(peer: Peer) -> Callable[[], None]:
        def call() -> None:
            path = peer.solve(world, limit)
            once = [c for i, c in enumerate(path) if i == 0 or c != path[i - 1]]
            world.checked(once, world.steps)

        return call

    what = f"{world.name}, {len(world.free)} cells, {world.steps} steps"
    return compared(what, us, [(peer.name, them(peer)) for peer in peers], rounds, limit)


def large_line(rounds: int) -> float:
    """A grid that is too large for the others; the median time."""
    world = grid(100, 160, 600)
    fewest = from_start(world.neighbours, world.start, world.blocked)[world.target]
    times = [seconds(lambda: world.checked(ours(world)[0], fewest)) for _ in range(rounds)]
    what = f"{world.name}, {len(world.free)} cells, {world.steps} steps"
    print(f"{what:<44}{median(times):>11.4f}", flush=True)
    return median(times)


# --- a formula with times -----------------------------------------------------------------------


def marks(world: World) -> dict[int, frozenset[str]]:
    """Regions A, B and C: squares in three places."""
    side = world.side
    found = {}
    corners = {
        "A": (side // 4, side // 2),
        "B": (side // 2, side // 4),
        "C": (side // 3, side // 3),
    }
    for name, (top, left) in corners.items():
        for row in range(top, top + 3):
            for column in range(left, left + 3):
                found[row * side + column] = frozenset(name)
    return found


def formula_line(rounds: int, limit: float) -> dict[str, float]:
    """In A within 50 steps and then in B, never in C, and in B for the last eight steps."""
    from compiler.tasks.sampled_formula import sampled
    from grammar_lang import ir
    from tests.oracles.word_semantics import true_at

    world = grid(30, 80, 90)
    inside = marks(world)
    a, b, c = (ir.Atom(name, 1) for name in "ABC")
    ever, soon = (ir.Window(Fraction(0), last) for last in (None, Fraction(50)))
    formula = ir.And(
        (
            ir.Eventually(ir.And((a, ir.Eventually(b, ever))), soon),
            ir.Always(ir.Not(c), ever),
            ir.Last(Fraction(8), b),
        )
    )
    asked = sampled(formula, Fraction(1), world.steps)

    def check(word: Sequence[int]) -> None:
        labels = [{1: inside.get(cell, frozenset())} for cell in word]
        if len(word) != world.steps + 1 or not true_at(asked, labels, 0):
            raise SystemExit("the word does not satisfy the formula")

    def us() -> None:
        cells, entries = ours(world, asked)
        ends = [*(entries or ())[1:], world.steps + 1]
        check([x for x, i, j in zip(cells, entries or (), ends, strict=True) for _ in range(i, j)])

    def by_hand(solver: Any, at: list[dict[int, Any]]) -> None:
        import z3

        def there(name: str, step: int) -> Any:
            return z3.Or([at[step][x] for x in at[step] if name in inside.get(x, ())])

        then_b = [z3.Bool(f"then B {i}") for i in range(len(at))]
        for i in range(len(at)):
            solver.add(then_b[i] == z3.Or(there("B", i), *then_b[i + 1 : i + 2]))
            solver.add(z3.Not(there("C", i)))
        solver.add(z3.Or([z3.And(there("A", i), then_b[i]) for i in range(51)]))
        solver.add(*(there("B", i) for i in range(len(at) - 9, len(at))))

    what = f"timed formula, {world.name}, {world.steps} steps"
    others = [("z3, one-hot, formula by hand", lambda: check(z3_one_hot(world, limit, by_hand)))]
    return compared(what, us, others, rounds, limit)


def _drake() -> Peer | None:
    try:
        import pydrake.geometry.optimization  # noqa: F401
    except ImportError:
        return None
    logging.getLogger("drake").setLevel(logging.WARNING)
    return Peer("Drake's graph of convex sets, Clarabel", drake_graph)


def main() -> None:
    """Measure and print tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=LIMIT, help="the limit of one answer")
    parser.add_argument("--small", action="store_true", help="a grid and a maze of 10 x 10 only")
    options = parser.parse_args()
    if options.rounds < 1 or options.seconds <= 0:
        parser.error("at least one round, and some time")
    rounds, limit = options.rounds, options.seconds
    one_hot = Peer("z3, one Boolean per (cell, step)", z3_one_hot)
    by_hand = Peer("python-sat, clauses made in Python", pysat_clauses)
    drake = _drake()
    print(machine())
    print("a path, building included; median wall time and median ratio")
    print(f"{'':<44}{'wall s':>11}", flush=True)
    sides = (10,) if options.small else (20, 50)
    grids = [grid(10, 18, 10)] if options.small else [grid(50, 81, 140)]
    least, drakes = float("inf"), []
    for world in grids:
        found = path_line(world, [one_hot, by_hand], rounds, limit)
        least = min(least, found[one_hot.name])
    for world in map(maze, sides):
        peers = [one_hot, by_hand, *([] if drake is None else [drake])]
        found = path_line(world, peers, rounds, limit)
        least = min(least, found[one_hot.name])
        if drake is not None:
            drakes.append(found[drake.name])
    if drake is None:
        print("Drake is not installed: make .venv/compared")
    if options.small:
        return
    formula_line(rounds, limit)
    taken = large_line(rounds)
    print(f"required: {LEAST:.0f} times as fast as z3; {_word(least >= LEAST)}, {least:.0f} times")
    if drakes:
        word = _word(min(drakes) > 1)
        print(f"required: faster than Drake on both mazes; {word}, {min(drakes):.1f} times")
    print(f"required: the large grid within {LARGE:.0f} s; {_word(taken < LARGE)}, {taken:.2f} s")


def _word(reached: bool) -> str:  # noqa: FBT001
    return "reached" if reached else "MISSED"


if __name__ == "__main__":
    main()
