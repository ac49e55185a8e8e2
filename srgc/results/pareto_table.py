"""All designs of ``synth --all`` held against each other: modules, total length, robustness.

One design per robot: the most robust that was found.  That it is the best of its robot is not
proved, so the table is about the designs, not about all that there could be.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from compiler.arrays import Array
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import WORLD, Joint, Offset, RobotModel
from grammar_lang import ir
from solvers.search.family_search import Proved
from solvers.search.path_task import Design
from solvers.search.synthesis import Synthesis
from srgc.results.design_file import efforts

DIGITS = 4
"""Significant digits to which designs are compared: below them is the noise of a search."""
OBJECTIVES = ("modules", "total_length", "robustness")
"""Few, short, and large; lengths in metres."""


@dataclass(frozen=True, slots=True)
class ParetoRow:
    """A proved design; ``dominated_by`` is the number of a structure that is better, or None."""

    structure: int
    word: tuple[str, ...]
    parameters: tuple[tuple[int, str, float], ...]
    modules: int
    total_length: float
    robustness: float
    dominated_by: int | None = None

    @property
    def folder(self) -> str:
        """Where its results are."""
        return f"designs/{self.structure}"

    def dominates(self, other: ParetoRow) -> bool:
        """Whether it is nowhere worse and somewhere better."""
        return self.costs != other.costs and all(
            own <= theirs for own, theirs in zip(self.costs, other.costs, strict=True)
        )

    @property
    def costs(self) -> tuple[float, float, float]:
        """The objectives, all to be small, to the digits that count and are printed."""
        return self.modules, float(_shown(self.total_length)), -float(_shown(self.robustness))


def pareto_rows(result: Synthesis, program: ir.Program, task: ir.Task) -> tuple[ParetoRow, ...]:
    """A row per design, in the order of the structures; the first that dominates one is named."""
    family = family_of(program, task)
    return judged([_row(proved, family, task) for proved in result.designs])


def _row(proved: Proved, family: RobotFamily, task: ir.Task) -> ParetoRow:
    design = proved.design
    word = design.derivation.word
    return ParetoRow(
        proved.number,
        word,
        tuple(
            (value.parameter.symbol, value.parameter.name, float(value))
            for value in design.parameters
        ),
        sum(family.program.is_module(symbol) for symbol in word),
        _length(design, family),
        float(Fraction(efforts(design, task)[1])),
    )


def _length(design: Design, family: RobotFamily) -> float:
    theta = np.array([float(value) for value in design.parameters])
    return total_length(family.built(design.derivation), theta)


def judged(rows: Sequence[ParetoRow]) -> tuple[ParetoRow, ...]:
    """The rows, each with the first that dominates it."""
    found = []
    for row in rows:
        better = next((other.structure for other in rows if other.dominates(row)), None)
        found.append(replace(row, dominated_by=better))
    return tuple(found)


def pareto_csv(rows: Sequence[ParetoRow]) -> str:
    """The designs that none dominates: ``structure``, the objectives, ``word``, ``folder``."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["structure", *OBJECTIVES, "word", "folder"])
    for row in rows:
        if row.dominated_by is None:
            numbers = (row.structure, row.modules, row.total_length, row.robustness)
            writer.writerow([*numbers, " ".join(row.word), row.folder])
    return buffer.getvalue()


def pareto_json(rows: Sequence[ParetoRow], ended: str | None) -> str:
    """All designs, those that are dominated apart; ``ended``: why not all structures were tried."""
    content = {
        "objectives": list(OBJECTIVES),
        "designs": [_entry(row) for row in rows if row.dominated_by is None],
        "dominated": [_entry(row) for row in rows if row.dominated_by is not None],
        "ended": ended,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _entry(row: ParetoRow) -> dict[str, Any]:
    parameters = [
        {"symbol": symbol, "name": name, "value": value} for symbol, name, value in row.parameters
    ]
    entry = {
        "structure": row.structure,
        "word": list(row.word),
        "parameters": parameters,
        "modules": row.modules,
        "total_length": row.total_length,
        "robustness": row.robustness,
        "folder": row.folder,
    }
    return entry if row.dominated_by is None else entry | {"dominated_by": row.dominated_by}


def pareto_text(rows: Sequence[ParetoRow], ended: str | None) -> str:
    """The table for people; the dominated designs below it, and why it ends where it does."""
    lines = [f"{'structure':>9} {'modules':>7} {'length (m)':>10} {'robustness':>10}  robot"]
    lines += [_line(row) for row in rows if row.dominated_by is None]
    others = [row for row in rows if row.dominated_by is not None]
    if others:
        lines.append("dominated:")
        lines += [f"{_line(row)} (by {row.dominated_by})" for row in others]
    if ended is not None:
        lines.append(f"not all structures were tried: {ended}")
    return "\n".join(lines)


def _line(row: ParetoRow) -> str:
    numbers = f"{row.structure:>9} {row.modules:>7} {_shown(row.total_length):>10}"
    return f"{numbers} {_shown(row.robustness):>10}  {' '.join(row.word)}"


def _shown(value: float) -> str:
    """A number to the digits that count."""
    return f"{value:.{DIGITS}g}"


# --- The total length of a robot: how much of it there is between its joints ----------------------


def total_length(model: RobotModel, theta: Array) -> float:
    r"""The sum of the lengths of a robot's rigid displacements at ``theta``, in metres.

    .. math:: \sum_{f \in F} \lVert t_f(\theta) \rVert_2

    Source: own definition.  F are the frames that a ``move`` by a vector t leads to and that lie
    on the way from the world to a joint or to an effector, each once however many ways share it.
    So a bracket ``move(x, a) * move(y, b)`` has length a + b, where ``model`` is the robot as it
    was built, before neighbouring displacements are merged.  Not counted are the travel of
    prismatic joints, which is no part of the design, and frames that only bodies are placed in:
    the way to the middle of a link is part of the link.

    Args:
        model: the robot.
        theta: its parameters, shape (p,), SI.
    """
    values = scalar_floats(model.scalars, theta)
    joints = (i for i, frame in enumerate(model.frames) if isinstance(frame.step, Joint))
    counted: set[int] = set()
    for end in (*joints, *model.effectors):
        frame = end
        while frame != WORLD and frame not in counted:
            counted.add(frame)
            frame = model.frames[frame].parent
    steps = [model.frames[frame].step for frame in sorted(counted)]
    return math.fsum(
        math.hypot(*(values[scalar] for scalar in step.vector))
        for step in steps
        if isinstance(step, Offset)
    )
