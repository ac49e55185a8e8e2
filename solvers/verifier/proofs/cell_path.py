"""Whether a motion follows the path of cells that is claimed of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb

from compiler.workspaces.abstraction import Abstraction
from solvers.verifier.proofs.finding import NO_MARGIN, Finding, inside
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
    worst = Finding("cell path", Status.HOLDS, NO_MARGIN, "m")
    for effector, names in enumerate(path):
        for sample, name in enumerate(names):
            where = f"cell path: effector {effector + 1} at sample {sample}"
            try:
                index = cells.index(name)
            except KeyError:
                return Finding(f"{where}: no cell `{name}`", Status.FAILS, 0.0, "m", sample * dt)
            polytope = cells.cells[index].polytope
            finding = inside("cell path", polytope, positions[sample][effector], sample * dt)
            if finding.status is Status.FAILS:
                return replace(finding, name=f"{where} is not in `{name}`")
            worst = min(worst, finding, key=_clear)
            if effector == following and sample:
                before = cells.index(names[sample - 1])
                pair = (min(before, index), max(before, index))
                if before != index and pair not in adjacent:
                    return Finding(
                        f"{where} enters `{name}`, no neighbour of `{names[sample - 1]}`",
                        Status.FAILS, 0.0, "m", sample * dt,
                    )  # fmt: skip
    return worst


def _clear(finding: Finding) -> tuple[bool, float]:
    """The less, the worse; what is open counts before what holds."""
    return finding.status is Status.HOLDS, finding.margin
