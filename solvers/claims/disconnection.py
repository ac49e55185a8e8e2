"""Places that no effector can go between: a proof by cells that a task is impossible.

A point that moves continuously within the bounds, and never enters certain closed regions, is at
every instant in a cell that is inside none of them.  The instants at which it is in a given closed
cell are a closed set, so that it gets from one set of cells to the others only through a point that
is in both: from cell to touching cell, where a common corner is contact, too.  Nothing is assumed
of robots, of their number of modules or of the horizon.  The finder and the checker of the evidence
are both here; neither asks a solver.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import Polytope, polytope_of
from compiler.semantics.effector_counts import several_effectors
from compiler.specifications.necessary import task_avoidance, task_visits
from grammar_lang import ir
from solvers.claims.certificate import SeparationClaim

TRIALS = 100
"""So often at most it is tried to do without some of the avoided regions."""
NAMED = 5
"""So many regions are named in a reason."""


@dataclass(frozen=True, slots=True)
class Stop:
    """A region in which an effector has to be at some instant.

    ``effector`` is its number, from 1, or None for the recorded one where the task names none.
    """

    region: str
    effector: int | None
    role: str


def stops(program: ir.Program, task: ir.Task) -> tuple[Stop, ...]:
    """Where effectors have to be whatever the robot: start, target, visits of the formulas."""
    found = [*_ends(task)]
    found += [Stop(p.region, p.effector, "region") for p in task_visits(task)]
    if any(stop.effector is None for stop in found) and _single(program, task):
        found = [Stop(stop.region, stop.effector or 1, stop.role) for stop in found]
    return tuple(found)


def _single(program: ir.Program, task: ir.Task) -> bool:
    """Whether every robot of the family is known to have one effector at most."""
    return several_effectors(program, program.grammars[task.grammar]) is False


def _ends(task: ir.Task) -> Iterator[Stop]:
    """Start and target; where the start has no effector of its own, the one that reaches starts."""
    reaching = None if task.reach is None else task.reach.effector
    if isinstance(task.start, ir.StartIn):
        yield Stop(task.start.region, task.start.effector or reaching, "start")
    if task.reach is not None:
        yield Stop(task.reach.region, reaching, "target")


def disconnected(
    program: ir.Program, task: ir.Task, abstraction: Abstraction
) -> SeparationClaim | None:
    """Two places that no effector can go between, as evidence; None: none were found.

    Args:
        program: the program.
        task: the task.
        abstraction: the cells of its workspace as ``abstract`` gives them, without cuts.
    """
    cells = _Cells(abstraction, program.workspaces[task.workspace])
    for one, other in combinations(stops(program, task), 2):
        if one.effector != other.effector or one.region == other.region:
            continue
        avoided = task_avoidance(task, one.effector)
        if avoided and cells.cut_off(one.region, other.region, avoided):
            return _claimed(cells, one, other, avoided)
    return None


def _claimed(
    cells: _Cells, one: Stop, other: Stop, avoided: Sequence[str]
) -> SeparationClaim | None:
    """The evidence, with no avoided region that could be spared where few are needed."""
    needed = list(_needed(cells, one.region, other.region, avoided))
    free = cells.free(needed)
    reached = _connected(cells.meeting(one.region) & free, cells.touching, free)
    names = tuple(cells.abstraction.cells[i].name for i in sorted(reached))
    return SeparationClaim(one.effector, one.region, other.region, tuple(needed), names)


def _needed(cells: _Cells, source: str, target: str, avoided: Sequence[str]) -> Sequence[str]:
    """Regions that suffice to cut off two others, found by leaving out ever smaller parts.

    None of them can be spared unless ``TRIALS`` run out.  Compare Zeller & Hildebrandt,
    *Simplifying and isolating failure-inducing input* (2002).
    """
    needed, trials = list(avoided), TRIALS
    size = len(needed)
    while size > 1 and trials > 0:
        size, first = (size + 1) // 2, 0
        while first < len(needed) and trials > 0:
            fewer = needed[:first] + needed[first + size :]
            trials -= 1
            if cells.cut_off(source, target, fewer):
                needed = fewer
            else:
                first += size
    return needed


@dataclass(frozen=True)
class _Cells:
    """The cells of a workspace, and which of them meet what."""

    abstraction: Abstraction
    workspace: ir.Workspace
    _meeting: dict[str, frozenset[int]] = field(default_factory=dict[str, frozenset[int]])

    def free(self, avoided: Collection[str]) -> frozenset[int]:
        """The cells that are inside no avoided region."""
        inside = self.abstraction.within(avoided)
        return frozenset(range(len(self.abstraction.cells))) - frozenset(inside)

    def meeting(self, region: str) -> frozenset[int]:
        """The closed cells that have a point in common with a region."""
        if region not in self._meeting:
            bounds, shape = (
                polytope_of(r.shape, self.workspace.dimension)
                for r in (self.workspace.bounds, self.workspace.region(region))
            )
            part = bounds.intersection(shape)
            self._meeting[region] = frozenset(
                i
                for i, cell in enumerate(self.abstraction.cells)
                if not part.is_empty and _near(part, cell.polytope) and cell.polytope.meets(part)
            )
        return self._meeting[region]

    @cached_property
    def touching(self) -> list[list[int]]:
        """Per cell those that it has a point in common with."""
        found: list[list[int]] = [[] for _ in self.abstraction.cells]
        for i, j in self.abstraction.touches:
            found[i].append(j)
            found[j].append(i)
        return found

    def cut_off(self, source: str, target: str, avoided: Collection[str]) -> bool:
        """Whether no chain of touching cells leads from region to region."""
        free = self.free(avoided)
        first, last = self.meeting(source) & free, self.meeting(target) & free
        if _connected(first, self.abstraction.neighbours, free) & last:
            return False  # without asking which cells touch at corners
        return not _connected(first, self.touching, free) & last


def _near(one: Polytope, other: Polytope) -> bool:
    """Whether the boxes about two bounded polytopes meet; they do if the polytopes do."""
    (low, high), (lower, upper) = one.box, other.box
    return bool((low <= upper).all() and (lower <= high).all())


def _connected(
    cells: Collection[int], beside: Sequence[Collection[int]], free: Collection[int]
) -> frozenset[int]:
    """The free cells that chains of free cells lead to."""
    reached, pending = set(cells), list(cells)
    while pending:
        for cell in beside[pending.pop()]:
            if cell in free and cell not in reached:
                reached.add(cell)
                pending.append(cell)
    return frozenset(reached)


def separation_text(program: ir.Program, task: ir.Task, claim: SeparationClaim) -> str:
    """The reason of the verdict, in words."""
    roles = {stop.region: stop.role for stop in reversed(stops(program, task))}
    ends = [f"{roles.get(name, 'region')} `{name}`" for name in (claim.source, claim.target)]
    walls = ", ".join(f"`{name}`" for name in claim.avoided[:NAMED])
    rest = len(claim.avoided) - NAMED
    walls += f" and {rest} more" if rest > 0 else ""
    through = f"every way between them leads through {walls}, never entered"
    return (
        f"{ends[0]} and {ends[1]} are cut off from each other: "
        f"{through if walls else 'nothing within the bounds leads from one to the other'}; "
        "this holds for every robot, whatever its size"
    )


def misstated_separation(
    program: ir.Program, task: ir.Task, abstraction: Abstraction, claim: SeparationClaim
) -> str | None:
    """Why a claim that two places are cut off is refused, or None: then it is proved.

    Args:
        program: the program.
        task: the task.
        abstraction: the cells of its workspace, without cuts.
        claim: the claim; its cells have to be closed under touching, beside avoided ones.
    """
    found = [stop.region for stop in stops(program, task) if stop.effector == claim.effector]
    if {claim.source, claim.target} - set(found):
        return "the task does not bring one effector into both regions of the separation"
    avoided = task_avoidance(task, claim.effector)
    if set(claim.avoided) - set(avoided):
        return "the separation names a region that the task does not avoid"
    known = {cell.name: i for i, cell in enumerate(abstraction.cells)}
    if set(claim.cells) - set(known):
        return "the separation names an unknown cell"
    space = _Cells(abstraction, program.workspaces[task.workspace])
    free, cells = space.free(claim.avoided), frozenset(known[name] for name in claim.cells)
    if not cells <= free:
        return "the separation has an avoided cell"
    if not space.meeting(claim.source) & free <= cells:
        return f"a cell that meets `{claim.source}` is missing from the separation"
    if cells & space.meeting(claim.target):
        return f"a cell of the separation meets `{claim.target}`"
    if any(
        (i in cells) != (j in cells) and i in free and j in free for i, j in abstraction.touches
    ):
        return "a cell that touches one of the separation is missing from it"
    return None
