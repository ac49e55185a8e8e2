"""The lines of a task that may be in conflict: the demand of each, and where it is written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang.source import Source, Span
from solvers.explanation.posed_task import PosedTask

LineKind: TypeAlias = Literal[
    "start", "reach", "satisfy", "parameter", "fixed", "joint_range", "joint_rate", "joint_accel",
    "joint_effort", "avoid", "avoid_self", "bounds_body", "effort", "horizon", "gravity", "bounds",
    "modules", "accept", "control", "payload", "carry",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class TaskLine:
    """One demand that can be relaxed by itself; ``key`` distinguishes it from others of its kind.

    The key of a parameter, a range or a rate is the module and the name; that of an avoided region
    the index of the clause and the name; that of an ``effort``, ``satisfy``, ``payload`` or
    ``carry`` its index, that of a count in ``accept`` its index among the counts.
    """

    kind: LineKind
    key: tuple[str | int, ...]
    says: str
    span: Span = field(compare=False, repr=False)


def task_lines(posed: PosedTask) -> tuple[TaskLine, ...]:
    """All lines except the bound on modules; those best named in an explanation come first."""
    return (
        *_ends(posed.task),
        *_ranges(posed),
        *_avoided(posed),
        *_dynamics(posed.task),
        TaskLine(
            "bounds", (), "every effector stays within the bounds", posed.workspace.bounds.span
        ),
    )


def modules_line(posed: PosedTask) -> TaskLine | None:
    """The bound on modules, which is about the set of structures, not about one; or None."""
    task = posed.task
    if task.modules is None:
        return None
    says = f"a robot has at most {task.modules} modules"
    return TaskLine("modules", (), says, task.clauses.get("modules", task.span))


def control_line(posed: PosedTask) -> TaskLine | None:
    """The line about feedback: it is excluded by fixed inputs, or would help against disturbances.

    None if neither is the case, or if feedback is already asked for.
    """
    task = posed.task
    if task.control == "open loop":
        says = "the inputs are fixed in advance"
        return TaskLine("control", (), says, task.clauses.get("control", task.span))
    if task.control is None and task.robust is not None:
        spans = task.robust.clauses.values()
        return TaskLine(
            "control", (), "all of this holds under disturbances", min(spans, default=task.span)
        )
    return None


def _ends(task: ir.Task) -> Iterator[TaskLine]:
    """Where a robot starts and ends, and what it does in between."""
    if isinstance(task.start, ir.StartIn):
        where = f"{_who(task.start.effector)} starts in `{task.start.region}`"
        yield TaskLine("start", (), where, task.start.span)
    else:
        yield TaskLine("start", (), "the robot starts in this pose", task.start.span)
    if task.reach is not None:
        verb = "is at some time" if task.repeat else "ends"
        posed = ", turned like this" if task.reach.poses else ""
        where = f"{_who(task.reach.effector)} {verb} in `{task.reach.region}`{posed}"
        yield TaskLine("reach", (), where, task.reach.span)
    for index, clause in enumerate(task.satisfy):
        yield TaskLine("satisfy", (index,), "the formula holds", clause.span)
    for index, carry in enumerate(task.carries):
        says = f"a load is carried from `{carry.source}` to `{carry.target}`"
        yield TaskLine("carry", (index,), says, carry.span)


def _who(effector: int | None) -> str:
    return "an effector" if effector is None else f"effector {effector}"


def _ranges(posed: PosedTask) -> Iterator[TaskLine]:
    """Ranges of parameters, fixed parameters, and the limits of joints."""
    for module in posed.modules:
        for p in module.parameters:
            what = "range" if isinstance(p.domain, ir.Interval) else "list"
            says = f"the {what} of `{module.name}.{p.name}`"
            yield TaskLine("parameter", (module.name, p.name), says, p.span)
    origin = posed.task.origin
    for fixed in () if origin is None else origin.fixed:
        says = f"`{fixed.name}` keeps its value"
        yield TaskLine("fixed", (fixed.symbol, fixed.name), says, fixed.span)
    for module in posed.modules:
        for dof in module.dofs:
            name = f"`{module.name}.{dof.name}`"
            limits: tuple[tuple[LineKind, object, str], ...] = (
                ("joint_range", dof.range, "range"),
                ("joint_rate", dof.rate, "rates"),
                ("joint_accel", dof.accel, "acceleration"),
                ("joint_effort", dof.effort, "effort"),
            )
            for kind, limit, what in limits:
                if limit is not None:
                    yield TaskLine(kind, (module.name, dof.name), f"the {what} of {name}", dof.span)


def _avoided(posed: PosedTask) -> Iterator[TaskLine]:
    sources = posed.program.sources
    for index, clause in enumerate(posed.task.avoid):
        subject = "the whole body" if clause.subject == "body" else "every effector"
        for region in clause.regions:
            span = _mention(region, clause.span, sources)
            yield TaskLine("avoid", (index, region), f"{subject} stays out of `{region}`", span)
    if posed.task.avoid_self is not None:
        says = "the bodies of the robot stay apart"
        yield TaskLine("avoid_self", (), says, posed.task.avoid_self.span)
    if posed.task.bounds_body:
        span = posed.task.clauses.get("bounds_body", posed.task.span)
        yield TaskLine("bounds_body", (), "the whole body stays within the bounds", span)


def _mention(name: str, clause: Span, sources: tuple[Source, ...]) -> Span:
    """Where a clause mentions a name; the whole clause if this is not known."""
    if clause.file >= len(sources):
        return clause
    text = sources[clause.file].text[clause.start : clause.end]
    place = re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", text)
    if place is None:
        return clause
    return Span(clause.start + place.start(), clause.start + place.end(), clause.file)


def _dynamics(task: ir.Task) -> Iterator[TaskLine]:
    """The bounds of the motion."""
    for index, effort in enumerate(task.effort):
        yield TaskLine("effort", (index,), f"the effort of {effort.kind} joints", effort.span)
    says = f"the motion ends after {'at most ' if task.at_most else ''}{task.steps} steps"
    yield TaskLine("horizon", (), says, task.clauses.get("horizon", task.span))
    for index, payload in enumerate(task.payloads):
        yield TaskLine("payload", (index,), "the payload", payload.span)
    if any(task.gravity):
        yield TaskLine("gravity", (), "gravity", task.clauses.get("gravity", task.span))
