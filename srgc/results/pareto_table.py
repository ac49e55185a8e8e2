"""The table that compares all designs of ``synth --all`` or ``synth --pareto``.

The columns are the objectives of the task, or without objectives, modules, total length and
robustness.  There is one design per robot, the best one found.  It is not proved to be the best of
its robot, so the table is about the designs, not about everything that is possible.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from compiler.arrays import Array
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.objective_text import objective_name, objective_unit
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import WORLD, Joint, Offset, RobotModel
from grammar_lang import ir
from grammar_lang.diagnostics.wording import counted
from solvers.search.design_values import design_bounds
from solvers.search.family_search import Proved
from solvers.search.path_task import Design
from solvers.search.synthesis import Synthesis
from srgc.results.design_file import efforts
from srgc.results.pareto_front import (
    Figure,
    ParetoRow,
    judged,
    objective_figure,
    rounded_figure,
    whole_figure,
)


@dataclass(frozen=True, slots=True)
class Column:
    """An objective: its name in files, its unit, and its heading."""

    name: str
    unit: str
    heading: str


USUAL = (
    Column("modules", "", "modules"),
    Column("total_length", "m", "length (m)"),
    Column("robustness", "", "robustness"),
)
"""Fewer modules, shorter length and larger robustness are better."""


@dataclass(frozen=True, slots=True)
class ParetoTable:
    """All designs, one per row.

    ``chosen`` is the number of the structure that the result is about if the task has objectives,
    else None.  ``front_only``: dominated designs are named, but not kept.  ``ended`` says why not
    all structures were tried.
    """

    columns: tuple[Column, ...]
    rows: tuple[ParetoRow, ...]
    chosen: int | None
    front_only: bool
    ended: str | None

    @property
    def front(self) -> tuple[ParetoRow, ...]:
        """The designs that no other dominates."""
        return tuple(row for row in self.rows if row.dominated_by is None)

    @property
    def dominated(self) -> tuple[ParetoRow, ...]:
        """The designs that another one dominates."""
        return tuple(row for row in self.rows if row.dominated_by is not None)


def pareto_table(
    result: Synthesis, program: ir.Program, task: ir.Task, *, front_only: bool
) -> ParetoTable:
    """The table of the designs of a result.

    They are in the order of the structures or, if the task has objectives, in the order of their
    costs.
    """
    family, asked = family_of(program, task), amounts(program, task)
    rows = judged([_row(proved, family, task, asked) for proved in result.designs])
    if not asked:
        return ParetoTable(USUAL, rows, None, front_only, result.ended)
    in_order = tuple(sorted(rows, key=lambda row: (row.costs, row.structure)))
    chosen = result.designs[0].number
    return ParetoTable(_columns(asked), in_order, chosen, front_only, result.ended)


def _columns(asked: Sequence[Amount]) -> tuple[Column, ...]:
    """The columns for the objectives of a task."""
    found = []
    for amount in asked:
        unit, heading = objective_unit(amount.objective), objective_name(amount.objective)
        found.append(Column(amount.text, unit, f"{heading} ({unit})" if unit else heading))
    return tuple(found)


def _row(proved: Proved, family: RobotFamily, task: ir.Task, asked: Sequence[Amount]) -> ParetoRow:
    design = proved.design
    named = tuple(
        objective_figure(amount.objective, bounds)
        for amount, bounds in zip(asked, design_bounds(design, asked, task), strict=True)
    )
    return ParetoRow(
        proved.number,
        design.derivation.word,
        tuple(
            (value.parameter.symbol, value.parameter.name, float(value))
            for value in design.parameters
        ),
        named or _usual(design, family, task),
    )


def _usual(design: Design, family: RobotFamily, task: ir.Task) -> tuple[Figure, ...]:
    """The values by which designs are compared if the task has no objectives."""
    theta = np.array([float(value) for value in design.parameters])
    length = total_length(family.built(design.derivation), theta)
    return (
        whole_figure(sum(map(family.program.is_module, design.derivation.word))),
        rounded_figure(length),
        rounded_figure(float(Fraction(efforts(design, task)[1])), large=True),
    )


# --- The table as files and as text ---------------------------------------------------------------


def pareto_csv(table: ParetoTable) -> str:
    """The designs of the front: ``structure``, the objectives, ``word``, ``folder``."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    names = [column.name for column in table.columns]
    if table.chosen is not None:
        names = [f"{c.name} ({c.unit})" if c.unit else c.name for c in table.columns]
    writer.writerow(["structure", *names, "word", "folder"])
    for row in table.front:
        values = [figure.value for figure in row.figures]
        writer.writerow([row.structure, *values, " ".join(row.word), row.folder])
    return buffer.getvalue()


