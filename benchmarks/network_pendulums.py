"""Pendulums of ARCH-COMP with networks as controllers: the robots, and enclosures of their motions.

Robots are compiled from a specification; the states of their graphs are the angles of the links
from the upright, and the rates, as the competition has them. At every sample the network is a
feedback law with errors (`relu_network.py`). What moves the set between samples, and what holds it
against limits, are the verifier's own functions.

Source: Johnson et al., *ARCH-COMP21 category report: artificial intelligence and neural network
control systems* (2021); the properties are those of the competition's files of 2023 and 2024.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from flint import arb, arb_mat

from benchmarks.relu_network import ReluNetwork
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.expressions.evaluators.balls import ball, constant_ball, working_precision
from compiler.expressions.tape import tape
from compiler.robots.normal_form import family_of
from grammar_lang.load import load_text
from solvers.verifier.proofs.control_law import SampledLaw
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, TubeSegment, tube
from solvers.verifier.proofs.state_limits import StateLimit, check_limits
from solvers.verifier.proofs.tube_checks import Status, Stretch
from solvers.verifier.proofs.vector_field import Curvature, VectorField
from solvers.verifier.proofs.zonotope import InitialSet, Zonotope

SPEC = """\
module B { role base; }
module J { role joint; dof q: revolute z; }
module L { role link; const length = 0.5 m; const mass = 500 g; }
module E { role effector; }
edge eps;
grammar Pendulum {
  start N;
  base: N -> B; joint: N -> N eps J; link: N -> N eps L; tip: N -> N eps E;
}
semantics Pendulum {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  link { this.frame = N.frame * move(x, L.length); point(frame: this.frame, mass: L.mass); }
  tip { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Air { plane xy; bounds box [-2, 2] x [-2, 2] m; region All box [-2, 2] x [-2, 2] m; }
task Stand {
  robot Pendulum; workspace Air; start in All; reach All;
  gravity (-1, 0) m/s^2;  // links point along x where their angles are 0: upright
  effort <= 100 N*m; horizon 20 steps of 0.05 s;
}
"""
ACCURACY = Accuracy(order=10, bits=64, remainder=1e-7)
RATE_SHARE = Fraction(1, 3)
"""A box is cut along a rate where it is this much longer than along angles."""
MOST_PARTS = 500
SLICES = 16
"""The parts of a segment over which ranges are taken."""
Interval = tuple[str, str]
Box = tuple[tuple[Fraction, Fraction], ...]


@dataclass(frozen=True)
class Case:
    """A system of the competition: all states of the box are to keep ``limits`` from a step on.

    ``initial`` and ``limits`` have an interval per angle, then per rate, None being no limit.
    """

    name: str
    links: int
    network: str
    initial: tuple[Interval, ...]
    limits: tuple[Interval | None, ...]
    first: int
    period: str
    steps: int = 20

    @property
    def box(self) -> Box:
        """The initial box."""
        return tuple((Fraction(low), Fraction(high)) for low, high in self.initial)


SINGLE = "controller_single_pendulum.nnet"
LESS, MORE = (f"controller_double_pendulum_{kind}_robust.nnet" for kind in ("less", "more"))
REST, WIDE = ("0", "0.2"), (("1", "1.3"),) * 4
CASES = (
    Case("single 2024", 1, SINGLE, (("1", "1.175"), REST), (("0", "1"), None), 10, "0.05"),
    Case("single 2023", 1, SINGLE, (("1", "1.2"), REST), (("0", "1"), None), 10, "0.05"),
    Case("less robust 2024", 2, LESS, WIDE, (("-1.7", "2"),) * 4, 0, "0.05"),
    Case("less robust 2023", 2, LESS, WIDE, (("-1", "1.7"),) * 4, 0, "0.05"),
    Case("more robust 2024", 2, MORE, WIDE, (("-1.5", "1.5"),) * 4, 0, "0.02"),
    Case("more robust 2023", 2, MORE, WIDE, (("-0.5", "1.5"),) * 4, 0, "0.02"),
)
"""The properties of 2024, and those of 2023, none of which holds."""


@lru_cache
def pendulum(links: int) -> RobotGraph:
    """The equations of motion of so many links, of which every angle is from the upright."""
    program = load_text(SPEC, "pendulum.srg").program
    assert program is not None
    task = program.tasks["Stand"]
    family = family_of(program, task)
    model = family.robot(family.replay(("tip", *("link", "joint") * links, "base")))
    return robot_graph(model, task.gravity, absolute_angles(model))


@dataclass(frozen=True)
class NetworkLaw:
    """The law that holds what a network makes of the state at each sample.

    ``turn`` takes its outputs, which turn each link against the ground, to the torques of joints.
    """

    network: ReluNetwork
    turn: tuple[tuple[int, ...], ...]
    place: int

    def held(self, step: int, states: Zonotope) -> Zonotope:
        """The states at a sample with the inputs that the network then holds."""
        del step
        turn, found = arb_matrix(self.turn), self.network.over(states)
        none = (arb(0),) * len(self.turn)
        errors = [] if found.errors is None else (turn * found.errors).transpose().tolist()
        law = SampledLaw(
            (tuple((turn * found.offset).entries()),), (-(turn * found.gain),), (none,),
            (tuple(map(tuple, errors)),), self.place,
        )  # fmt: skip
        return law.held(0, states)


def network_law(graph: RobotGraph, network: ReluNetwork) -> NetworkLaw:
    """The law of a network for the states of a graph whose coordinates are the links' angles.

    With q = D y, torques u at the joints are D^-T times those that turn the links (virtual work).
    """
    turn = np.linalg.inv(np.array(graph.coordinates.rows, dtype=float)).T
    n = len(graph.model.dofs)
    return NetworkLaw(network, tuple(tuple(round(x) for x in row) for row in turn), 2 * n)


def arb_matrix(rows: Sequence[Sequence[int]]) -> arb_mat:
    return arb_mat([[arb(x) for x in row] for row in rows])


@dataclass
class Enclosed:
    """What is known of all motions from a box: the hull at each sample, and the limits' margins."""

    segments: list[TubeSegment]
    hulls: list[list[arb]]
    limits: list[StateLimit]
    ended: str = ""

    @property
    def status(self) -> Status:
        """Of all limits together."""
        found = {limit.status for limit in self.limits}
        if Status.FAILS in found:
            return Status.FAILS
        undecided = self.ended or Status.UNDECIDED in found
        return Status.UNDECIDED if undecided else Status.HOLDS

    @property
    def margin(self) -> float:
        """The least of all limits."""
        return min((limit.margin for limit in self.limits), default=float("inf"))

    def complete(self, case: Case) -> bool:
        """Whether it goes on to the last step."""
        return len(self.hulls) == case.steps + 1

    def bounds(
        self, first: Fraction, last: Fraction, period: Fraction
    ) -> tuple[list[float], list[float]]:
        """The least and largest of all entries from one time to another, in steps: (2 n,) each."""
        size, lows, highs = len(self.hulls[0]), list[list[float]](), list[list[float]]()
        with working_precision(ACCURACY.bits):
            for segment in self.segments:
                start, end = segment.steps
                if start <= last and first <= end:
                    begun, length = max(first, start) - start, min(last, end) - max(first, start)
                    for k in range(SLICES if length else 1):
                        sides = (begun + length * j / SLICES for j in (k, k + 1))
                        time = arb.union(*(ball(side * period) for side in sides))
                        values = segment.at(time)[:size]
                        lows.append([float(x.lower()) for x in values])
                        highs.append([float(x.upper()) for x in values])
        low = [min(entry) for entry in zip(*lows, strict=True)]
        return low, [max(entry) for entry in zip(*highs, strict=True)]


def enclosed(case: Case, network: ReluNetwork, box: Box) -> Enclosed:
    """The motions from all states of a box, up to the first time at which a limit is not shown."""
    graph = pendulum(case.links).holding_inputs
    n = case.links
    with working_precision(ACCURACY.bits):
        tail = tuple(map(constant_ball, graph.constants))
        field = VectorField(
            tape(graph.balance), tape(graph.variation), n, tail, n, tape(graph.input_slopes),
            Curvature.of(graph),
        )  # fmt: skip
        middles = [ball((low + high) / 2) for low, high in box] + [arb(0)] * n
        rows = tuple(tuple(arb(int(i == j)) for j in range(2 * n)) for i in range(3 * n))
        radii = tuple(ball((high - low) / 2) for low, high in box)
        limits = list(state_limits(case))
        first = [ball(low).union(ball(high)) for low, high in box]
        found = Enclosed([], [first], limits)
        motions = tube(
            field, InitialSet(tuple(middles), rows, radii), [(arb(0),) * n] * case.steps,
            ball(Fraction(case.period)), ACCURACY, law=network_law(graph, network),
        )  # fmt: skip
        try:
            for segment in motions:
                found.segments.append(segment)
                if segment.number >= case.first:
                    check_limits(Stretch.of(segment, segment.inputs), limits)
                if found.status is not Status.HOLDS:
                    break
                if segment.steps[1].denominator == 1:
                    found.hulls.append(list(segment.end[: 2 * n]))
        except EnclosureFailure as failure:
            found.ended = str(failure)
    return found


def state_limits(case: Case) -> Iterator[StateLimit]:
    """The limits of a case, of states with the held inputs behind them."""
    for number, limit in enumerate(case.limits):
        if limit is not None:
            weights = tuple(int(i == number) for i in range(3 * case.links))
            unit = "rad" if number < case.links else "rad/s"
            low, high = (ball(Fraction(end)) for end in limit)
            yield StateLimit(f"entry {number + 1}", unit, weights, low, high)


def is_point(box: Box) -> bool:
    """Whether there is one state in it."""
    return all(low == high for low, high in box)


def halves(box: Box) -> list[Box]:
    """A box cut where it is longest, rates counting less than angles."""
    n = len(box) // 2
    sizes = [(high - low) * (1 if i < n else RATE_SHARE) for i, (low, high) in enumerate(box)]
    longest = sizes.index(max(sizes))
    low, high = box[longest]
    middle = (low + high) / 2
    return [(*box[:longest], half, *box[longest + 1 :]) for half in ((low, middle), (middle, high))]


@dataclass
class Outcome:
    """What is shown of a case: the tubes of the parts that it took, in CPU seconds."""

    status: Status
    parts: list[tuple[Box, Enclosed]]
    tried: int
    seconds: float

    @property
    def margin(self) -> float:
        """The least of all parts."""
        return min(found.margin for _, found in self.parts)

    def widths(self, step: int) -> list[float]:
        """The sides of the box around all parts after a step."""
        hulls = [found.hulls[step] for _, found in self.parts]
        return [
            max(float(x.upper()) for x in entry) - min(float(x.lower()) for x in entry)
            for entry in zip(*hulls, strict=True)
        ]


def shown(case: Case, network: ReluNetwork, box: Box) -> Outcome:
    """The motions from a box, in parts that are cut until the limits are shown of each."""
    begun = time.process_time()
    todo, parts, tried = [box], list[tuple[Box, Enclosed]](), 0
    while todo:
        part = todo.pop()
        found = enclosed(case, network, part)
        tried += 1
        if found.status is Status.HOLDS:
            parts.append((part, found))
        elif found.status is Status.FAILS or tried == MOST_PARTS or is_point(part):
            return Outcome(found.status, [(part, found)], tried, time.process_time() - begun)
        else:
            todo += halves(part)
    return Outcome(Status.HOLDS, parts, tried, time.process_time() - begun)
