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
    """What is nearer than a radius to a point or a segment; of a cylinder without round ends.

    It stands for a polytope: where it is ``outward``, one that holds all of it, as motions keep out
    of it; else one inside it.
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
    """Bounds and regions in the plane (dimension 2) or in space (3), regions as declared."""

    name: str
    dimension: Literal[2, 3]
    bounds: Region
    regions: tuple[Region, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    maps: tuple[ObstacleMap, ...] = ()

    def region(self, name: str) -> Region:
        """The region of that name; KeyError if there is none."""
        for region in self.regions:
            if region.name == name:
                return region
        raise KeyError(name)


@node
class StartIn:
    """Start with some effector in a region; all rates at most ``rates`` (0: at rest).

    ``held``: some inputs within their bounds balance the robot there.
    """

    region: str
    effector: int | None
    rates: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    held: bool = False


@node
class StartAt:
    """Start at rest with one given value per degree of freedom of the word, in word order.

    ``kinds`` says for each value of which kind its degree of freedom has to be, None where its unit
    leaves that open; empty: it is open for all.  ``places`` is where the values are written.
    """

    values: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    kinds: tuple[DofKind | None, ...] = ()
    places: tuple[Span, ...] = field(default=(), compare=False, repr=False)

    def kind(self, number: int) -> DofKind | None:
        """Of which kind the degree of freedom of a value, from 0, has to be; None: of any."""
        return self.kinds[number] if self.kinds else None


REST_RATE = Fraction(1, 1000)
"""``reach ... at rest``: all rates of the joints are below this, in SI units."""


@node
class FinalRates:
    """Rates of joints are below ``bound``, in SI, throughout the last ``duration`` seconds.

    ``most`` is at least what is written, and above ``bound`` only where that is irrational.
    """

    bound: Fraction = REST_RATE
    most: Fraction = REST_RATE
    duration: Fraction = Fraction(0)


@node
class Reach:
    """Some effector (or the ``effector``-th, from 1) is in the region at the final instant.

    Its frame is turned as all ``poses`` say.  It is there throughout the last seconds where
    ``rates`` have a duration; None: they are free.
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

    Those of two modules of a pair in ``exceptions``, each in the order of names, may touch.
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
    """How far a state may be from another: a radius for each kind of coordinate and rate.

    ``angle`` (rad) and ``angular_rate`` (rad/s) of revolute degrees of freedom, ``length`` (m) and
    ``speed`` (m/s) of prismatic ones.
    """

    angle: Fraction = Fraction(0)
    length: Fraction = Fraction(0)
    angular_rate: Fraction = Fraction(0)
    speed: Fraction = Fraction(0)


@node
class Payload:
    """A point mass (kg) at an effector (from 1), all the time; None: at the only one."""

    mass: Fraction
    effector: int | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Carry:
    """A point mass (kg) at an effector (from 1), between two samples; None: at the only one.

    It is taken up where the effector is in the region ``source``, and put down, one sample later or
    more, where it is in ``target``.  At both samples all rates are below the bound of ``rates``;
    they go on as they are there.
    """

    mass: Fraction
    effector: int | None
    source: str
    target: str
    rates: FinalRates = FinalRates()
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    @property
    def visits(self) -> Formula:
        """The effector is in the one region at some time, and in the other then or later."""
        number, some_time = self.effector or 1, Window(Fraction(0), None)
        there = Eventually(Atom(self.target, number, span=self.span), some_time, self.span)
        taken = Atom(self.source, number, span=self.span)
        return Eventually(And((taken, there), self.span), some_time, self.span)


@node
class ModuleMass:
    """All masses, densities and inertias of an occurrence of a module, times 1 +- ``part``.

    Each occurrence in a word has a constant of its own.
    """

    module: str
    part: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Robust:
    """Disturbances that the motion has to bear.

    ``start`` holds the radii about the planned start, ``measured`` those of what the controller
    measures about the true state.  Each input is off by up to the fraction ``effort`` of itself and
    the fraction ``effort_of_bound`` of its bound, whatever is commanded.  All masses, densities and
    inertias are multiplied by one constant within 1 +- ``mass``, those of the modules in ``masses``
    by one more for each of their occurrences, and payloads by one each within 1 +- ``payload``.

    ``clauses`` are the places of the first clause of each kind: ``start``, ``measure``, ``effort``,
    ``effort of bound``, ``mass``, ``mass of``, ``payload``; and of each radius, as ``start angle``.
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
    """A problem: a robot family, a workspace, and what is to be done in how many steps.

    ``reach`` is None only where ``satisfy`` holds a formula.  ``clauses`` are the places of those
    clauses that are plain values here: ``horizon``, ``gravity``, ``modules``, ``bounds_body``,
    ``control``, ``repeat``, ``minimize``.

    With ``repeat`` the motion goes on for ever: ``steps`` bounds a prefix and one loop together.
    With ``at_most`` a motion of fewer steps does the task, too; T in formulas is then its own end.
    ``control`` says whether the inputs are a fixed list or follow what is measured; None: either.
    Of the objectives in ``minimize``, each counts among what is left by those before it.
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
        """The task of motions of just so many steps."""
        return replace(self, steps=steps, at_most=False)

    @property
    def fewest_steps(self) -> int:
        """The fewest steps of a motion: it takes as long as its end is to last."""
        return max(1, ceil(self.stay / self.step)) if self.at_most else self.steps

    @property
    def demanded(self) -> tuple[Satisfy, ...]:
        """The ``satisfy`` clauses, and behind them what each ``carry`` asks at least."""
        return (*self.satisfy, *(Satisfy(carry.visits, carry.span) for carry in self.carries))

    @property
    def goal(self) -> Reach:
        """The ``reach`` clause; LookupError where the task has formulas only."""
        if self.reach is None:
            raise LookupError(f"task {self.name} has no reach clause")
        return self.reach

    @property
    def final_rates(self) -> FinalRates | None:
        """What binds the rates at the end of the motion; None: they are free."""
        return None if self.reach is None else self.reach.rates

    @property
    def stay(self) -> Fraction:
        """How long before its end the motion has to be in the target, in seconds."""
        return Fraction(0) if self.final_rates is None else self.final_rates.duration
