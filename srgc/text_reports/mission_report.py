"""A mission as plain text: its verdict, its robots in order, and the changes between them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from fractions import Fraction

from compiler.expressions.exact_numbers import exact_text
from compiler.missions.module_differences import ModuleDifference
from compiler.missions.robot_changes import Changes
from compiler.objectives.objective_text import amount_text, value_text
from grammar_lang import ir
from grammar_lang.diagnostics.wording import counted
from grammar_lang.files.file_tree import visible
from solvers.missions.mission_result import Existing, MissionResult
from solvers.search.path_task import Design
from solvers.verifier.missions.mission_check import MissionReport
from srgc.text_reports.next_step import WHY_MISSION, next_advice, next_command
from srgc.text_reports.verification_report import (
    answer,
    detail_lines,
    verification_json,
)


def mission_text(
    result: MissionResult, folder: str, program: ir.Program, notes: Sequence[str] = ()
) -> str:
    """The result of a search, and where it was written.

    Args:
        result: the result.
        folder: its folder.
        program: the program of the mission.
        notes: further lines.
    """
    last = [f"written to {folder}", after_mission(result, folder)]
    return "\n".join([*_lines(result, program), *notes, *last])


def difference_text(difference: ModuleDifference, folder: str, spec: str) -> str:
    """A note that a module of the robot of a folder differs from the spec's."""
    return visible(
        f"note: module {difference.module} differs from that of {folder} "
        f"({', '.join(difference.what)}): it is now as {spec} says"
    )


def _lines(result: MissionResult, program: ir.Program) -> Iterator[str]:
    name = result.mission.name
    if result.verdict != "found":
        yield f"verdict: {result.verdict} (mission {name}: {result.reason})"
        return
    one = result.mission.prices is None
    yield f"verdict: found (mission {name}: {_claim(result)})"
    if one:
        yield f"  {_robot(result, 0)}"
        yield f"  does {', '.join(result.mission.tasks)}"
        return
    before = None if result.existing is None else result.existing.word
    labels = [] if result.existing is None else existing_labels(result.existing, program)
    width = max(map(len, result.mission.tasks))
    if before is not None:
        yield f"  {'':{width}}  {' '.join(before)}  (there before)"
    for number, task in enumerate(result.mission.tasks):
        step = result.steps[number]
        if step is not None and before is not None:
            after = design_labels(result.designs[number], program)
            yield f"  {'':{width}}    {step_text(step, labels, after)}"
        yield f"  {task:<{width}}  {_robot(result, number)}"
        before = result.designs[number].derivation.word
        labels = design_labels(result.designs[number], program)


def after_mission(result: MissionResult, folder: str) -> str:
    """The line about the next step, for results in a folder."""
    if result.verdict == "found":
        return next_command("srgc verify", folder)
    if result.ended is not None:
        return next_advice(f"try {result.ended.try_first}", "srgc why", folder)
    return next_command("srgc why", folder, WHY_MISSION)


def _claim(result: MissionResult) -> str:
    """The cost of the changes or the values of the objectives, and what is proved about them."""
    if result.mission.prices is None:
        values = [
            amount_text(each.objective, each.value)
            + _least(each.value, each.least, value_text(each.objective, each.least))
            for each in result.values
        ]
        said = ["one robot", *values]
    else:
        cost, least = result.cost or Fraction(0), result.least or Fraction(0)
        said = [f"changes {exact_text(cost)}" + _least(cost, least, exact_text(least))]
    if result.undecided:
        said.append(f"{counted(result.undecided, 'robot')} undecided")
    return "; ".join(said)


def _least(value: Fraction, least: Fraction, text: str) -> str:
    if least == value:
        return ", proved least"
    return f", none less than {text}" if least > 0 else ", not proved least"


def _robot(result: MissionResult, number: int) -> str:
    """The word of a robot with its parameters."""
    design = result.designs[number]
    values = ", ".join(
        f"{p.parameter.module}.{p.parameter.name} = {float(p):.4g} {p.parameter.unit}".removesuffix(
            " 1"
        ).rstrip()
        for p in design.parameters
    )
    word = " ".join(design.derivation.word)
    return f"{word}  ({values})" if values else word


def step_text(step: Changes, old: Sequence[str], new: Sequence[str]) -> str:
    """The changes of a step, in words.

    Args:
        step: the changes.
        old: the labels of the old robot's modules, in order.
        new: the labels of the new robot's modules, in order.
    """
    parts = []
    if step.removed:
        parts.append(f"remove {', '.join(old[i] for i in step.removed)}")
    if step.added:
        parts.append(f"add {', '.join(new[j] for j in step.added)}")
    for i, j, name in step.changed:
        parts.append(f"change {name} of {old[i]} to that of {new[j]}")
    return f"{'; '.join(parts) or 'nothing is changed'}: {exact_text(step.cost)}"


def design_labels(design: Design, program: ir.Program) -> list[str]:
    """The labels of a design's modules: their names, with the values of their parameters."""
    values: dict[int, list[str]] = {}
    for each in design.parameters:
        unit = "" if each.parameter.unit == "1" else f" {each.parameter.unit}"
        values.setdefault(each.parameter.symbol, []).append(f"{float(each):.4g}{unit}")
    return [
        f"{symbol} ({', '.join(values[index])})" if index in values else symbol
        for index, symbol in enumerate(design.derivation.word)
        if symbol in program.modules
    ]


def existing_labels(existing: Existing, program: ir.Program) -> list[str]:
    """The labels of the existing robot's modules: their names, with their parameter values."""
    found = []
    for module in existing.robot:
        units = {each.name: each.unit for each in program.modules[module.name].parameters}
        known = [
            f"{float(ranges[0].low):.4g} {units.get(name, '')}".removesuffix(" 1").rstrip()
            for name, ranges in module.values.items()
        ]
        found.append(f"{module.name} ({', '.join(known)})" if known else module.name)
    return found


# --- The verifier's report on a mission -----------------------------------------------------------


def mission_check_text(report: MissionReport) -> str:
    """The verifier's answer about a mission, then about each of its designs."""
    lines = [answer(report.report)]
    if report.mission is not None:
        lines.append(f"mission: {visible(report.mission)}")
    lines += detail_lines(report.report)
    lines += [f"  task {visible(task)}: {answer(own)}" for task, own in report.tasks]
    return "\n".join(lines)


def mission_check_json(report: MissionReport) -> str:
    """The verifier's answer about a mission as JSON."""
    content = json.loads(verification_json(report.report))
    del content["task"]
    content["mission"] = report.mission
    content["tasks"] = {task: json.loads(verification_json(own)) for task, own in report.tasks}
    return json.dumps(content, indent=1, ensure_ascii=False)
