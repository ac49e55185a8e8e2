"""Changes that weaken one line of a task as a whole, or that change no line.

The text ``says`` of a change describes the new task, mostly as "with ..." or "without ...".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import without
from solvers.explanation.task_line import TaskLine


@dataclass(frozen=True, slots=True)
class Change:
    """A weaker task: the changed line, the change in words, and its value if it has one.

    Changes of a line that differ only in their value have the same ``way``. Without a line the task
    is the same, and the search has ``budget`` times as much. If ``lines`` is 2, another line is
    changed together with ``line``.
    """

    line: TaskLine | None
    says: str
    posed: PosedTask
    value: Fraction | None = None
    way: str = ""
    budget: int = 1
    lines: int = 1


def single_changes(posed: PosedTask, line: TaskLine) -> Iterator[Change]:
    """The changes of a line without a value: parts and names of effectors are dropped."""
    for change in _single(posed, line):
        yield replace(change, way=change.says)


def _single(posed: PosedTask, line: TaskLine) -> Iterator[Change]:
    task = posed.task
    match line.kind:
        case "start" if isinstance(task.start, ir.StartIn):
            yield from _start(posed, task.start, line)
        case "reach" if task.reach is not None:
            yield from _reach(posed, task.reach, line)
        case "avoid":
            yield from _avoid(posed, line)
        case "avoid_self" if task.avoid_self is not None:
            if task.avoid_self.margin:
                touching = replace(task.avoid_self, margin=Fraction(0))
                says = "without the margin between bodies"
                yield Change(line, says, posed.with_task(avoid_self=touching))
            yield Change(line, "without `avoid self`", without(posed, [line]))
        case "satisfy" if task.reach is not None or len(task.satisfy) > 1:
            yield Change(line, "without this formula", without(posed, [line]))
        case "bounds_body" | "payload" | "carry":
            named = {"bounds_body": "`bounds with body`", "carry": "this load"}
            what = named.get(line.kind, "the payload")
            yield Change(line, f"without {what}", without(posed, [line]))
        case "joint_range":
            module, name = line.key
            says = f"without a limit of `{module}.{name}`"
            yield Change(line, says, without(posed, [line]))
        case "fixed":
            yield Change(line, f"with `{line.key[1]}` free", without(posed, [line]))
        case _:
            return


def _start(posed: PosedTask, start: ir.StartIn, line: TaskLine) -> Iterator[Change]:
    if start.held:
        falling = replace(start, held=False)
        yield Change(line, "without `held`", posed.with_task(start=falling))
    if start.effector is not None:
        anyone = replace(start, effector=None)
        says = f"with any effector starting in `{start.region}`"
        yield Change(line, says, posed.with_task(start=anyone))


def with_feedback(posed: PosedTask, line: TaskLine) -> Change:
    """Inputs follow measurements; everything else stays as before."""
    return Change(line, "with `control feedback`", posed.with_task(control="feedback"))


def with_shorter_steps(posed: PosedTask, line: TaskLine, parts: int) -> Change:
    """Each step is divided into ``parts``: feedback acts more often over the same time."""
    steps, step = parts * posed.task.steps, posed.task.step / parts
    length = number_text(step)
    # Without parentheses, a quotient would be read as that of a number and a time.
    of = f"({length})" if "/" in length else length
    says = f"with `horizon {at_most(posed)}{steps} steps of {of} s`"
    shorter = posed.with_task(steps=steps, step=step)
    return Change(line, says, shorter, Fraction(steps), "shorter")


def at_most(posed: PosedTask) -> str:
    """What precedes the steps of a horizon."""
    return "at most " if posed.task.at_most else ""


def with_fewer_steps(posed: PosedTask, line: TaskLine, steps: int) -> Change:
    """A shorter horizon: a long motion may sway."""
    return Change(
        line, f"with {steps} steps", posed.with_task(steps=steps), Fraction(steps), "fewer"
    )


def with_budget(posed: PosedTask, times: int, paths: int, evaluations: int) -> Change:
    """The same task with ``times`` the budgets of a structure and of a path."""
    says = f"with `--paths {times * paths} --evaluations {times * evaluations}`"
    return Change(None, says, posed, budget=times)


def _reach(posed: PosedTask, reach: ir.Reach, line: TaskLine) -> Iterator[Change]:
    if reach.effector is not None:
        anyone = posed.with_task(reach=replace(reach, effector=None))
        yield Change(line, f"with any effector ending in `{reach.region}`", anyone)
    if reach.poses:
        turned = posed.with_task(reach=replace(reach, poses=()))
        yield Change(line, f"turned in any way in `{reach.region}`", turned)
    if reach.rates is not None:
        rest = reach.rates.bound == ir.REST_RATE
        bound = "at rest" if rest else f"rates <= {number_text(reach.rates.bound)}"
        if reach.rates.duration:
            brief = replace(reach.rates, duration=Fraction(0))
            says = f"with `{bound}` at the last instant alone"
            yield Change(line, says, posed.with_task(reach=replace(reach, rates=brief)))
        moving = posed.with_task(reach=replace(reach, rates=None))
        yield Change(line, f"without `{bound}` at the end", moving)


def _avoid(posed: PosedTask, line: TaskLine) -> Iterator[Change]:
    """Without the margin, for the effector alone, or without the region."""
    index, region = int(line.key[0]), str(line.key[1])
    clauses = posed.task.avoid
    clause = clauses[index]

    def with_clause(changed: ir.Avoid) -> PosedTask:
        return posed.with_task(avoid=(*clauses[:index], changed, *clauses[index + 1 :]))

    if clause.margin:
        yield Change(line, "without the margin", with_clause(replace(clause, margin=Fraction(0))))
    if clause.subject == "body":
        alone = with_clause(replace(clause, subject="effector"))
        yield Change(line, f"with `{region}` avoided by effectors alone", alone)
    yield Change(line, f"without avoiding `{region}`", without(posed, [line]))
