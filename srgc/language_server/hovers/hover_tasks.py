"""Tasks and missions in words, as Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text
from srgc.language_server.hovers.production_physics import rounded


def task_text(task: ir.Task) -> str:
    """What a task asks for."""
    end = rounded(float(task.steps * task.step))
    step = rounded(float(task.step))
    lines = [
        f"A task for robots of `{task.grammar}` in `{task.workspace}`.",
        "",
        f"- horizon: at most {task.steps} steps of {step} s, {end} s"
        if task.at_most
        else f"- horizon: {task.steps} steps of {step} s, T = {end} s",
        *_least(task.minimize),
    ]
    for effort in task.effort:
        unit = "N*m" if effort.kind == "revolute" else "N"
        norm = " (Euclidean norm)" if effort.norm2 else ""
        bound = f"{number_text(effort.bound)} {unit}{norm}"
        lines.append(f"- effort of {effort.kind} joints: at most {bound}")
    if task.modules is not None:
        lines.append(f"- at most {task.modules} modules")
    if any(task.gravity):
        gravity = ", ".join(number_text(each) for each in task.gravity)
        lines.append(f"- gravity: ({gravity}) m/s^2")
    if task.control is not None:
        lines.append(f"- control: {task.control}")
    if task.repeat:
        lines.append("- goes on for ever")
    return "\n".join(lines)


def mission_text(mission: ir.Mission, program: ir.Program) -> str:
    """What a mission asks for, with its tasks one by one."""
    grammar = program.tasks[mission.tasks[0]].grammar
    who = "one robot does" if mission.prices is None else "robots that are rebuilt do"
    what = "this task" if len(mission.tasks) == 1 else "these tasks"
    lines = [f"A mission for robots of `{grammar}`: {who} {what}.", ""]
    for number, name in enumerate(mission.tasks, 1):
        lines.append(f"{number}. `{name}` in `{program.tasks[name].workspace}`")
    about = [*_costs(mission), *_least(mission.minimize)]
    return "\n".join([*lines, "", *about] if about else lines)


def _costs(mission: ir.Mission) -> Iterator[str]:
    """The prices of changes, if changes are allowed."""
    prices = mission.prices
    if prices is None:
        return
    added, removed = number_text(prices.add), number_text(prices.remove)
    yield f"- a module that is added costs {added}, one that is removed {removed}"
    if mission.free:
        names = ", ".join(f"`{module}.{name}`" for module, name in sorted(mission.free))
        yield f"- free to change, each time for {number_text(prices.change)}: {names}"
    if mission.most is not None:
        yield f"- all changes together cost at most {number_text(mission.most)}"


def _least(objectives: tuple[ir.Objective, ...]) -> Iterator[str]:
    if objectives:
        yield f"- minimizes {' then '.join(map(_objective, objectives))}"


def _objective(objective: ir.Objective) -> str:
    name = f"`{objective.kind}`"
    if objective.attribute is not None:
        name = f"`sum({objective.attribute})`"
    within = objective.within
    return f"{name} within {number_text(100 * within)} %" if within else name
