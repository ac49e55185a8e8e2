"""The controller of a design for export: the numbers of its law, and their description."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, pi

from compiler.expressions.exact_numbers import decimal
from compiler.robots.state_and_input import robot_inputs
from solvers.verifier.claims.certificate import exact
from srgc.exports.exported_motion import (
    POSITION_UNITS,
    Quantity,
    input_quantities,
    planned_inputs,
    quantities,
)
from srgc.exports.exported_robot import design_names, design_tree, origin
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign

RATE_UNITS = {"revolute": "rad/s", "prismatic": "m/s"}


@dataclass(frozen=True, slots=True, eq=False)
class ExportedController:
    """The inputs u = u* - K (x - x*) at each of k samples, as decimals in SI units.

    Attributes:
        design: the design.
        measured: x, the coordinates of the joints, then their rates (2n,).
        inputs: u (m,).
        planned: u*, (k, m).
        reference: x*, (k, 2n); None for an open loop, which measures nothing.
        gains: K, (k, m, 2n); None for an open loop.
    """

    design: FoundDesign
    measured: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    planned: tuple[tuple[str, ...], ...]
    reference: tuple[tuple[str, ...], ...] | None
    gains: tuple[tuple[tuple[str, ...], ...], ...] | None

    @property
    def samples(self) -> int:
        """The number of samples."""
        return len(self.planned)

    @property
    def loop(self) -> int | None:
        """The first sample of a loop, which follows the last one; None if the motion ends."""
        claim = self.design.claim.loop
        return None if claim is None else claim.first

    @property
    def winding(self) -> tuple[int, ...]:
        """The measured coordinates of joints that make whole turns in a loop.

        They may be given modulo a turn.
        """
        claim = self.design.claim.loop
        if claim is None or claim.turns is None or self.reference is None:
            return ()
        return tuple(joint for joint, turns in enumerate(claim.turns) if turns)

    @property
    def least_turns(self) -> int:
        """The most turns between a winding coordinate and its reading by a single-turn sensor."""
        rows = self.reference or ()
        return max(
            (ceil(abs(float(row[joint])) / (2 * pi)) + 1 for row in rows for joint in self.winding),
            default=0,
        )

    @property
    def loads(self) -> frozenset[int]:
        """The inputs that state what is carried, 1 or 0; they do not depend on measurements."""
        inputs = robot_inputs(self.design.model)
        return frozenset(place for place, item in enumerate(inputs) if item.is_load)

    @property
    def period(self) -> Fraction:
        """The time between samples in seconds."""
        return self.design.task.step

    @property
    def name(self) -> str:
        """The prefix of names in a program: the task, whose name is valid in C and Python."""
        return self.design.task.name


def exported_controller(design: FoundDesign) -> ExportedController:
    """The controller of a design; without feedback, its planned inputs.

    Raises:
        UsageFault: the robot has no inputs, or the numbers of the certificate do not match it.
    """
    model, claim = design.model, design.claim
    if not robot_inputs(model):
        raise UsageFault("the robot has no inputs, so there is nothing to control")
    # This rejects inputs that do not match the robot.
    planned_inputs(design)
    joints = design_names(design, design_tree(design)).joints
    positions = [f"position of {name}" for name in joints]
    rates = [f"rate of {name}" for name in joints]
    measured = quantities(positions, [POSITION_UNITS[dof.kind] for dof in model.dofs])
    measured += quantities(rates, [RATE_UNITS[dof.kind] for dof in model.dofs])
    reference, gains = None, None
    # A robot without joints has nothing to measure.
    if claim.controller is not None and design.feedback is not None and measured:
        reference = tuple(map(_literals, claim.controller.reference))
        gains = tuple(tuple(map(_literals, gain)) for gain in claim.controller.gains)
    inputs = input_quantities(model, joints)
    planned = tuple(map(_literals, claim.inputs))
    return ExportedController(design, measured, inputs, planned, reference, gains)


def _literals(row: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(map(literal, row))


def literal(text: str) -> str:
    """A number of a certificate as a decimal with a point; a quotient is rounded to a double.

    Raises:
        CertificateError: the text is not a number.
    """
    value = exact(text)
    if "/" in text:
        text = decimal(float(value))
    return text if "." in text else f"{text}.0"


def described(controller: ExportedController, turns: int = 0) -> Iterator[str]:
    """Lines that describe the numbers, and when they are read and held.

    Winding coordinates may be given up to ``turns`` whole turns away.
    """
    period, last = decimal(float(controller.period)), controller.samples - 1
    if controller.gains is None:
        yield "The inputs of a robot, fixed in advance: an open loop. It measures nothing."
        yield "At sample k it holds the inputs u*(k) of the certificate until sample k + 1."
    else:
        yield "The controller of a robot. At sample k it reads x, and until sample k + 1 it holds"
        yield "    u = u*(k) - K(k) (x - x*(k))"
        yield "with the inputs u*, the gains K and the reference x* of the certificate."
    yield ""
    yield from origin(controller.design)
    yield ""
    yield f"Sample k is at k * {period} s, from 0 to {last}. The proof is about inputs that are"
    if controller.gains is None:
        yield "held from that time on."
    else:
        yield "computed from what is measured at that time, and held from that time on, without"
        yield "delay. Angles count turns: they are not reduced to an interval."
        for joint in controller.winding:
            yield f"The {controller.measured[joint].name} is an exception: the joint comes back by"
            yield "whole turns, so it may be counted or reduced to any interval of a turn, up to"
            yield f"{turns} turns away from the reference. What is farther away is an error."
        yield ""
        yield from _listed("measured", controller.measured)
    if controller.loop is not None:
        yield ""
        yield f"The motion goes on for ever: behind sample {last} comes {controller.loop} again,"
        yield f"so that sample {last + 1} is that, and so on."
    yield ""
    yield from _listed("inputs", controller.inputs)
    if controller.loads:
        yield "A load is 1 in the steps in which its effector has it, and 0 in all others. What is"
        yield "there in the last step is put down at its end."


def _listed(array: str, items: tuple[Quantity, ...]) -> Iterator[str]:
    for number, item in enumerate(items):
        yield f"{array}[{number}]: {item.name} ({item.unit})"
