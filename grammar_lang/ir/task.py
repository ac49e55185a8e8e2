"""Workspaces and tasks of the intermediate representation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from fractions import Fraction
from math import ceil
from typing import Literal, TypeAlias

from grammar_lang.ir.expressions import NOWHERE, Expr
from grammar_lang.ir.family import DofKind
from grammar_lang.ir.formula import And, Atom, Eventually, Formula, Pose, Window
from grammar_lang.ir.objective import Objective
from grammar_lang.ir.obstacle_maps import ObstacleMap
from grammar_lang.source import Span, node


@node
class HalfSpace:
    """``normal . p <= offset``, exact, in metres; ``span`` is where it is written."""

    normal: tuple[Fraction, ...]
    offset: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Inequalities:
    """A closed convex polyhedron as an intersection of half-spaces."""

    rows: tuple[HalfSpace, ...]


@node
class Hull:
    """The convex hull of points."""

    points: tuple[tuple[Fraction, ...], ...]


@node
class Round:
    """The points within a radius of a point or a segment; a cylinder has no round ends.

    It is approximated by a polytope: one that contains it if ``outward``, for regions that motions
    avoid; otherwise one that it contains.
    """

    kind: Literal["ball", "capsule", "cylinder"]
    points: tuple[tuple[Fraction, ...], ...]
    radius: Fraction
    outward: bool


RegionShape: TypeAlias = Inequalities | Hull | Round
RegionKind: TypeAlias = Literal["bounds", "region", "obstacle", "target"]


@node
class Region:
    """A named closed convex set of the workspace."""

    name: str
    kind: RegionKind
    shape: RegionShape
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Workspace:
    """Bounds and regions in the plane (dimension 2) or in space (3); regions as declared."""

    name: str
    dimension: Literal[2, 3]
    bounds: Region
    regions: tuple[Region, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    maps: tuple[ObstacleMap, ...] = ()

    def region(self, name: str) -> Region:
        """The region of that name; raises KeyError if there is none."""
        for region in self.regions:
            if region.name == name:
                return region
        raise KeyError(name)


@node
class StartIn:
    """Start with some effector in a region, and with all rates at most ``rates`` (0: at rest).

    ``held``: some inputs within their bounds hold the robot in equilibrium there.
    """

    region: str
    effector: int | None
    rates: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    held: bool = False


@node
class StartAt:
    """Start at rest with one given value per degree of freedom of the word, in word order.

    ``kinds`` is the kind of degree of freedom that each value requires, None if its unit leaves
    that open; empty if it is open for all.  ``places`` is where the values are written.
    """

    values: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    kinds: tuple[DofKind | None, ...] = ()
    places: tuple[Span, ...] = field(default=(), compare=False, repr=False)

    def kind(self, number: int) -> DofKind | None:
        """The kind of degree of freedom that a value (counted from 0) requires; None if any."""
        return self.kinds[number] if self.kinds else None


REST_RATE = Fraction(1, 1000)
"""For ``reach ... at rest``: all joint rates are below this, in SI units."""


@node
class FinalRates:
    """All joint rates are below ``bound``, in SI units, throughout the last ``duration`` seconds.

    ``most`` is at least the value written; it exceeds ``bound`` only if that value is irrational.
    """

    bound: Fraction = REST_RATE
    most: Fraction = REST_RATE
    duration: Fraction = Fraction(0)


@node
class Reach:
    """Some effector (or the ``effector``-th, from 1) is in the region at the final instant.

    Its frame satisfies all ``poses``.  If ``rates`` has a duration, it is there throughout those
    last seconds; if ``rates`` is None, the rates are free.
    """

    region: str
    effector: int | None
    rates: FinalRates | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    poses: tuple[Pose, ...] = ()


@node
class Avoid:
    """All effectors, or the whole body, stay out of the regions by more than ``margin`` metres."""

    regions: tuple[str, ...]
    subject: Literal["effector", "body"]
    margin: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Effort:
    """A bound on every free input of a kind; ``norm2`` bounds their Euclidean norm instead."""

    kind: DofKind
    bound: Fraction
    norm2: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class AvoidSelf:
    """Bodies of links that no joint connects stay apart by more than ``margin`` metres.

    Bodies of the two modules of a pair in ``exceptions`` may touch; the names of a pair are sorted.
    """

    margin: Fraction
    exceptions: frozenset[tuple[str, str]] = frozenset()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Fixed:
    """A parameter of the existing robot that keeps its value (closed, SI).

    ``symbol`` is the position of its module in the word.
    """

    symbol: int
    name: str
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Origin:
    """The existing robot that is to be reconfigured (Example 2)."""

    word: tuple[str, ...]
    fixed: tuple[Fixed, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Satisfy:
    """A formula that the motion has to satisfy at time 0."""

    formula: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Radii:
    """The distance allowed between two states: a radius for each kind of coordinate and rate.

    ``angle`` (rad) and ``angular_rate`` (rad/s) are for revolute degrees of freedom, ``length`` (m)
    and ``speed`` (m/s) for prismatic ones.
    """

    angle: Fraction = Fraction(0)
    length: Fraction = Fraction(0)
    angular_rate: Fraction = Fraction(0)
    speed: Fraction = Fraction(0)


@node
class Payload:
    """A point mass (kg) at an effector (from 1) throughout; None: at the only effector."""

    mass: Fraction
    effector: int | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Carry:
    """A point mass (kg) that an effector (from 1) carries between two samples; None: the only one.

    The effector picks it up in the region ``source`` and puts it down, at least one sample later,
    in ``target``.  At both samples all rates are below the bound of ``rates``; they do not change
    when the load does.
    """

    mass: Fraction
    effector: int | None
    source: str
    target: str
    rates: FinalRates = FinalRates()
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    @property
    def visits(self) -> Formula:
        """The effector is in ``source`` at some time, and in ``target`` at that time or later."""
        number, some_time = self.effector or 1, Window(Fraction(0), None)
        there = Eventually(Atom(self.target, number, span=self.span), some_time, self.span)
        taken = Atom(self.source, number, span=self.span)
        return Eventually(And((taken, there), self.span), some_time, self.span)


@node
class ModuleMass:
    """All masses, densities and inertias of an occurrence of a module are scaled by 1 +- ``part``.

    Each occurrence in a word has its own factor.
    """

    module: str
    part: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Robust:
    """Disturbances that the motion has to withstand.

    ``start`` holds the radii around the planned start, ``measured`` those of what the controller
    measures around the true state.  Each input is off by up to the fraction ``effort`` of its value
    and the fraction ``effort_of_bound`` of its bound, whatever is commanded.  All masses, densities
    and inertias are multiplied by one common factor within 1 +- ``mass``.  Those of the modules in
    ``masses`` are multiplied by one further factor per occurrence, and each payload by its own
    within 1 +- ``payload``.

    ``clauses`` are the places of the first clause of each kind (``start``, ``measure``, ``effort``,
    ``effort of bound``, ``mass``, ``mass of``, ``payload``) and of each radius (``start angle``).
    """

    start: Radii = Radii()
    measured: Radii = Radii()
    effort: Fraction = Fraction(0)
    effort_of_bound: Fraction = Fraction(0)
    mass: Fraction = Fraction(0)
    masses: tuple[ModuleMass, ...] = ()
    payload: Fraction = Fraction(0)
    clauses: Mapping[str, Span] = field(default_factory=dict[str, Span], compare=False, repr=False)


@node
class Task:
    """A problem: a robot family, a workspace, a goal, and a number of steps to reach it.

    ``reach`` is None only if ``satisfy`` has a formula.  ``clauses`` are the places of the clauses
    that are plain values here: ``horizon``, ``gravity``, ``modules``, ``bounds_body``, ``control``,
    ``repeat``, ``minimize``.

    With ``repeat`` the motion never ends: ``steps`` bounds a prefix and one loop together.  With
    ``at_most`` a motion may have fewer steps; T in formulas is then its own end.  ``control`` is
    whether the inputs are a fixed list or follow the measurements; None: either.  Each objective in
    ``minimize`` is applied to the solutions that the earlier ones leave.
    """

    name: str
    grammar: str
    workspace: str
    start: StartIn | StartAt
    reach: Reach | None
    avoid: tuple[Avoid, ...]
    effort: tuple[Effort, ...]
    steps: int
    step: Fraction
    slack: Fraction
    gravity: tuple[Fraction, ...]
    modules: int | None
    bounds_body: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    avoid_self: AvoidSelf | None = None
    origin: Origin | None = None
    satisfy: tuple[Satisfy, ...] = ()
    robust: Robust | None = None
    control: Literal["open loop", "feedback"] | None = None
    repeat: bool = False
    clauses: Mapping[str, Span] = field(default_factory=dict[str, Span], compare=False, repr=False)
    payloads: tuple[Payload, ...] = ()
    carries: tuple[Carry, ...] = ()
    minimize: tuple[Objective, ...] = ()
    at_most: bool = False

    def lasting(self, steps: int) -> Task:
        """The task with exactly this many steps."""
        return replace(self, steps=steps, at_most=False)

    @property
    def fewest_steps(self) -> int:
        """The fewest steps of a motion: it must be at least as long as ``stay``."""
        return max(1, ceil(self.stay / self.step)) if self.at_most else self.steps

    @property
    def demanded(self) -> tuple[Satisfy, ...]:
        """The ``satisfy`` clauses, followed by the least that each ``carry`` requires."""
        return (*self.satisfy, *(Satisfy(carry.visits, carry.span) for carry in self.carries))

    @property
    def goal(self) -> Reach:
        """The ``reach`` clause; raises LookupError if the task has formulas only."""
        if self.reach is None:
            raise LookupError(f"task {self.name} has no reach clause")
        return self.reach

    @property
    def final_rates(self) -> FinalRates | None:
        """The bound on the rates at the end of the motion; None if they are free."""
        return None if self.reach is None else self.reach.rates

    @property
    def stay(self) -> Fraction:
        """How long the motion has to stay in the target before its end, in seconds."""
        return Fraction(0) if self.final_rates is None else self.final_rates.duration
