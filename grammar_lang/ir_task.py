"""Workspaces and tasks of the intermediate representation."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.ir_expressions import NOWHERE, Expr
from grammar_lang.ir_family import DofKind
from grammar_lang.source import Span


@dataclass(frozen=True, slots=True)
class HalfSpace:
    """``normal . p <= offset``, exact, in metres; ``span`` is where it is written."""

    normal: tuple[Fraction, ...]
    offset: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Inequalities:
    """A closed convex polyhedron as an intersection of half-spaces."""

    rows: tuple[HalfSpace, ...]


@dataclass(frozen=True, slots=True)
class Hull:
    """The convex hull of points."""

    points: tuple[tuple[Fraction, ...], ...]


RegionKind: TypeAlias = Literal["bounds", "region", "obstacle", "target"]


@dataclass(frozen=True, slots=True)
class Region:
    """A named closed convex set of the workspace."""

    name: str
    kind: RegionKind
    shape: Inequalities | Hull
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Workspace:
    """Bounds and regions in the plane (dimension 2) or in space (3), regions as declared."""

    name: str
    dimension: Literal[2, 3]
    bounds: Region
    regions: tuple[Region, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def region(self, name: str) -> Region:
        """The region of that name; KeyError if there is none."""
        for region in self.regions:
            if region.name == name:
                return region
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class StartIn:
    """Start with some effector in a region; all rates at most ``rates`` (0: at rest)."""

    region: str
    effector: int | None
    rates: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StartAt:
    """Start at rest with one given value per degree of freedom, in word order."""

    values: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Reach:
    """Some effector (or the ``effector``-th, from 1) is in the region at the final instant."""

    region: str
    effector: int | None
    at_rest: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Avoid:
    """All effectors, or the whole body, stay out of the regions by more than ``margin`` metres."""

    regions: tuple[str, ...]
    subject: Literal["effector", "body"]
    margin: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Effort:
    """A bound on every free input of a kind; ``norm2`` bounds their Euclidean norm instead."""

    kind: DofKind
    bound: Fraction
    norm2: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Task:
    """A problem: a robot family, a workspace, and what is to be done in how many steps."""

    name: str
    grammar: str
    workspace: str
    start: StartIn | StartAt
    reach: Reach
    avoid: tuple[Avoid, ...]
    effort: tuple[Effort, ...]
    steps: int
    step: Fraction
    slack: Fraction
    gravity: tuple[Fraction, ...]
    modules: int | None
    bounds_body: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)
