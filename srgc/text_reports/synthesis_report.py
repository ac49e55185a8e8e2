"""The outcome of a synthesis as plain text: the robot, its changes, the inputs it uses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from compiler.objectives.objective_text import gap_text
from compiler.robots.normal_form import family_of
from compiler.robots.reconfiguration import Reconfiguration, reconfiguration
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import (
    dry_friction,
    input_bounds,
    robot_inputs,
)
from grammar_lang import ir
from grammar_lang.diagnostics.wording import counted
from solvers.planner import Exhaustion
from solvers.search.objective_result import Optimality
from solvers.search.parameter_bounds import CLOSELY
from solvers.search.path_task import Design, robustness_share
from solvers.search.search_state import CounterExampleRecord, NearestMotion
from solvers.search.synthesis import OUT_OF_TIME, Synthesis
from solvers.verifier.claims.bound_claims import gap_above, share_text
from solvers.verifier.claims.certificate import exact
from srgc.text_reports.nearest_motion import first_to_try, stuck_at
from srgc.text_reports.next_step import WHY, next_advice, next_command

# --- How much of its inputs a design uses, bound by bound -----------------------------------------


@dataclass(frozen=True, slots=True)
class UsedInputs:
    """Inputs that share a bound, with all figures in ``unit``.

    They lie between ``low`` and ``high``.  ``peak`` is the largest absolute value of one of them,
    or the largest norm if the norm is bounded.  ``margin`` is their distance from the bound,
    ``widest`` the largest possible distance.  ``effort``: whether they are efforts of joints.
    """

    name: str
    low: float
    high: float
    peak: float
    margin: float
    unit: str
    effort: bool
    widest: float


def used_inputs(
    model: RobotModel, task: ir.Task, inputs: Sequence[Sequence[str]]
) -> tuple[UsedInputs, ...]:
    """What a motion uses of each bound on its inputs, in the order of the bounds.

    Args:
        model: the robot.
        task: the task, which bounds its inputs.
        inputs: a row (m,) of decimals per step.
    """
    rows = np.array([[float(exact(text)) for text in row] for row in inputs])
    used = []
    for bound in input_bounds(model, task):
        values = rows[:, list(bound.inputs)]
        sizes = np.linalg.norm(values, axis=1) if bound.norm2 else np.abs(values)
        inner = sizes if bound.norm2 else values
        below, above = inner.min() - float(bound.lower), float(bound.upper) - inner.max()
        used.append(
            UsedInputs(
                bound.name,
                float(values.min()),
                float(values.max()),
                float(sizes.max()),
                float(above if bound.norm2 else min(below, above)),
                bound.unit,
                bound.effort,
                float(bound.widest_margin),
            )
        )
    return tuple(used)


def robustness_text(
    used: Sequence[UsedInputs], write: Callable[[float, str], str] | None = None
) -> str:
    """The least margin as a share of the widest possible one, and the margins in each unit.

    ``write`` formats a number with its unit; the default is plain text.
    """
    write = write or amount
    counted = [each for each in used if each.widest > 0]
    if not counted:
        return "none, no input has a choice"
    share = min(each.margin / each.widest for each in counted)
    least = dict[str, UsedInputs]()
    for each in sorted(counted, key=lambda each: each.margin / each.widest):
        least.setdefault(each.unit, each)
    units = dict.fromkeys(each.unit for each in counted)
    amounts = ", ".join(write(least[unit].margin, unit) for unit in units)
    return f"{100 * share:.4g} % ({amounts})"


def amount(value: float, unit: str, digits: int = 4) -> str:
    """A number with ``digits`` significant digits and its unit; a dimensionless one has none."""
    return f"{value:.{digits}g}{'' if unit == '1' else ' ' + unit}"


# --- What a design changes in the existing robot of its task, as text -----------------------------


def change_of(program: ir.Program, task: ir.Task, design: Design | None) -> Reconfiguration | None:
    """The reconfiguration from a task's existing robot to a design; None if either is missing."""
    if design is None or task.origin is None:
        return None
    rules = family_of(program, task).language.srg
    return reconfiguration(rules, task.origin.word, design.derivation.word)


