"""Whether a motion follows the path of cells that is claimed of it."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from compiler.geometry.abstraction import Abstraction
from solvers.verifier.proofs.finding import Finding, inside
from solvers.verifier.proofs.tube_checks import Status


def cell_path(
    cells: Abstraction,
    dt: float,
    path: Sequence[Sequence[str]],
    following: int | None,
    positions: Sequence[Sequence[Sequence[arb]]],
) -> Finding:
    """Every effector is in its cell at every sample, and one moves between neighbours only.

    Args:
        cells: the cells of the workspace.
        dt: the time between samples, s.
        path: per effector the name of its cell at every sample.
        following: the number of the effector that follows a path, from 0; None: of no one is known
            that it does, nor asked.
        positions: per sample and effector where it is, m.
    """
    adjacent = set(cells.adjacency)
    margin, undecided = float("inf"), False
    for effector, names in enumerate(path):
        for sample, name in enumerate(names):
            where = f"cell path: effector {effector + 1} at sample {sample}"
            try:
                index = cells.index(name)
            except KeyError:
                return Finding(f"{where}: no cell `{name}`", Status.FAILS, 0.0, "m", sample * dt)
            polytope = cells.cells[index].polytope
            finding = inside(where, polytope, positions[sample][effector], sample * dt)
            if finding.status is Status.FAILS:
                return Finding(
                    f"{where} is not in `{name}`",
                    Status.FAILS, finding.margin, "m", finding.time, finding.place,
                )  # fmt: skip
            undecided = undecided or finding.status is Status.UNDECIDED
            margin = min(margin, finding.margin)
            if effector == following and sample:
                before = cells.index(names[sample - 1])
                pair = (min(before, index), max(before, index))
                if before != index and pair not in adjacent:
                    return Finding(
                        f"{where} enters `{name}`, no neighbour of `{names[sample - 1]}`",
                        Status.FAILS, 0.0, "m", sample * dt,
                    )  # fmt: skip
    return Finding("cell path", Status.UNDECIDED if undecided else Status.HOLDS, margin, "m")
