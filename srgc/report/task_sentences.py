"""What a task asks for, in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import degrees

from compiler.descriptions.model_symbols import closed_text
from compiler.objectives.objective_text import objective_text
from compiler.robots.state_and_input import EFFORT_UNITS
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from grammar_lang.ir.formula_parts import formula_text
from srgc.render.html_text import many, number, with_unit

RATE_UNITS: dict[ir.DofKind, str] = {"revolute": "rad/s", "prismatic": "m/s"}


def task_sentences(program: ir.Program, task: ir.Task) -> tuple[str, ...]:
    """What a task asks for, as plain text; regions and names are in backquotes."""
    return tuple(f"{sentence}." for sentence in _sentences(program, task))


def _sentences(program: ir.Program, task: ir.Task) -> Iterator[str]:
    workspace = program.workspaces[task.workspace]
    kind = "in the plane" if workspace.dimension == 2 else "in space"
    yield f"Robots are those of the family `{task.grammar}`, {kind}{_modules(task)}"
    if task.origin is not None:
        word = " ".join(task.origin.word)
        yield f"They are made from the existing robot `{word}`{_kept(program, task.origin)}"
    yield _start(program, task)
    if task.reach is not None:
        yield _reach(program, task, task.reach)
    yield from _avoided(task)
    bodies = "all bodies of the robot stay" if task.bounds_body else "every effector stays"
    yield f"At every instant {bodies} within the bounds of `{workspace.name}`"
    for clause in task.satisfy:
        yield f"The motion satisfies `{_short(formula_text(clause.formula))}`"
    for carry in task.carries:
        yield _carried(program, task, carry)
    yield from _limits(task)
    if task.minimize:
        yield f"Of the robots that do this, one with the least is asked for: {_least(task)}"


def _least(task: ir.Task) -> str:
    """The objectives of a task, in order."""
    asked = []
    for each in task.minimize:
        left = f" (up to {_value(100 * each.within)} % more is as good)" if each.within else ""
        asked.append(f"`{objective_text(each)}`{left}")
    return ", then ".join(asked)


def _modules(task: ir.Task) -> str:
    return "" if task.modules is None else f", of at most {task.modules} modules"


def _kept(program: ir.Program, origin: ir.Origin) -> str:
    if not origin.fixed:
        return ""
    said = []
    for each in origin.fixed:
        module = program.modules[origin.word[each.symbol]]
        (unit,) = (own.unit for own in module.parameters if own.name == each.name)
        shown = closed_text(each.value) + ("" if unit == "1" else f" {unit}")
        said.append(f"`{module.name}.{each.name}` of symbol {each.symbol}: {shown}")
    return f", whose parameters keep their values: {', '.join(said)}"


def _who(effector: int | None) -> str:
    return "an effector" if effector is None else f"effector {effector}"


def _start(program: ir.Program, task: ir.Task) -> str:
    if isinstance(task.start, ir.StartAt):
        return "The robot starts at rest in the pose that the spec gives"
    rates = task.start.rates
    how = (
        f"at rest{', where its inputs can hold it' if task.start.held else ''}"
        if not rates
        else f"with rates of at most {_value(rates)} {_rate_unit(program, task)}"
    )
    return f"The robot starts {how}, with {_who(task.start.effector)} in `{task.start.region}`"


def _rate_unit(program: ir.Program, task: ir.Task) -> str:
    """The units of the joint rates in a family."""
    symbols = {s.name for rule in program.grammars[task.grammar].productions for s in rule.right}
    modules = [program.modules[name] for name in symbols if name in program.modules]
    kinds = {dof.kind for module in modules for dof in module.dofs}
    units = [unit for kind, unit in RATE_UNITS.items() if kind in kinds]
    return " or ".join(units)


def _reach(program: ir.Program, task: ir.Task, reach: ir.Reach) -> str:
    end = _value(task.steps * task.step)
    steps = f"{many(task.steps, 'step')} of {_value(task.step)} s"
    bound = isinstance(task.start, ir.StartIn) and task.start.effector is None
    who = "the same effector" if bound and reach.effector is None else _who(reach.effector)
    if task.repeat:
        return f"At some time {who} is in `{reach.region}`{_turned(reach)}"
    when = "At the end of the motion" if task.at_most else f"At {end} s ({steps})"
    found = f"{when} {who} is in `{reach.region}`{_turned(reach)}"
    rates = reach.rates
    if rates is None:
        return found
    rest = rates.bound == ir.REST_RATE
    slow = f"with rates of at most {_value(rates.bound)} {_rate_unit(program, task)}"
    found += ", at rest" if rest else f", {slow}"
    return found + (f", for the last {_value(rates.duration)} s" if rates.duration else "")


def _carried(program: ir.Program, task: ir.Task, carry: ir.Carry) -> str:
    who = "the effector" if carry.effector is None else f"effector {carry.effector}"
    rates = carry.rates
    how = f"with rates of at most {_value(rates.bound)} {_rate_unit(program, task)}"
    if rates.bound == ir.REST_RATE:
        how = "at rest"
    load = f"a point mass of {_value(carry.mass)} kg"
    return f"In `{carry.source}` {who} takes up {load}, and puts it down in `{carry.target}`, {how}"


def _turned(reach: ir.Reach) -> str:
    """The orientation of the effector's frame at the target."""
    said = []
    for pose in reach.poses:
        within = f"within {_angle(pose.within)}°"
        if isinstance(pose, ir.Aligned):
            direction = ", ".join(_value(part) for part in pose.direction)
            said.append(f"the axis {pose.axis} of its frame along ({direction}) {within}")
            continue
        turns = ", then ".join(f"by {_angle(angle)}° about {axis}" for axis, angle in pose.turns)
        said.append(f"its frame turned {turns or 'like the world'} {within}")
    return f", {' and '.join(said)}" if said else ""


