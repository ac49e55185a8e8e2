"""Figure 4: the robustness over the lengths of the two links."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from paper.kept_records import digest, kept
from paper.section import Claim, Figure, Section, claims_table, figure, number_of
from paper.syntheses import Synthesis
from srgc.api.landscape import landscape_of

PAPER = (2.23, 3.35)
"""The lengths that the paper finds, in m."""


def landscape(folder: Path, found: Synthesis, points: int, jobs: int) -> Mapping[str, Any]:
    """The robustness on a grid of so many lengths per link, kept in the folder.

    ``lengths`` (2, points) in m, ``robustness`` and ``feasible`` (points, points), the same of the
    published lengths, and the picture.
    """
    record: Mapping[str, Any] = kept(
        folder / "figure-4.json",
        {"spec": digest("planar_arm"), "points": points},
        lambda: _evaluated(found.folder, points, jobs),
    )
    return record


def _evaluated(folder: Path, points: int, jobs: int) -> dict[str, Any]:
    marks = {"the paper's lengths": PAPER}
    evaluated = landscape_of(folder, None, {}, points, marks, jobs)
    (mark,) = evaluated.content.marked
    return {
        "lengths": [values.tolist() for values in evaluated.axes.values()],
        "robustness": evaluated.robustness.tolist(),
        "feasible": evaluated.feasible.tolist(),
        "published": mark.robustness,
        "svg": evaluated.svg,
    }


def figure_4(record: Mapping[str, Any], found: Synthesis) -> Section:
    """The picture, and what the paper concludes from its own."""
    values, feasible = np.array(record["robustness"]), np.array(record["feasible"], dtype=bool)
    first, second = record["lengths"]
    row, column = np.unravel_index(np.argmax(values), values.shape)
    best = f"({number_of(first[row], 2)}, {number_of(second[column], 2)}) m"
    share = f"{feasible.sum()} of {feasible.size}"
    known = record["published"]
    one = Figure(
        record["svg"],
        f"Robustness over both lengths in colours: {share} points are feasible, and the best is "
        f"{best}.",
        f"{feasible.size} control syntheses; every other choice is that of the design (star).",
        wide=True,
    )
    claims = [
        Claim(
            "Figure 4",
            "The robustness depends on both lengths; where is not said in numbers.",
            f"{share} pairs of lengths are feasible; of these the least robust has "
            f"{number_of(values[feasible].min(), 2)} N*m, the most robust "
            f"{number_of(values.max(), 2)} N*m, at {best}.",
            "not stated",
        ),
        Claim(
            "Section 5",
            f"The best lengths are {PAPER[0]} m and {PAPER[1]} m.",
            f"There the robustness is {number_of(known, 2)} N*m, on the path of the design; the "
            f"design has {number_of(found.design['robustness'], 2)} N*m. The paper gives neither "
            "start nor step (erratum 4.16), on which the best lengths depend.",
            "differs",
        ),
    ]
    content = f"{figure(one)}{claims_table('Figure 4', claims)}"
    return Section("figure-4", "Figure 4: robustness over the lengths", content)
