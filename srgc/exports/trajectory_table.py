"""The motion of a design as a table (CSV), a row per sample."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

from compiler.expressions.exact_numbers import decimal
from srgc.exports.exported_motion import ExportedMotion

AXES = "xyz"


def trajectory_table(motion: ExportedMotion) -> str:
    """The table; numbers read back as the same doubles.

    Columns are ``t`` and then ``kind.name``, so that no two are called the same.  The last row has
    no inputs.
    """
    rows = [["t", *_columns(motion)], *_rows(motion)]
    return csv_text(rows)


def torque_table(motion: ExportedMotion) -> str:
    """The efforts alone, each held from its time on, in columns called after the joints."""
    head = ["t", *(joint.name for joint in motion.joints)]
    rows = (
        [decimal(float(time)), *(decimal(value) for value in row)]
        for time, row in zip(motion.times[:-1], motion.effort, strict=False)
    )
    return csv_text([head, *rows])


def csv_text(rows: Sequence[Sequence[str]]) -> str:
    """Rows of cells as CSV."""
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    return buffer.getvalue()


def _columns(motion: ExportedMotion) -> Iterator[str]:
    for kind in ("position", "velocity", "acceleration", "effort"):
        yield from (f"{kind}.{joint.name}" for joint in motion.joints)
    yield from (f"input.{item.name}" for item in motion.inputs)
    yield from (f"state.{item.name}" for item in motion.states)
    axes = AXES[: motion.design.model.dimension]
    yield from (f"effector.{name}.{axis}" for name in motion.effectors for axis in axes)


def _rows(motion: ExportedMotion) -> Iterator[list[str]]:
    held = [
        *(
            [_stated(text, value) for text, value in zip(*row, strict=True)]
            for row in zip(motion.design.claim.inputs, motion.input.tolist(), strict=True)
        ),
        [""] * len(motion.inputs),
    ]
    for k, time in enumerate(motion.times):
        before = (motion.position, motion.velocity, motion.acceleration, motion.effort)
        yield [
            decimal(float(time)),
            *(decimal(value) for part in before for value in part[k]),
            *held[k],
            *(decimal(value) for part in (motion.state, motion.effector) for value in part[k].flat),
        ]


def _stated(text: str, value: float) -> str:
    """An input as the certificate says it, or as a decimal where that is a quotient."""
    return decimal(value) if "/" in text else text
