"""Write the motion of a design as JSON, as CSV, as arrays (npz), and as a ROS 2 message."""

from __future__ import annotations

import csv
import io
import json
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.expressions.exact_numbers import decimal
from compiler.rigid_links.ball_pose import nearest
from compiler.rigid_links.rigid_tree import PRECISION
from grammar_lang import ir
from srgc.exports.exported_motion import ExportedMotion, Quantity, free_inputs
from srgc.exports.exported_robot import load_rows, load_states, motor_bound, origin, remarks
from srgc.exports.joint_drives import joint_drives
from srgc.exports.xml_lines import plain_line
from srgc.faults import UsageFault

# --- JSON, with the meaning of all numbers --------------------------------------------------------


FORMAT = "srgc trajectory 1"


def trajectory_json(motion: ExportedMotion) -> str:
    """The JSON document, with a line for each key and each row of a table."""
    parts = [f" {json.dumps(key)}: {text}" for key, text in _parts(motion)]
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _parts(motion: ExportedMotion) -> Iterator[tuple[str, str]]:
    claim, task = motion.design.claim, motion.design.task
    head: dict[str, Any] = {
        "format": FORMAT,
        "spec": claim.spec,
        "spec_sha256": claim.spec_sha256,
        "task": claim.task,
        "word": list(claim.word),
        "dimension": motion.design.model.dimension,
        "step": float(task.step),
        "steps": len(claim.inputs),
        "parameters": [
            {key: value for key, value in each.describe().items() if key != "module"}
            for each in motion.design.parameters
        ],
        "joints": list(_joints(motion)),
        "inputs": [_described(item) for item in motion.inputs],
        "states": [_described(item) for item in motion.states],
        "effectors": list(motion.effectors),
    }
    yield from ((key, _text(value)) for key, value in head.items())
    yield "t", _text([float(time) for time in motion.times])
    tables = {
        "position": motion.position,
        "velocity": motion.velocity,
        "acceleration": motion.acceleration,
        "effort": motion.effort,
        "input": motion.input,
        "state": motion.state,
        "effector": motion.effector,
    }
    for key, table in tables.items():
        rows = ",\n".join(f"  {_text(row)}" for row in table.tolist())
        yield key, f"[\n{rows}\n ]"


def _joints(motion: ExportedMotion) -> Iterator[dict[str, Any]]:
    model, task = motion.design.model, motion.design.task
    drives = joint_drives(model, motion.design.stated)
    for number, (joint, effort) in enumerate(zip(motion.joints, motion.efforts, strict=True)):
        dof = model.dofs[number]
        yield {
            "name": joint.name,
            "symbols": list(dof.symbols),
            "kind": dof.kind,
            "axis": dof.axis,
            "unit": joint.unit,
            "effort_unit": effort.unit,
            "range": _bounds(dof.range),
            "rate": _bounds(dof.rate),
            "acceleration": drives[number].acceleration,
            "effort": motor_bound(model, task, number),
        }


def _described(item: Quantity) -> dict[str, str]:
    return {"name": item.name, "unit": item.unit}


def _bounds(interval: ir.Interval | None) -> list[float] | None:
    if interval is None:
        return None
    with working_precision(PRECISION):
        return [nearest(closed_ball(end)) for end in (interval.lower, interval.upper)]


