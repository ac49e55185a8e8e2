"""Write the files of a controller, in the precisions whose rounding its proof allows for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path

from flint import arb

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.tasks.specification import measurement_radii
from solvers.verifier.claims.certificate import exact
from srgc.exports.controller_code import c_text, controller_arrays, python_text
from srgc.exports.exported_controller import ExportedController, exported_controller, literal
from srgc.exports.law_rounding import BITS, DOUBLE, SINGLE, Precision, rounding_bounds
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign, found_tube

C, C_SINGLE, PYTHON, NPZ = "controller.c", "controller_single.c", "controller.py", "controller.npz"
CONTROLLER_FILES = (C, C_SINGLE, PYTHON, NPZ)
MOST_TURNS = (1_000_000, 100_000, 10_000, 1_000, 100, 10)
"""How many turns away winding coordinates may be given; the largest allowed number is used."""
UPWARDS = 1.05
"""A number times this, rounded to two digits, is not less than the number."""


def controller_files(folder: Path, design: FoundDesign) -> tuple[dict[str, bytes], tuple[str, ...]]:
    """The files by their names, and notes on those that are missing.

    Args:
        folder: the result folder, whose tube contains all possible measurements.
        design: the design in it.

    Raises:
        UsageFault: there are no inputs, or the proof does not allow for rounding in doubles.
        NoAnswer: the tube does not reach the end of the motion.
    """
    controller = exported_controller(design)
    if controller.gains is None:
        return _encoded(controller, _open_loop_notes(controller)), ()
    allowed = _allowances(controller)
    measured = _measured(folder, design)
    turns, bounds, excess = _covered(controller, measured, DOUBLE, allowed)
    if excess is not None:
        raise UsageFault(f"no controller is covered by its proof: in doubles, {excess}")
    stated = tuple(_rounding_notes(controller, bounds, "double"))
    fewer, bounds, excess = _covered(controller, measured, SINGLE, allowed)
    if excess is not None:
        why = f"no {C_SINGLE}: in single precision, {excess}"
        return _encoded(controller, (*stated, f"There is {why}."), turns), (why,)
    files = _encoded(controller, stated, turns)
    notes = tuple(_rounding_notes(controller, bounds, "float"))
    return files | {C_SINGLE: c_text(controller, SINGLE, notes, fewer).encode()}, ()


def _covered(
    controller: ExportedController,
    measured: Sequence[Sequence[arb]],
    precision: Precision,
    allowed: Sequence[Fraction],
) -> tuple[int, list[arb], str | None]:
    """The number of turns that the proof allows, and bounds on rounding then (m,).

    Winding coordinates may be given up to this many turns away.  If even the least number is not
    allowed, the third value says why.
    """
    least = controller.least_turns
    choices = [most for most in MOST_TURNS if most > least] if controller.winding else []
    turns, bounds, excess = 0, list[arb](), None
    for turns in (*choices, least):
        bounds = rounding_bounds(controller, measured, precision, turns)
        excess = _excess(controller, bounds, allowed)
        if excess is None:
            break
    return turns, bounds, excess


def _encoded(
    controller: ExportedController, notes: Sequence[str], turns: int = 0
) -> dict[str, bytes]:
    """The files in double precision."""
    return {
        C: c_text(controller, DOUBLE, notes, turns).encode(),
        PYTHON: python_text(controller, notes, turns).encode(),
        NPZ: controller_arrays(controller),
    }


def _allowances(controller: ExportedController) -> list[Fraction]:
    """How far the proof allows each input (m,) to be from the law, in its unit.

    Raises:
        UsageFault: the proof allows for no rounding.
    """
    claim = controller.design.claim.controller
    if claim is None or claim.rounding is None:
        raise UsageFault(
            "the certificate states no allowance for rounding, so its proof covers no precision: "
            "run `srgc synth` again"
        )
    if len(claim.rounding) != len(controller.inputs):
        raise UsageFault("the controller of the certificate does not fit the robot")
    return [exact(text) for text in claim.rounding]


def _measured(folder: Path, design: FoundDesign) -> list[list[arb]]:
    """All possible measurements (2n,) at each sample in the tube of a design, as balls."""
    noise = measurement_radii(design.task, design.model)
    with working_precision(BITS):
        errors = [ball(radius) * arb(0, 1) for radius in noise]
        return [
            [
                arb(low).union(arb(high)) + error
                for (low, high), error in zip(bounds, errors, strict=True)
            ]
            for bounds in found_tube(folder).samples.tolist()
        ]


def _excess(
    controller: ExportedController, rounding: Sequence[arb], allowed: Sequence[Fraction]
) -> str | None:
    """A text on the first input whose rounding may exceed what the proof allows, or None."""
    for item, bound, most in zip(controller.inputs, rounding, allowed, strict=True):
        if not bool(bound <= ball(most)):
            return (
                f"rounding may change the input {item.name} by {_shown(bound)} {item.unit}, "
                f"and the proof allows for {float(most):.2g} {item.unit}"
            )
    return None


def _rounding_notes(
    controller: ExportedController, rounding: Sequence[arb], kind: str
) -> Iterator[str]:
    claim = controller.design.claim.controller
    yield ""
    yield "Rounding: how far inputs may be from that law, for all that may be measured in the tube,"
    yield f"each quantity rounded to the nearest {kind}; and how far the proof allows them to be."
    allowed = () if claim is None or claim.rounding is None else claim.rounding
    for number, (item, bound) in enumerate(zip(controller.inputs, rounding, strict=True)):
        if number in controller.loads:
            continue
        yield f"inputs[{number}]: {_shown(bound)} {item.unit} of {allowed[number]} {item.unit}"


def _open_loop_notes(controller: ExportedController) -> tuple[str, ...]:
    worst = max(
        abs(Fraction(float(literal(text))) - exact(text))
        for row in controller.design.claim.inputs
        for text in row
    )
    return (
        "",
        "The proof is about the decimals of the certificate. The doubles nearest to them differ",
        f"by at most {_shown(ball(worst))}." if worst else "are the same numbers.",
    )


def _shown(bound: arb) -> str:
    """A bound with two digits, rounded up."""
    return f"{UPWARDS * float(bound.upper()):.1e}"
