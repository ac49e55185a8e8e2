"""``evaluations.csv``: all parameters that a synthesis has evaluated, for tables and pictures."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from compiler.expressions.exact_numbers import decimal
from solvers.search.configuration_search import PathSamples, Sample
from solvers.verifier.claims.spec_copy import bounded_text

FIXED = ("structure", "path", "rho", "feasible")


def parameter_names(paths: Sequence[PathSamples]) -> list[str]:
    """The names of all parameters, ``symbol.name``, by symbol and then as first seen."""
    names = dict.fromkeys(name for each in paths for name in each.names)
    return sorted(names, key=lambda name: int(name.partition(".")[0]))


def evaluations_csv(paths: Sequence[PathSamples]) -> str:
    """The table: a row per evaluation, in order; a parameter that a robot lacks is left empty.

    Columns are ``structure`` and ``path`` (both from 0), the parameters in SI units, ``rho`` and
    ``feasible`` (0 or 1).
    """
    names = parameter_names(paths)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([*FIXED[:2], *names, *FIXED[2:]])
    for each in paths:
        for sample in each.samples:
            own = dict(zip(each.names, map(decimal, sample.theta), strict=True))
            writer.writerow(
                [
                    each.structure,
                    each.path,
                    *(own.get(name, "") for name in names),
                    decimal(sample.robustness),
                    int(sample.feasible),
                ]
            )
    return buffer.getvalue()


def last_samples(path: Path, structure: int, names: Sequence[str]) -> tuple[Sample, ...]:
    """The samples of the last path of a structure in a table; none without the table.

    Raises:
        ValueError: the table is none of ours.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(bounded_text(path))))
    except FileNotFoundError:
        return ()
    except (OSError, UnicodeDecodeError, csv.Error):
        raise ValueError(f"{path} is no table of evaluations") from None
    try:
        own = [row for row in rows if int(row["structure"]) == structure]
        last = max((int(row["path"]) for row in own), default=0)
        return tuple(
            Sample(
                np.array([float(row[name]) for name in names]),
                float(row["rho"]),
                bool(int(row["feasible"])),
            )
            for row in own
            if int(row["path"]) == last
        )
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{path} is no table of evaluations") from None