def _avoided(task: ir.Task) -> Iterator[str]:
    for clause in task.avoid:
        who = "the whole body stays" if clause.subject == "body" else "every effector stays"
        names = ", ".join(f"`{name}`" for name in clause.regions)
        margin = f", by at least {_value(clause.margin)} m" if clause.margin else ""
        yield f"At every instant {who} out of {names}{margin}"
    if task.avoid_self is not None:
        least = task.avoid_self.margin
        by = f" by at least {_value(least)} m" if least else ""
        pairs = ", ".join(f"`{one}` and `{two}`" for one, two in sorted(task.avoid_self.exceptions))
        more = f", and those of {pairs}" if pairs else ""
        free = f"those of one link, those of links that one joint connects{more}"
        yield f"The robot's bodies stay apart{by}, except {free}"


def _limits(task: ir.Task) -> Iterator[str]:
    kinds = {"revolute": "turning", "prismatic": "sliding"}
    for effort in task.effort:
        bound = with_unit(float(effort.bound), EFFORT_UNITS[effort.kind])
        what = "the norm of the efforts" if effort.norm2 else "the effort"
        yield f"At {kinds[effort.kind]} joints {what} is at most {bound}"
    for payload in task.payloads:
        who = "The effector" if payload.effector is None else f"Effector {payload.effector}"
        yield f"{who} carries a point mass of {_value(payload.mass)} kg"
    if any(task.gravity):
        vector = ", ".join(_value(part) for part in task.gravity)
        yield f"Gravity is ({vector}) m/s^2"
    if task.control is not None:
        feedback = task.control == "feedback"
        yield (
            "The inputs follow what is measured" if feedback else "The inputs are fixed in advance"
        )
    most = "at most " if task.at_most else ""
    if task.at_most and not task.repeat:
        steps, end = many(task.steps, "step"), _value(task.steps * task.step)
        yield f"The motion takes at most {steps} of {_value(task.step)} s, {end} s"
    if task.repeat:
        lasting = (
            f"the horizon of {most}{_value(task.steps * task.step)} s is a prefix and one loop"
        )
        yield f"The motion goes on for ever: {lasting}"
    if task.robust is not None:
        yield f"All of this holds although {_disturbances(task.robust)}"


def _disturbances(robust: ir.Robust) -> str:
    parts = []
    if start := _radii(robust.start):
        parts.append(f"the start is off by up to {start}")
    if measured := _radii(robust.measured):
        parts.append(f"what is measured is off by up to {measured}")
    if robust.effort:
        parts.append(f"every input is off by up to {_value(100 * robust.effort)} %")
    if robust.effort_of_bound:
        part = _value(100 * robust.effort_of_bound)
        parts.append(f"every input is off by up to {part} % of its bound")
    if robust.mass:
        parts.append(f"all masses are off by up to {_value(100 * robust.mass)} % alike")
    if robust.payload:
        parts.append(f"payloads are off by up to {_value(100 * robust.payload)} %")
    parts += [
        f"the masses of each `{item.module}` are off by up to {_value(100 * item.part)} % alike"
        for item in robust.masses
    ]
    return " and ".join(parts) or "nothing is disturbed"


def _radii(radii: ir.Radii) -> str:
    amounts = (
        (radii.angle, "°"),
        (radii.length, " m"),
        (radii.angular_rate, "°/s"),
        (radii.speed, " m/s"),
    )
    return ", ".join(
        f"{number(degrees(amount), 6) if '°' in unit else _value(amount)}{unit}"
        for amount, unit in amounts
        if amount
    )


def _short(formula: str) -> str:
    """A formula, cut off if it is long: with pieces of a map, it may have thousands of parts."""
    return formula if len(formula) <= 400 else f"{formula[:400]} …"


def _angle(value: ir.Expr) -> str:
    return number(degrees(to_float(value)), 6)


def _value(value: Fraction) -> str:
    return number(float(value), 6)
