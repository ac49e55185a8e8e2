"""Bounds on the effect of drives on one box of coordinates, for all parameters of a box.

The enclosures use interval arithmetic. M depends on few of the coordinates, so it is evaluated once
for boxes with equal sides in these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from flint import arb, fmpz

from compiler.dynamics.energy_graph import EnergyGraph
from compiler.expressions.evaluators.balls import ball
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.unreachability.actuation_measures import (
    CoordinateMeasure,
    HeightMeasure,
    Measure,
    Momentum,
    MomentumMeasure,
    momentum_of,
)
from compiler.unreachability.actuation_metric import (
    EffortGroup,
    EnclosedMass,
    Metric,
    kinetic_speed,
    metric,
    norm,
)

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Course:
    """A measure f on a box: its ends, and bounds on how fast it changes.

    ``steepness`` bounds |df| per unit of kinetic length, sqrt(f' M^-1 f'); ``speed`` bounds |df/dt|
    for the rates that the joints may have. None means that nothing is known.
    """

    low: arb
    high: arb
    steepness: arb | None
    speed: arb | None


@dataclass(frozen=True, slots=True)
class BoxBounds:
    """Bounds on a box: the courses of measures, the potential energy V, and upper bounds of sizes.

    ``inputs`` bounds ||u||, ``net`` bounds ||u - g|| (both in M^-1), ``unit_speed`` bounds the
    kinetic speed at rates up to one, ``rate_speed`` at rates that the joints may have. None means
    that nothing is known. ``momenta`` maps coordinates to their momenta, where these are known.
    """

    courses: tuple[Course, ...]
    potential: Ends
    inputs: arb | None
    net: arb | None
    unit_speed: arb | None
    rate_speed: arb | None
    momenta: Mapping[int, Momentum]


@dataclass(frozen=True, slots=True)
class _Inertia:
    """The bounds on a box that depend on M alone; see ``BoxBounds``."""

    mass: tuple[Ends, ...] = ()
    metric: Metric | None = None
    inputs: arb | None = None
    unit_speed: arb | None = None
    rate_speed: arb | None = None


@dataclass(slots=True)
class BoxEvaluator:
    """Computes bounds on boxes of the coordinates of one robot.

    ``tail`` holds the sides of the parameters, then the constants of the graph; ``rates`` are the
    bounds of the joints' rates, where the robot has them; ``groups`` bound the inputs, None if
    nothing is known about the forces on the joints. ``carried`` are lower bounds of the masses (kg)
    that move with the effectors, 0 if none is known.
    """

    graph: EnergyGraph
    tail: list[Ends]
    measures: Sequence[Measure]
    rates: Sequence[arb | None]
    groups: Sequence[EffortGroup] | None
    dimension: int
    carried: Sequence[arb]
    _known: dict[tuple[fmpz, ...], _Inertia] = field(
        default_factory=dict[tuple[fmpz, ...], _Inertia]
    )

    def read(self, box: Sequence[arb]) -> BoxBounds:
        """The bounds on a box."""
        sides = [around(side) for side in box]
        inertia, run = self._inertia(box, sides), INTERVALS
        net, potential, pull = inertia.inputs, Ends(ZERO, ZERO), list[Ends]()
        if self.graph.potential is not None and inertia.metric is not None and net is not None:
            potential, *pull = self.graph.potential.evaluate([*sides, *self.tail], run)
            finite = all(item.finite for item in pull)
            size = inertia.metric.size([item.ball() for item in pull]) if finite else None
            net = None if size is None else (net + size).upper()
        places = self.graph.effectors.evaluate([*sides, *self.tail], run)
        return BoxBounds(
            tuple(self._course(item, sides, places, inertia.metric) for item in self.measures),
            potential,
            inertia.inputs,
            net,
            inertia.unit_speed,
            inertia.rate_speed,
            self._momenta(inertia, pull),
        )

    def _momenta(self, inertia: _Inertia, pull: Sequence[Ends]) -> dict[int, Momentum]:
        if inertia.metric is None:
            return {}
        cyclic = [item.cyclic for item in self.measures if isinstance(item, MomentumMeasure)]
        size = len(self.rates)
        found = ((joint, momentum_of(joint, size, inertia.mass, pull)) for joint in cyclic)
        return {joint: momentum for joint, momentum in found if momentum is not None}

    def _inertia(self, box: Sequence[arb], sides: list[Ends]) -> _Inertia:
        if self.groups is None:
            return _Inertia()
        key = tuple(number for i in self.graph.shape for number in _exact(box[i]))
        if key not in self._known:
            enclosed = self._mass([*sides, *self.tail], len(box))
            mass = enclosed.over
            found, limits = (
                metric(enclosed, len(box)),
                [item for item in self.rates if item is not None],
            )
            self._known[key] = (
                _Inertia()
                if found is None
                else _Inertia(
                    tuple(mass),
                    found,
                    found.largest(self.groups),
                    kinetic_speed(mass, [arb(1)] * len(box)),
                    kinetic_speed(mass, limits) if len(limits) == len(box) else None,
                )
            )
        return self._known[key]

    def _mass(self, inputs: list[Ends], size: int) -> EnclosedMass:
        """M over a box of coordinates and parameters, and its centred form."""
        graph, run = self.graph, INTERVALS
        over, middle, radii = graph.mass.evaluate(inputs, run), list(inputs), list[arb]()
        for i in graph.active:
            side = inputs[i].ball()
            middle[i] = around(side.mid())
            radii.append(side.rad())
        slopes, count = graph.slopes.evaluate(inputs, run), size * size
        parts = [slopes[k * count : (k + 1) * count] for k in range(len(radii))]
        return EnclosedMass(
            over, graph.mass.evaluate(middle, run), list(zip(parts, radii, strict=True))
        )

    def _course(
        self, measure: Measure, sides: list[Ends], places: list[Ends], metric: Metric | None
    ) -> Course:
        if isinstance(measure, MomentumMeasure):
            extent = measure.over(sides)
            return Course(extent.low, extent.high, None, None)
        if isinstance(measure, CoordinateMeasure):
            slope = [arb(i == measure.dof) for i in range(len(sides))]
            extent = sides[measure.dof]
        else:
            slope, extent = self._height(measure, len(sides), places)
        finite = all(item.is_finite() for item in slope)
        steepness = metric.size(slope) if metric is not None and finite else None
        if isinstance(measure, HeightMeasure):
            steepness = self._held_back(measure, steepness)
        return Course(extent.low, extent.high, steepness, self._speed(slope) if finite else None)

    def _held_back(self, measure: HeightMeasure, steepness: arb | None) -> arb | None:
        """A bound of the steepness also by the mass that moves with the effector."""
        mass = self.carried[measure.effector]
        if not mass > 0:
            return steepness
        found = (norm([ball(factor) for factor in measure.normal]) / mass.sqrt()).upper()
        return found if steepness is None else steepness.min(found).upper()

    def _height(
        self, measure: HeightMeasure, dofs: int, places: list[Ends]
    ) -> tuple[list[arb], Ends]:
        """The gradient of a height, and its ends."""
        d = self.dimension
        column = d * len(self.carried)
        first = d * measure.effector

        def height(start: int) -> arb:
            total = ZERO
            for axis, factor in enumerate(measure.normal):
                place = places[start + axis]
                if factor:
                    total += ball(factor) * (place.ball() if place.finite else arb("nan"))
            return total

        slope = [height(column * (i + 1) + first) for i in range(dofs)]
        return slope, around(height(first))

    def _speed(self, slope: Sequence[arb]) -> arb | None:
        """The bound from the rates, if every joint that matters has one."""
        total = ZERO
        for entry, rate in zip(slope, self.rates, strict=True):
            if entry.is_zero():
                continue
            if rate is None:
                return None
            total += abs(entry).upper() * rate
        return total.upper()


def _exact(side: arb) -> list[fmpz]:
    """Integers that identify a ball uniquely."""
    return [number for part in (side.mid(), side.rad()) for number in part.man_exp()]


# --- A box of coordinates that a robot may be in, as input of a proof about its drives ------------


@dataclass(frozen=True, slots=True)
class LeafBox:
    """Balls around the coordinates; whether a pose in it may be a start pose, or a goal pose."""

    coordinates: tuple[arb, ...]
    start_possible: bool
    goal_possible: bool
