"""``evaluations.csv`` and ``landscape.csv`` read back: parameters with their robustness."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from solvers.verifier.claims.spec_copy import bounded_text
from srgc.faults import UsageFault


@dataclass(frozen=True, slots=True)
class Evaluation:
    """One evaluation: ``theta`` by the parameters' names, ``symbol.name``, in SI."""

    structure: int
    path: int
    theta: dict[str, float]
    robustness: float
    feasible: bool


def evaluations(path: Path) -> tuple[Evaluation, ...]:
    """All evaluations in order; none where the table is missing.

    A landscape has neither structure nor path: both are 0.

    Raises:
        UsageFault: the table is none of ours.
    """
    try:
        content = bounded_text(path)
        return tuple(map(_evaluation, csv.DictReader(io.StringIO(content))))
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError, csv.Error):
        raise UsageFault(f"{path} is no table of evaluations") from None


def _evaluation(row: dict[str, str]) -> Evaluation:
    theta = {name: float(value) for name, value in row.items() if "." in name and value}
    if not all(map(isfinite, (*theta.values(), float(row["rho"])))):
        raise ValueError(row)
    return Evaluation(
        int(row.get("structure", 0)),
        int(row.get("path", 0)),
        theta,
        float(row["rho"]),
        bool(int(row["feasible"])),
    )


def varied(samples: Sequence[Evaluation]) -> tuple[str, ...]:
    """The parameters that have more than one value."""
    names = dict.fromkeys(name for each in samples for name in each.theta)
    return tuple(name for name in names if len({each.theta.get(name) for each in samples}) > 1)
