"""Checks of disturbances, and of the feedback against them, for the joints of the robot family."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.ir import constants
from grammar_lang.source import Span


def disturbance_diagnostics(program: ir.Program, sink: Sink, *, complete: bool = True) -> None:
    """Report radii that are too wide for joints, and joints that feedback does not drive.

    For a ``complete`` program also report radii for joints that no robot has; in other programs
    these joints may be missing.
    """
    for task in program.tasks.values():
        grammar = program.grammars[task.grammar]
        names = dict.fromkeys(x.name for rule in grammar.productions for x in rule.right)
        modules = [program.modules[name] for name in names if name in program.modules]
        _radii(task, modules, sink)
        if complete:
            _idle(task, modules, sink)
        _undriven(task, modules, sink)


# --- Radii against the ranges of joints and of their rates ----------------------------------------


@dataclass(frozen=True, slots=True)
class _Radius:
    """A radius of a ``robust`` clause, and what it applies to."""

    of: str
    name: str
    value: Fraction
    kind: ir.DofKind
    is_rate: bool


def _given(task: ir.Task) -> Iterator[_Radius]:
    robust = task.robust or ir.Robust()
    for of, radii in (("start", robust.start), ("measure", robust.measured)):
        yield _Radius(of, "angle", radii.angle, "revolute", is_rate=False)
        yield _Radius(of, "length", radii.length, "prismatic", is_rate=False)
        yield _Radius(of, "angular_rate", radii.angular_rate, "revolute", is_rate=True)
        yield _Radius(of, "speed", radii.speed, "prismatic", is_rate=True)


def _radii(task: ir.Task, modules: list[ir.Module], sink: Sink) -> None:
    """Report radii that cover the whole range of a joint, or let it start outside its range.

    An error if this holds for all joints that the radius applies to, else a warning.
    """
    clauses: Mapping[str, Span] = {} if task.robust is None else task.robust.clauses
    for radius in _given(task):
        if not radius.value:
            continue
        joints = [(m.name, dof) for m in modules for dof in m.dofs if dof.kind == radius.kind]
        narrow = [(name, dof) for name, dof in joints if _too_wide(radius, dof)]
        if not narrow:
            continue
        name, dof = narrow[0]
        what = "rates" if radius.is_rate else "range"
        joint = f"the {what} of `{name}.{dof.name}`"
        message = f"these errors leave no room for a start in {joint}"
        hint = "write less than half of its width"
        if radius.of == "measure":
            message = f"these errors are as wide as {joint}: nothing is measured"
            hint = "write less than its width"
        at = clauses.get(f"{radius.of} {radius.name}", task.span)
        notes = [(dof.span, "declared here")]
        report = sink.error if len(narrow) == len(joints) else sink.warning
        report(Code.WIDE_RADIUS, message, at, hint, notes)


def _too_wide(radius: _Radius, dof: ir.Dof) -> bool:
    """Whether a start would leave the range, or any value of the range may be measured."""
    interval = dof.rate if radius.is_rate else dof.range
    if interval is None:
        return False
    width = ir.Binary("-", interval.upper, interval.lower)
    needed = radius.value * (2 if radius.of == "start" else 1)
    try:
        return not constants.less(ir.Num(needed), width)
    except ValueError:
        return False


_FITTING = {
    "angle": "a length, such as `1 mm`",
    "length": "an angle, such as `0.1 deg`",
    "angular_rate": "a speed, such as `1 mm/s`",
    "speed": "an angular rate, such as `1 deg/s`",
}
"""The replacement for a radius if the joints are of the other kind."""


def _idle(task: ir.Task, modules: list[ir.Module], sink: Sink) -> None:
    """Report radii for a kind of joint that no robot of the family has."""
    clauses: Mapping[str, Span] = {} if task.robust is None else task.robust.clauses
    kinds = {dof.kind for module in modules for dof in module.dofs}
    for radius in _given(task):
        if radius.value and radius.kind not in kinds:
            message = f"no robot of `{task.grammar}` has a {radius.kind} joint: this has no effect"
            hint = f"write {_FITTING[radius.name]}, or remove it" if kinds else "remove it"
            at = clauses.get(f"{radius.of} {radius.name}", task.span)
            sink.warning(Code.BAD_VALUE, message, at, hint)


# --- Joints without an input ----------------------------------------------------------------------


def _undriven(task: ir.Task, modules: list[ir.Module], sink: Sink) -> None:
    """Report joints that no input acts on although inputs must follow measurements."""
    measured = task.robust is not None and task.robust.measured != ir.Radii()
    if task.control != "feedback" and not measured:
        return
    clauses = {} if task.robust is None else task.robust.clauses
    asked = task.clauses.get("control") or clauses.get("measure", task.span)
    joints = {(module.name, dof.name) for module in modules for dof in module.dofs}
    idle = [
        (module.name, torque)
        for module in modules
        for torque in module.torques
        if not _driven(module, torque)
    ]
    others = joints - {(name, torque.dof) for name, torque in idle}
    what = "other joints alone can" if others else "nothing can"
    for name, torque in idle:
        message = f"no input acts on `{name}.{torque.dof}`"
        hint = f"{what} correct it: give its torque an input, such as `u`"
        notes = [(asked, "feedback is asked for here")]
        sink.warning(Code.UNDRIVEN_JOINT, message, torque.span, hint, notes)


def _driven(module: ir.Module, torque: ir.Torque) -> bool:
    """Whether a torque depends on an input, directly or through the module's own states."""
    states = {state.name: state.derivative for state in module.states}
    todo, seen = [torque.value], set[str]()
    while todo:
        for leaf in ir.leaves(todo.pop()):
            if isinstance(leaf, ir.EffortOf | ir.InputOf):
                return True
            if isinstance(leaf, ir.StateOf) and leaf.name not in seen:
                seen.add(leaf.name)
                todo.append(states[leaf.name])
    return False
