"""Figure 3: the workspace with the path and the motion, and the inputs over time."""

from __future__ import annotations

from collections.abc import Sequence

from paper.section import Claim, Figure, Section, claims_table, figures_of, number_of
from paper.syntheses import Synthesis
from srgc.render.html_text import number, text


def figure_3(found: Synthesis, published: Synthesis) -> Section:
    """The motion that was found, and that of the published lengths, with their inputs."""
    figures = [
        *_pair("a", found, "the design that srgc finds"),
        *_pair("b", published, "the published lengths"),
    ]
    path = _changes(found.design["path"][0])
    same, lengths = _changes(published.design["path"][0]), _lengths(published)
    claims = [
        Claim(
            "Figure 3(a)",
            "A path, found by a SAT solver, leads from the start round the obstacle to the target.",
            f"A SAT solver finds {len(path)} cells: {_path(path)}. "
            f"With the published lengths it is {_path(same)}.",
            "agrees",
        ),
        Claim(
            "Figure 3(a)",
            "The actual trajectory of the robot stays in free regions at the samples.",
            "The motion is proved to keep out of the obstacle at all times, not only at the "
            f"samples (erratum 4.15): the clearance is {_clearance(found)} m, with the published "
            f"lengths {_clearance(published)} m.",
            "corrected",
        ),
        Claim(
            "Figure 3(b)",
            f"A control strategy for links of {lengths} m, with inputs of at most 10.",
            "With these lengths inputs of at most "
            f"{number_of(published.design['effort_peak'], 3)} N*m do the task; with the design of "
            f"srgc {number_of(found.design['effort_peak'], 3)} N*m do. The task has a start, a "
            "step and ranges of its own (erratum 4.16), so the curves are not those of the paper.",
            "agrees",
        ),
    ]
    content = f"{figures_of(figures)}{claims_table('Figure 3 and Section 5', claims)}"
    return Section("figure-3", "Figure 3: workspace, motion and control", content)


def _pair(part: str, one: Synthesis, of: str) -> list[Figure]:
    lengths, path = _lengths(one), " > ".join(_changes(one.design["path"][0]))
    return [
        Figure(
            one.picture("workspace"),
            f"The workspace with the obstacle and the target, the cells {path}, and the arm with "
            f"links of {lengths} m in some poses from start to target.",
            f"({part}) Workspace, path of cells (blue) and motion (orange) of {text(of)}.",
            wide=True,
        ),
        Figure(
            one.picture("inputs"),
            f"Two torques over time, of at most {number_of(one.design['effort_peak'], 3)} N*m.",
            "Its inputs; the bound is 10 N*m on either side.",
            wide=True,
        ),
    ]


def _lengths(one: Synthesis) -> str:
    return " and ".join(number_of(length, 2) for length in one.lengths)


def _changes(cells: Sequence[str]) -> list[str]:
    """The cells in the order in which they are entered."""
    return [cell for k, cell in enumerate(cells) if k == 0 or cell != cells[k - 1]]


def _path(cells: Sequence[str]) -> str:
    return " → ".join(f"<code>{text(cell)}</code>" for cell in cells)


def _clearance(one: Synthesis) -> str:
    return number(one.margins["clearance of effector to O"], 2)
