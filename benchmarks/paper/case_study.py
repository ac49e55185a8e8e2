"""The case study as a table: the paper's numbers beside srgc's, and why they differ."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from timing import SPEC

import srgc
from compiler.arrays import Array
from paper.figure_4 import PAPER
from paper.section import (
    Answer,
    Claim,
    Section,
    claims_table,
    inline_html,
    number_of,
    paragraph,
    word,
)
from paper.syntheses import Synthesis
from srgc.render.html_text import number

BOUND = 10
"""The paper's bound on inputs, in N*m."""
STEPS = 81
"""The paper's k."""
OBSTACLE = ((1.7, 3.0), (2.0, 3.0))
TARGET = ((3.5, 4.2), (3.8, 4.5))
"""The paper's regions, in m: the ends in x, and in y."""


def case_study(found: Synthesis, published: Synthesis, body: Synthesis) -> Section:
    """The design that is found, the published lengths, and these with the whole arm."""
    design = found.design
    program = srgc.load(SPEC).ir
    (task,) = program.tasks.values()
    cells = design["cells"]
    first = next(each for each in design["structures_tried"] if each["verdict"] == "refuted")
    printed, derived = printed_inertia(*PAPER, 0.0), derived_inertia(*PAPER, 0.0)
    claims = [
        Claim(
            "Obstacle",
            _box(OBSTACLE),
            f"{_box(box_of(cells['O']))}, held against the end effector",
            _same(OBSTACLE, box_of(cells["O"])),
        ),
        Claim("Target", _box(TARGET), _box(box_of(cells["T"])), _same(TARGET, box_of(cells["T"]))),
        Claim(
            "Start",
            "not given",
            f"{_box(box_of(cells['S']))}, at rest: a choice of ours, on which all that follows "
            "depends.",
            "not stated",
        ),
        Claim(
            "Bounds, ranges of lengths, step",
            "not given",
            f"A square of 5 m, lengths of 0.5 m to 5 m, steps of {float(task.step):g} s: choices "
            "of ours, marked <code>(*)</code> in the specification (erratum 4.16).",
            "not stated",
        ),
        Claim(
            "Bound on inputs",
            f"{BOUND}",
            f"{BOUND} N*m; the paper gives no unit, and efforts of joints that turn are torques.",
            "agrees",
        ),
        Claim(
            "Path",
            f"A sequence of {STEPS} regions, found by a SAT solver",
            f"{task.steps} steps through {len(set(design['path'][0]))} of {len(cells)} convex "
            "cells. srgc plans changes of cell and leaves the timing to the control synthesis, so "
            "it needs fewer and larger cells (errata 4.15 and 4.18).",
            "agrees",
        ),
        Claim(
            "One link",
            "&quot;It is quite obvious&quot; that it cannot do the task; the search finds no "
            "parameter.",
            f"Proved: {inline_html(first['reason'])}. It is false where links stand below the "
            "joint (erratum 4.13).",
            "corrected",
        ),
        Claim(
            "Two links",
            f"The robot with two links does the task, with {PAPER[0]} m and {PAPER[1]} m.",
            f"{word(design['word'])} with {_lengths(found)} m is {design['verdict']}, and its "
            f"certificate is {found.outcome}: the best lengths depend on start, step and ranges. "
            f"With the published ones the task is {published.design['verdict']} as well, and the "
            f"certificate is {published.outcome}.",
            "agrees",
        ),
        Claim(
            "Robustness",
            "positive; no number",
            f"{number_of(design['robustness'], 3)} N*m, with the published lengths "
            f"{number_of(published.design['robustness'], 3)} N*m, each on the path on "
            "which the search proved it.",
            "not stated",
        ),
        Claim(
            "Largest input",
            f"within {BOUND}; Figure 3(b) has the curves",
            f"{number_of(design['effort_peak'], 4)} N*m, with the published lengths "
            f"{number_of(published.design['effort_peak'], 4)} N*m: with rods of 1 kg/m and "
            f"{float(task.step * task.steps):g} s the task needs little effort.",
            "agrees",
        ),
        Claim(
            "Inertia, entry D₁₂",
            f"{number_of(printed[0, 1], 2)} kg*m^2 with the published lengths stretched out, as it "
            "is printed",
            f"{number_of(derived[0, 1], 2)} kg*m^2: the printed entry begins with l₁³/3 in place "
            "of l₂³/3 (erratum 4.6).",
            "corrected",
        ),
        Claim(
            "Coriolis terms",
            "E = 0",
            "derived from the energies, not left out (erratum 4.4)",
            "corrected",
        ),
        Claim(
            "Guarantee",
            "Regions are held at the samples of a linearised model.",
            f"A tube about the motion of the nonlinear robot, at all times; the "
            f"certificate is {found.outcome}. Its clearance of the obstacle is "
            f"{number(found.margins['clearance of effector to O'], 2)} m.",
            "corrected",
        ),
        Claim(
            "The whole arm",
            "The obstacle is held against the effector only.",
            "With the whole arm the published lengths are "
            f"<strong>{body.design['verdict']}</strong>, and the evidence "
            f"is {body.outcome} (<code>specs/planar_arm_body_paper.srg</code>, erratum 4.14).",
            "differs",
        ),
        Claim(
            "Search",
            "not given",
            f"{design['iterations']['structures']} structures, {design['iterations']['paths']} "
            f"paths, {design['iterations']['evaluations']} evaluations of parameters.",
            "not stated",
        ),
    ]
    intro = (
        "<code>specs/planar_arm.srg</code> is the paper's task; "
        "<code>specs/planar_arm_paper.srg</code> is the same with the published lengths."
    )
    content = paragraph(intro) + claims_table("The case study, Section 5", claims)
    return Section("case-study", "The case study", content)


def printed_inertia(first: float, second: float, angle: float) -> Array:
    """The matrix D (2, 2) as Section 5 prints it, in kg m^2, of lengths in m at an angle in rad."""
    corner = first**3 / 3 + second**2 * first * np.cos(angle) / 2
    whole = (first**3 + second**3 + 3 * first**2 * second) / 3
    return np.array([[whole + second**2 * first * np.cos(angle), corner], [corner, second**3 / 3]])


def derived_inertia(first: float, second: float, angle: float) -> Array:
    """The mass matrix (2, 2) that srgc derives of the same arm, in kg m^2."""
    robot = srgc.robot(SPEC, "B eps JO eps L eps JO eps L eps EN", [first, second])
    return robot.mass_matrix([0.0, angle])


Ends = tuple[tuple[float, float], tuple[float, float]]


def box_of(rows: list[str]) -> Ends:
    """The ends in x and in y of a box that is written as four inequalities.

    Raises:
        KeyError: it is no such box.
    """
    ends = dict[str, float]()
    for row in rows:
        side, _, bound = row.partition(" <= ")
        ends[side] = float(Fraction(bound))
    return (-ends["-x"], ends["x"]), (-ends["-y"], ends["y"])


def _box(ends: Ends) -> str:
    return " × ".join(f"[{low:g}, {high:g}]" for low, high in ends) + " m"


def _same(paper: Ends, ours: Ends) -> Answer:
    return "agrees" if paper == ours else "differs"


def _lengths(one: Synthesis) -> str:
    return " m and ".join(number_of(length, 2) for length in one.lengths)
