"""The paper's figures, algorithm, case study and claims beside what srgc computes, as one page.

What was computed is kept in the folder, so that an interrupted run goes on where it ended.  The
same arguments give the same page.

    python benchmarks/paper_page.py --seeds 3 --evaluations 10 --points 5
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from paper.algorithm_1 import algorithm_1
from paper.case_study import case_study
from paper.errata_table import PAGE, errata_section
from paper.figure_1 import figure_1
from paper.figure_2 import figure_2
from paper.figure_3 import figure_3
from paper.figure_4 import figure_4, landscape
from paper.page import page
from paper.paper_loop import paper_steps
from paper.search_section import search_section
from paper.searches import search_runs
from paper.syntheses import ARM, PUBLISHED, PUBLISHED_BODY, synthesis
from timing import ROOT

SEEDS, EVALUATIONS, POINTS = 20, 30, 21
OF_A_PATH = 12
"""Evaluations of parameters for each path of Algorithm 1, as ``srgc synth`` has them."""


def write_page(folder: Path, seeds: int, evaluations: int, points: int, jobs: int) -> Path:
    """Compute what is not kept in the folder, and write the page there."""
    found, published, body = (synthesis(folder, spec) for spec in (ARM, PUBLISHED, PUBLISHED_BODY))
    steps = paper_steps(folder, min(evaluations, OF_A_PATH))
    grid = landscape(folder, found, points, jobs)
    runs = search_runs(folder / "searches", seeds, evaluations, jobs)
    sections = [
        figure_1(),
        figure_2(),
        figure_3(found, published),
        figure_4(grid, found),
        algorithm_1(steps, found),
        case_study(found, published, body),
        search_section(runs),
        errata_section(PAGE.read_text(encoding="utf-8")),
    ]
    file = folder / "index.html"
    file.write_text(page(sections, seeds, "make paper"), encoding="utf-8")
    return file


def main() -> None:
    """Write the page and say where it is."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS, help="of each search of parameters")
    parser.add_argument("--evaluations", type=int, default=EVALUATIONS, help="of each search")
    parser.add_argument("--points", type=int, default=POINTS, help="lengths per link of Figure 4")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("-o", type=Path, default=ROOT / "out" / "paper", help="the folder")
    options = parser.parse_args()
    if min(options.seeds, options.evaluations, options.jobs) < 1 or options.points < 2:
        parser.error("at least one seed, one evaluation, one job, and two lengths")
    options.o.mkdir(parents=True, exist_ok=True)
    np.seterr(all="ignore")
    file = write_page(options.o, options.seeds, options.evaluations, options.points, options.jobs)
    print(f"page: {file}", file=sys.stderr)


if __name__ == "__main__":
    main()