def pareto_json(table: ParetoTable) -> str:
    """All designs as JSON, with the dominated ones separately."""
    named = {} if table.chosen is None else {"units": [column.unit for column in table.columns]}
    content = {
        "objectives": [column.name for column in table.columns],
        **named,
        "designs": [_entry(row, table) for row in table.front],
        "dominated": [_entry(row, table) for row in table.dominated],
        **({} if table.chosen is None else {"chosen": table.chosen}),
        "ended": table.ended,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _entry(row: ParetoRow, table: ParetoTable) -> dict[str, Any]:
    parameters = [
        {"symbol": symbol, "name": name, "value": value} for symbol, name, value in row.parameters
    ]
    values = [figure.value for figure in row.figures]
    kept = not table.front_only or row.dominated_by is None
    entry: dict[str, Any] = {
        "structure": row.structure,
        "word": list(row.word),
        "parameters": parameters,
        **({"values": values} if table.chosen is not None else _by_name(table, values)),
        "folder": row.folder if kept else None,
    }
    return entry if row.dominated_by is None else entry | {"dominated_by": row.dominated_by}


def _by_name(table: ParetoTable, values: Sequence[float]) -> dict[str, float]:
    """Maps the names of the objectives to their values."""
    return {column.name: value for column, value in zip(table.columns, values, strict=True)}


def pareto_text(table: ParetoTable) -> str:
    """The table for people, with the dominated designs below it, and why the search ended early."""
    shown = table.front if table.front_only else table.rows
    widths = [
        max(len(column.heading), *(len(row.figures[k].shown) for row in shown))
        for k, column in enumerate(table.columns)
    ]
    headings = [column.heading for column in table.columns]
    lines = [f"structure {_aligned(headings, widths)}  robot"]
    lines += [_line(row, widths) for row in table.front]
    lines += _dominated(table, widths)
    if table.ended is not None:
        lines.append(f"not all structures were tried: {table.ended}")
    return "\n".join(lines)


def _dominated(table: ParetoTable, widths: Sequence[int]) -> Iterator[str]:
    """The lines about dominated designs."""
    others = table.dominated
    if others and table.front_only:
        yield f"dominated: {counted(len(others), 'design')}, named in pareto.json"
    elif others:
        yield "dominated:"
        yield from (f"{_line(row, widths)} (by {row.dominated_by})" for row in others)


def _line(row: ParetoRow, widths: Sequence[int]) -> str:
    numbers = _aligned([figure.shown for figure in row.figures], widths)
    return f"{row.structure:>9} {numbers}  {' '.join(row.word)}"


def _aligned(texts: Sequence[str], widths: Sequence[int]) -> str:
    """Texts aligned right in columns."""
    return " ".join(f"{text:>{width}}" for text, width in zip(texts, widths, strict=True))


# --- The total length of a robot: the distances between its joints --------------------------------


def total_length(model: RobotModel, theta: Array) -> float:
    r"""The sum of the lengths of a robot's rigid displacements at ``theta``, in metres.

    .. math:: \sum_{f \in F} \lVert t_f(\theta) \rVert_2

    Source: own definition.  F are the frames that a ``move`` by a vector t leads to and that lie on
    the way from the world to a joint or to an effector; a frame on several ways counts once. So a
    bracket ``move(x, a) * move(y, b)`` has length a + b, where ``model`` is the robot as it was
    built, before neighbouring displacements are merged.  Not counted are the travel of prismatic
    joints, which is no part of the design, and frames that only place bodies: the way to the middle
    of a link is part of the link.

    Args:
        model: the robot.
        theta: its parameters, shape (p,), in SI units.
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
