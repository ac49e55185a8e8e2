"""The motion of a design as JSON, with all that its numbers mean."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.rigid_links.ball_pose import nearest
from compiler.rigid_links.rigid_tree import PRECISION
from grammar_lang import ir
from srgc.exports.design_robot import motor_bound
from srgc.exports.exported_motion import ExportedMotion, Quantity

FORMAT = "srgc trajectory 1"


def trajectory_json(motion: ExportedMotion) -> str:
    """The document: a line per key, and per row of a table."""
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