def change_lines(change: Reconfiguration) -> list[str]:
    """The number of modules that change, and the intermediate configurations."""
    words = [" ".join(word) for word in change.configurations]
    if len(words) == 1:
        return ["change:  none, this is the existing robot"]
    added, removed = len(change.aligned.added), len(change.aligned.removed)
    edges = "" if added or removed else ", other edges"
    many = "module" if added == 1 else "modules"
    first = f"change:  {added} {many} added, {removed} removed{edges}"
    return [first, *(f"         {step}: {word}" for step, word in enumerate(words))]


# --- The outcome of a synthesis as plain text -----------------------------------------------------

FRICTION_UNUSED = "motions that dry friction alone holds or brakes were not looked for"
"""The remark about a robot with dry friction that is undecided."""
MORE_EFFORT = "which may use more effort than planned: see `srgc verify`"
"""The remark about feedback against disturbances."""
UNASKED_SELF = "self-collision was not asked for (`avoid self with body;`)"
"""The remark about a task that lets a robot pass through itself."""

NOT_HELD_FIRST = (
    "the drives cannot hold it where it begins: `start in R at rest held` would ask for that"
)
"""The remark about a motion whose start the drives cannot hold against gravity."""
NOT_HELD = "the drives cannot hold it there: `at rest for 1 s` would ask for that"
"""The remark about a motion whose end the drives cannot hold against gravity."""


def _winding(turns: Sequence[int]) -> Iterator[str]:
    """The joints that turn by whole revolutions in a round, with their numbers of turns."""
    for number, turn in enumerate(turns, 1):
        if turn:
            times = "once" if abs(turn) == 1 else f"{abs(turn)} times"
            yield f"; joint {number} turns {times} a round"


def _control(design: Design, task: ir.Task) -> str:
    if design.controller is None:
        return "open loop"
    more = "" if task.robust is None else f", {MORE_EFFORT}"
    return f"feedback{more}"


def _inputs(design: Design, task: ir.Task) -> Iterator[str]:
    """What the motion uses of each bound on its inputs, and the robustness."""
    used = used_inputs(design.model, task, design.inputs)
    for each in used:
        if each.effort:
            of = each.name.removeprefix("effort").removeprefix(" of ")
            whose = f"{of}, " if of else ""
            yield f"effort:  {whose}peak {each.peak:.4g} of {amount(each.widest, each.unit)}"
        else:
            name = each.name.removeprefix("input ")
            yield f"input:   {name} {each.low:.4g} to {amount(each.high, each.unit)}"
    if used:
        yield f"robustness: {robustness_text(used)}"
    else:
        yield "effort:  none, no joint is driven"


def _nearest(nearest: NearestMotion, task: ir.Task) -> Iterator[str]:
    """The motion that came nearest to a design, and where it is stuck."""
    stuck = stuck_at(nearest, task)
    where = ""
    if stuck is not None:
        place = ", ".join(f"{value:.3g}" for value in stuck.position)
        where = f", stuck at {stuck.time:g} s at ({place}) m"
    yield f"nearest: {' '.join(nearest.derivation.word)}{where}: {nearest.cause.value}"
    if nearest.text:
        yield f"         {nearest.text.removeprefix('; ').removeprefix('nearest, ')}"
    if dry_friction(nearest.model):
        yield f"         {FRICTION_UNUSED}"