def _text(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


# --- A table (CSV), with a row for each sample ----------------------------------------------------


AXES = "xyz"


def trajectory_table(motion: ExportedMotion) -> str:
    """The table; numbers read back as the same doubles.

    Columns are ``t`` and then ``kind.name``, so that their names are unique.  The last row has no
    inputs.
    """
    rows = [["t", *_columns(motion)], *_rows(motion)]
    return csv_text(rows)


def torque_table(motion: ExportedMotion) -> str:
    """A table of only the efforts, held from their time on, in columns named after the joints.

    If loads are picked up and put down, the last column has the number of the robot with its
    current loads; 0 is the robot without loads.
    """
    head = ["t", *(joint.name for joint in motion.joints)]
    states = load_states(motion.design)
    if len(states) > 1:
        head.append("robot")
    rows = []
    for time, row, loads in zip(
        motion.times, motion.effort, load_rows(motion.design), strict=False
    ):
        number = [str(states.index(loads))] if len(states) > 1 else []
        rows.append([decimal(float(time)), *(decimal(value) for value in row), *number])
    return csv_text([head, *rows])


def gain_table(motion: ExportedMotion) -> str | None:
    """A table of the gains by which feedback reduces torques per deviation from the plan.

    It has a row for each step, and a column for each position or velocity and torque.  None for an
    open loop.
    """
    feedback = motion.design.feedback
    if feedback is None:
        return None
    names = [joint.name for joint in motion.joints]
    kinds = [f"{kind}.{name}" for kind in ("position", "velocity") for name in names]
    columns = free_inputs(motion.design.model)
    head = ["t", *(f"{kind} to {name}" for name in names for kind in kinds)]
    rows = (
        [decimal(float(time)), *(decimal(value) for value in gains[columns].ravel())]
        for time, gains in zip(motion.times[:-1], feedback.gains, strict=True)
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
    """An input as the certificate states it, or as a decimal if that is a quotient."""
    return decimal(value) if "/" in text else text


# --- NumPy arrays in one file (npz) ---------------------------------------------------------------


EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of all members: the earliest that zip files can express."""
UNIX = 3


def trajectory_arrays(motion: ExportedMotion) -> bytes:
    """The npz file of a motion."""
    return array_file(*_arrays(motion))


def array_file(numbers: Mapping[str, Array], texts: Mapping[str, Sequence[str]]) -> bytes:
    """An uncompressed npz file of named arrays of any shape, without pickles.

    Equal content gives equal bytes.
    """
    arrays: dict[str, NDArray[np.generic]] = {
        name: np.ascontiguousarray(value, dtype="<f8") for name, value in numbers.items()
    }
    arrays |= {name: _texts(value) for name, value in texts.items()}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            member = zipfile.ZipInfo(f"{name}.npy", EPOCH)
            member.create_system = UNIX
            member.external_attr = 0o644 << 16
            content = io.BytesIO()
            np.lib.format.write_array(content, array, allow_pickle=False)
            archive.writestr(member, content.getvalue())
    return buffer.getvalue()


def _arrays(motion: ExportedMotion) -> tuple[dict[str, Array], dict[str, Sequence[str]]]:
    numbers = {
        "t": np.array([float(time) for time in motion.times]),
        "q": motion.position,
        "qd": motion.velocity,
        "qdd": motion.acceleration,
        "effort": motion.effort,
        "u": motion.input,
        "s": motion.state,
        "effectors": motion.effector,
    }
    texts: dict[str, Sequence[str]] = {
        "joint_names": [joint.name for joint in motion.joints],
        "input_names": [item.name for item in motion.inputs],
        "state_names": [item.name for item in motion.states],
        "effector_names": list(motion.effectors),
        "word": list(motion.design.claim.word),
        "spec_sha256": [motion.design.claim.spec_sha256],
    }
    return numbers, texts


def _texts(values: Sequence[str]) -> NDArray[np.generic]:
    width = max((len(value) for value in values), default=1) or 1
    return np.array(values, dtype=f"<U{width}")


# --------------------------------------------------------------------------------------------------
# A ROS 2 message, ``trajectory_msgs/msg/JointTrajectory``, in YAML.
#
# Points have no accelerations: with held torques these jump at the samples, and a message can have
# only one there.  From positions and velocities controllers interpolate by cubic polynomials, as
# they should if a motion is smooth between its samples.


NANO = 10**9
OPEN_LOOP = "open loop: efforts are held from point to point, and nothing that is measured counts"
NO_GAINS = "the gains of its feedback are not in here; `srgc export --to controller` writes them"
MOST_SECONDS = 2**31
"""builtin_interfaces/msg/Duration has seconds as signed 32-bit integers."""


def joint_trajectory(motion: ExportedMotion, *, efforts: bool = True) -> str:
    """The message, after comment lines.

    Args:
        motion: the motion to write.
        efforts: whether the points have efforts; at the end, those of the last step.

    Raises:
        UsageFault: its times are not distinct in nanoseconds, or too large.
    """
    times = [_nanoseconds(time) for time in motion.times]
    if any(after <= before for before, after in pairwise(times)):
        raise UsageFault("steps of less than a nanosecond are no JointTrajectory")
    if times[-1] >= MOST_SECONDS * NANO:
        raise UsageFault(f"a motion of {MOST_SECONDS} s or more cannot be a JointTrajectory")
    message = {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": [joint.name for joint in motion.joints],
        "points": list(_points(motion, times, efforts=efforts)),
    }
    control = OPEN_LOOP if motion.design.claim.controller is None else NO_GAINS
    notes = (*origin(motion.design), control, *remarks(motion.design))
    head = "".join(f"# {plain_line(line)}\n" for line in notes)
    dumped = yaml.safe_dump(
        message, default_flow_style=None, sort_keys=False, width=10**9, allow_unicode=True
    )
    return head + str(dumped)


def _nanoseconds(time: Fraction) -> int:
    return round(time * NANO)


def _points(motion: ExportedMotion, times: list[int], *, efforts: bool) -> Iterator[dict[str, Any]]:
    for k, time in enumerate(times):
        yield {
            "positions": motion.position[k].tolist(),
            "velocities": motion.velocity[k].tolist(),
            "accelerations": [],
            "effort": motion.effort[k].tolist() if efforts else [],
            "time_from_start": {"sec": time // NANO, "nanosec": time % NANO},
        }