def _design(design: Design, task: ir.Task, change: Reconfiguration | None) -> list[str]:
    """The robot that was found, and what its motion uses."""
    lines = [f"robot:   {' '.join(design.derivation.word)}"]
    for value in design.parameters:
        p, shown = value.parameter, amount(float(value), value.parameter.unit, 5)
        lines.append(f"         {p.module}.{p.name} = {shown} (symbol {p.symbol})")
    if change is not None:
        lines += change_lines(change)
    steps = len(design.inputs)
    if task.at_most:
        lines.append(f"motion:  {float(steps * task.step):g} s, {steps_taken(steps, task)}")
    lines += _inputs(design, task)
    if robot_inputs(design.model):
        lines.append(f"control: {_control(design, task)}")
    if design.loop is not None:
        begins, ends = (float(k * task.step) for k in (design.loop.first, steps))
        winding = "".join(_winding(design.loop.turns or ()))
        again = f"from {begins:g} s to {ends:g} s again and again, for ever{winding}"
        lines.append(f"repeats: {again}")
    lines += [
        f"formula: {condition.name}, robustness {condition.margin:.4g} m"
        for condition in design.conditions
        if condition.clause is not None
    ]
    if design.held_at_start is False:
        lines.append(f"start:   {NOT_HELD_FIRST}")
    if design.held_at_end is False:
        lines.append(f"end:     {NOT_HELD}")
    if task.avoid_self is None:
        lines.append(f"self:    {UNASKED_SELF}")
    if design.model.removed:
        gone = ", ".join(str(symbol) for symbol in design.model.removed)
        lines.append(f"removed: joints that move nothing (symbols {gone})")
    return lines


def steps_taken(steps: int, task: ir.Task) -> str:
    """The number of steps of a motion, out of those that the task allows."""
    return f"{steps} of at most {counted(task.steps, 'step')}"


def _bound(result: Synthesis, design: Design, task: ir.Task) -> Iterator[str]:
    """The bound that no robot exceeds, if it was asked for, and the gap from design to bound."""
    if result.unbounded is not None:
        yield f"bound:   none was proved: {result.unbounded}"
    if result.bound is None:
        return
    gap = gap_above(result.bound.share, robustness_share(design, task))
    shown = "" if gap is None else f" (gap {gap_text(gap)})"
    ended = f"; {result.ended}" if result.ended else ""
    yield f"bound:   {share_text(result.bound.share, result.bound.evidence.modules)}{shown}{ended}"


def _search_of_least(result: Synthesis, *, ended: bool) -> Iterator[str]:
    """Why no bound on the time was proved, and if asked, what ended the search for the least."""
    if result.optimality is None:
        return
    if result.optimality.untimed is not None:
        yield f"time:    no bound was proved: {result.optimality.untimed}"
    if ended and result.ended:
        yield f"ended:   {result.ended}"
    free = result.design is not None and bool(result.design.model.parameters)
    if (advice := gap_advice(result.optimality, free=free)) is not None:
        yield f"gap:     {advice}"


def gap_advice(found: Optimality, *, free: bool) -> str | None:
    """What may bring a design and the bound on all robots closer; None if nothing is known.

    ``free`` says whether the design has parameters. The search for bounds leaves gaps of up to
    1 / ``CLOSELY`` anyway.
    """
    known = [each for each in found.objectives if each.amount.is_ordering]
    wide = [each for each in known if (each.gap or 0) > Fraction(1, CLOSELY)]
    said = list[str]()
    if any(each.undecided for each in wide):
        said.append("more `--paths` or `--evaluations` may decide the undecided robots")
    if free and any(not each.amount.exact for each in wide):
        said.append("narrower ranges of parameters bring the bound closer")
        said.append("another `--seed` may find less")
    return "; ".join(said) or None


def objectives_text(result: Synthesis) -> str:
    """What is known about the objectives of a design, in words; "" without objectives."""
    return "" if result.optimality is None else result.optimality.text


def synthesis_text(
    result: Synthesis,
    task: ir.Task,
    folder: str,
    table: str = "",
    change: Reconfiguration | None = None,
) -> str:
    """The outcome of a synthesis in a few lines; the last one says what to do next.

    ``table`` is about all designs, ``change`` about the changes to the existing robot. After an
    ``impossible`` the last line is missing, because a conflict comes before it
    (``why_report.ending``).
    """
    reason = result.reason or objectives_text(result)
    lines = [f"verdict: {result.verdict}" + (f" ({reason})" if reason else "")]
    design = result.design
    if design is not None:
        lines += _design(design, task, change)
        lines += _bound(result, design, task)
        lines += _search_of_least(result, ended=not table)
    elif result.nearest is not None:
        lines += _nearest(result.nearest, task)
    refuted = sum(1 for r in result.records if r.verdict == "refuted")
    same = sum(1 for r in result.records if r.same_robot_as is not None)
    undecided = sum(1 for r in result.records if r.verdict in ("unresolved", "inadmissible"))
    lines.append(
        f"tried:   {counted(len(result.records), 'structure')}, "
        f"{counted(refuted, 'robot')} refuted, {counted(same, 'duplicate')}"
        + (f", {undecided} undecided" if undecided and design is not None else "")
        + (f", {counted(len(result.lemmas), 'lemma')}" if result.lemmas else "")
    )
    if result.counterexamples:
        lines.append(f"paths:   {counterexamples_text(result.counterexamples)}")
    if table:
        lines.append(f"designs: {len(result.designs)}\n{table}")
    lines.append(f"results: {folder}")
    if design is not None and result.unfinished and result.ended is None:
        lines.append(
            f"         {OUT_OF_TIME} before it was improved or drawn: the same command goes on"
        )
    if result.verdict != "impossible":
        lines.append(after_synthesis(result, task, folder))
    return "\n".join(lines)


def counterexamples_text(found: Sequence[CounterExampleRecord]) -> str:
    """How many paths were not followed, the few cells that prove it, and the paths each defers."""
    cells, length, deferred = (
        between(values)
        for values in (
            [len(each.cells) for each in found],
            [each.length for each in found],
            [each.deferred for each in found],
        )
    )
    return (
        f"{counted(len(found), 'counterexample')}, {cells} cells of {length}, "
        f"{deferred} paths deferred by each"
    )


def between(values: Sequence[int]) -> str:
    """The least and the greatest of some numbers, or one number if they are equal."""
    least, most = min(values), max(values)
    return f"{least}" if least == most else f"{least} to {most}"


# --- The next step --------------------------------------------------------------------------------

GO_ON = "run the same command again to continue"


def after_synthesis(result: Synthesis, task: ir.Task, folder: str) -> str:
    """The line about the next step, for results in a folder."""
    if result.verdict == "found":
        return next_command("srgc verify", folder)
    advice = _advice(result, task) if result.verdict == "unknown" else None
    if advice is None:
        return next_command("srgc why", folder, WHY)
    return next_advice(advice, "srgc why", folder)


def _advice(result: Synthesis, task: ir.Task) -> str | None:
    """What to try after *unknown*, depending on what ended the search; None if nothing is known."""
    nearest = None if result.nearest is None else first_to_try(result.nearest)
    first = None if nearest is None else f"try {nearest}"
    if result.unfinished:
        return GO_ON if first is None else f"{first}; or {GO_ON}"
    if Exhaustion.APART.value in (result.reason or "") and (walls := _passed_by_effectors(task)):
        return f"add `avoid {', '.join(walls)} with effector;`: that may be impossible"
    unbounded = task.modules is None and nearest is None
    refuted = all(record.verdict in ("refuted", "same") for record in result.records)
    return "try `modules <= n;` in the task" if unbounded and refuted else first


def _passed_by_effectors(task: ir.Task) -> list[str]:
    """The regions that bodies avoid, where nothing is said of effectors without a body there."""
    apart = {name for item in task.avoid if item.subject == "effector" for name in item.regions}
    bodies = (name for item in task.avoid if item.subject == "body" for name in item.regions)
    return [name for name in dict.fromkeys(bodies) if name not in apart]
