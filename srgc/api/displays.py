"""What the objects of the Python interface show in a notebook, and as text.

Each display loads what it needs when it is asked for.
"""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from grammar_lang.diagnostics.wording import counted
from srgc.faults import MOST_FINDINGS, Checked, UsageFault
from srgc.render.html_text import (
    block,
    code,
    coloured,
    details,
    head,
    image,
    lines,
    number,
    table,
    text,
    with_unit,
)

if TYPE_CHECKING:
    from compiler.arrays import Array
    from compiler.views.workspace_view import Picture
    from grammar_lang import ir
    from solvers.explanation.explanation import Explanation
    from solvers.verifier.proofs.checked_condition import CheckedCondition
    from solvers.verifier.report import Report
    from srgc.chosen_robot import ChosenRobot
    from srgc.text_reports.plan_report import PlanReport
    from srgc.text_reports.synthesis_report import UsedInputs

HEIGHT = 640
"""Of the frame of a report."""
MOST_DRAWN = 400
"""Graphs with more nodes are shown as tables: a picture of them helps nobody."""
MOST_ROWS = 200
_COLOURS = {
    "found": "good", "impossible": "bad",
    "valid": "good", "refuted": "bad",
    "holds": "good", "fails": "bad", "undecided": "open",
}  # fmt: skip
"""Of verdicts, of what a verifier says, and of single conditions."""


# --- results --------------------------------------------------------------------------------------


def result_text(design: Mapping[str, Any], used: Sequence[UsedInputs]) -> str:
    """The outcome in a few lines; ``used``: what a motion uses of its inputs."""
    facts = _facts(design, used)
    rows = [("verdict", str(design["verdict"])), *facts, ("tried", _tried(design))]
    return "\n".join(f"{name + ':':<12} {said}" for name, said in rows)


def result_html(
    folder: Path, design: Mapping[str, Any], used: Sequence[UsedInputs], report: Report | None
) -> str:
    """The same as a display; ``report`` is what the verifier has said of the outcome."""
    verdict = str(design["verdict"])
    rows = [
        (text(name), code(said) if name == "robot" else text(said))
        for name, said in _facts(design, used)
    ]
    rows.append(("tried", text(_tried(design))))
    picture = folder / "figures" / "workspace.svg"
    shown = ""
    if design["word"] is not None and picture.is_file():
        shown = image(picture.read_text(encoding="utf-8"), "the motion of the robot")
    checked = lines("not verified yet") if report is None else _checked(report)
    return block(
        head(f"task {design['task']}", verdict, _COLOURS.get(verdict, "open")),
        f'<div class="side"><div>{table(("", ""), rows)}{checked}</div>{shown}</div>',
    )


def _checked(report: Report) -> str:
    level = f", level {report.level}" if report.level else ""
    return lines(f"verified: {report.outcome.value}{level}") + conditions_table(report)


def _facts(design: Mapping[str, Any], used: Sequence[UsedInputs]) -> Iterator[tuple[str, str]]:
    if design["reason"] is not None:
        yield "reason", str(design["reason"])
    if design["word"] is None:
        return
    yield "robot", " ".join(design["word"])
    for one in design["parameters"]:
        name = f"{one['symbol']}.{one['name']}"
        yield name, with_unit(float(one["value"]), str(one["unit"]), 6)
    from srgc.text_reports.synthesis_report import amount, robustness_text

    for each in used:
        name = "effort" if each.effort else each.name.removeprefix("input ")
        yield name, f"peak {each.peak:.4g} of {amount(each.widest, each.unit)}"
    if used:
        yield "robustness", robustness_text(used)
    if used and design.get("control") is not None:
        yield "control", str(design["control"])
    yield from _objectives(design)


def _objectives(design: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What the task asked to be least."""
    from srgc.results.stated_objectives import stated_objectives

    for place, each in enumerate(stated_objectives(design, Path("design.json"))):
        yield each.name, f"{each.amount(each.value)}; {each.claim(first=place == 0)}"


def _tried(design: Mapping[str, Any]) -> str:
    tried = design["structures_tried"]
    counts = Counter(
        "same" if one["same_robot_as"] is not None else one["verdict"] for one in tried
    )
    return (
        f"{counted(len(tried), 'structure')}, {counted(counts['refuted'], 'robot')} refuted, "
        f"{counted(counts['same'], 'duplicate')}"
    )


# --- programs -------------------------------------------------------------------------------------


def program_text(program: ir.Program) -> str:
    """What a specification declares, as plain text."""
    rows = [(kind, names, said) for kind, names, said in _declared(program)]
    return "\n".join(
        [
            program.sources[0].path,
            *(f"{kind:<10} {name:<14} {said}".rstrip() for kind, name, said in rows),
        ]
    )


def program_html(program: ir.Program) -> str:
    """A display of what a specification declares, and of its text."""
    rows = [(text(kind), code(name), text(said)) for kind, name, said in _declared(program)]
    files = "".join(
        details(source.path, coloured_source(source.text))
        for source in program.sources
        if source.text
    )
    return block(head(program.sources[0].path), table(("", "", ""), rows), files)


def _declared(program: ir.Program) -> Iterator[tuple[str, str, str]]:
    for module in program.modules.values():
        yield "module", module.name, _of_module(module)
    for grammar in program.grammars.values():
        count = len(grammar.productions)
        yield "grammar", grammar.name, f"{count} production{'' if count == 1 else 's'}"
    for place in program.workspaces.values():
        kinds = [f"{region.kind} {region.name}" for region in place.regions]
        plane = "plane" if place.dimension == 2 else "space"
        yield "workspace", place.name, f"{plane}: {', '.join(kinds) or 'no regions'}"
    for task in program.tasks.values():
        seconds = float(task.steps * task.step)
        most = "at most " if task.at_most else ""
        yield "task", task.name, f"{task.grammar} in {task.workspace}, {most}{seconds:g} s"
    for mission in program.missions.values():
        kind = "one robot" if mission.prices is None else "rebuilt robots"
        yield "mission", mission.name, f"{kind} for {', '.join(mission.tasks)}"


def _of_module(module: ir.Module) -> str:
    items: list[str] = [module.role]
    items += [f"{dof.kind} {dof.name}" for dof in module.dofs]
    items += [f"parameter {each.name}" for each in module.parameters]
    items += [f"state {each.name}" for each in module.states]
    items += [f"input {each.name}" for each in module.inputs]
    return ", ".join(items)


def coloured_source(content: str) -> str:
    """A text of the language in the colours of its words."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter

    from srgc.pygments_lexer import SrgLexer

    style = "background:#f8f8f8;color:#222;padding:.6em"
    formatter = HtmlFormatter(noclasses=True, nobackground=True, cssstyles=style)
    return str(highlight(content, SrgLexer(), formatter))


# --- findings and explanations --------------------------------------------------------------------


def findings_html(checked: Checked) -> str:
    """A display of findings, as ``srgc check`` prints them."""
    from grammar_lang.diagnostics.render import to_text
    from srgc.text_reports.findings_text import summary

    said = summary([checked])
    if not checked.diagnostics:
        return block(head(said, "✓", "good"))
    found = to_text(checked.diagnostics, checked.sources, colour=True, most=MOST_FINDINGS)
    mark = ("✓", "good") if checked.program is not None else ("✗", "bad")
    return block(head(said, *mark), coloured(found))


def explanation_html(found: Explanation) -> str:
    """A display of an explanation, as ``srgc why`` prints it."""
    from srgc.text_reports.why_report import why_text

    return block(coloured(why_text(found, colour=True)))


# --- graphs ---------------------------------------------------------------------------------------


def graph_text(picture: Picture) -> str:
    """The edges of a graph, one a line."""
    sign = "->" if picture.directed else "--"
    rows = [_line(tail, label, sign, head) for tail, label, head, _ in _rows(picture)]
    return "\n".join([_title(picture), *rows[:MOST_ROWS], *_left_out(rows), *picture.caption])


def graph_html(picture: Picture, remarks: Sequence[str] = ()) -> str:
    """A display of a graph."""
    drawn = _drawn(picture)
    if drawn is not None:
        return block(image(drawn, _title(picture)), lines(*remarks))
    rows = list(_rows(picture))
    cells = [[_cell(part, marked=marked) for part in parts] for *parts, marked in rows[:MOST_ROWS]]
    key = "→ where a run begins, ◎ where it may end" if picture.initial else ""
    return block(
        head(_title(picture)),
        table(("from", "label", "to"), cells),
        lines(*_left_out(rows), *filter(None, [key]), *picture.caption, *remarks),
    )


def _line(tail: str, label: str, sign: str, head: str) -> str:
    said = "; ".join(label.split("\n"))
    return f"{tail} {sign} {head}{': ' if said else ''}{said}" if head else tail


def _title(picture: Picture) -> str:
    nodes, edges = len(picture.nodes), len(picture.edges)
    return f"{picture.title or picture.name}: {nodes} nodes, {edges} edges"


def _rows(picture: Picture) -> Iterator[tuple[str, str, str, bool]]:
    """Tail, label and head of every edge, and whether it is highlighted.

    A node without edges has a row of its own.
    """
    initial = {arrow.head for arrow in picture.initial}
    names = {node.key: f"{node.label}{' ◎' if node.double else ''}" for node in picture.nodes}
    for edge in picture.edges:
        tail = f"{'→ ' if edge.tail in initial else ''}{names[edge.tail]}"
        yield tail, "\n".join(edge.lines), names[edge.head], edge.highlighted
    joined = {end for edge in picture.edges for end in (edge.tail, edge.head)}
    for node in picture.nodes:
        if node.key not in joined:
            start = "→ " if node.key in initial else ""
            yield f"{start}{names[node.key]}", "", "", node.highlighted


def _left_out(rows: Sequence[object]) -> list[str]:
    return [f"and {len(rows) - MOST_ROWS} more"] if len(rows) > MOST_ROWS else []


def _cell(content: str, *, marked: bool) -> str:
    shown = text(content).replace("\n", "<br>")
    return f'<span class="bad">{shown}</span>' if marked else shown


def _drawn(picture: Picture) -> str | None:
    """The picture as SVG; None where nothing draws it."""
    from compiler.views.dot import to_dot
    from srgc.graphs.graph_request import drawn_by_graphviz

    if shutil.which("dot") is None or len(picture.nodes) > MOST_DRAWN:
        return None
    try:
        return drawn_by_graphviz(to_dot(picture), "svg")[0].decode()
    except UsageFault:
        return None


# --- reports --------------------------------------------------------------------------------------


def page_frame(page: str) -> str:
    """A frame that holds the page; its scripts run, and can reach nothing outside of it."""
    return (
        f'<iframe title="report" sandbox="allow-scripts" width="100%" height="{HEIGHT}" '
        f'style="border:1px solid #8885;background:#fff" srcdoc="{escape(page)}"></iframe>'
    )


# --- plans ----------------------------------------------------------------------------------------


def plan_html(report: PlanReport, title: str) -> str:
    """A display of a plan."""
    mark = report.verdict, _COLOURS.get(report.verdict, "open")
    picture = image(report.picture(title), f"the cells of {report.workspace.name}")
    return block(head(title, *mark), f'<div class="side">{picture}{coloured(report.text)}</div>')


# --- robots ---------------------------------------------------------------------------------------


def robot_html(chosen: ChosenRobot, theta: Array) -> str:
    """A display of a robot with the parameters theta (p,), in SI units."""
    from srgc.render.pose_picture import pose_picture

    word = " ".join(chosen.word)
    picture = image(pose_picture(chosen.model, theta), f"the robot {word}")
    rows = table(("", "", "", "value"), _robot_rows(chosen, theta), (3,))
    title = f'<div class="strong">{code(word)}</div>'
    return block(
        title, f'<div class="side">{picture}<div>{rows}</div></div>', lines(*chosen.remarks)
    )


def _robot_rows(chosen: ChosenRobot, theta: Array) -> Iterator[list[str]]:
    """Coordinates, parameters with their values, inputs."""
    from compiler.descriptions.document import Entry
    from compiler.descriptions.model_formulas import robot_sections

    for section in robot_sections(chosen.model, chosen.word, chosen.task):
        if section.title not in ("Coordinates", "Parameters", "Inputs"):
            continue
        values: Iterator[float] = iter(theta.tolist() if section.title == "Parameters" else ())
        for item in section.items:
            if isinstance(item, Entry):
                value = next(values, None)
                shown = "" if value is None else number(float(value), 6)
                yield [code(item.symbol[0]), text(item.meaning), text(item.bounds), shown]


# --- verifications --------------------------------------------------------------------------------


def verification_html(report: Report, of_tasks: Sequence[tuple[str, Report]] = ()) -> str:
    """A display of the answer: what was claimed, and every condition with its margin.

    ``of_tasks`` has the answers on the designs of a mission, which are told of in a line each.
    """
    outcome = report.outcome.value
    level = f"level {report.level}" if report.level else ""
    said = ", ".join(filter(None, [report.verdict, level, report.reason]))
    tasks = [f"task {task}: {own.outcome.value}" for task, own in of_tasks]
    return block(
        head(said, outcome, _COLOURS.get(outcome, "open")), conditions_table(report), lines(*tasks)
    )


def conditions_table(report: Report) -> str:
    """The conditions in the order of ``srgc verify``; nothing without any."""
    from srgc.text_reports.verification_report import by_map, in_order

    rows = [_condition(condition) for condition in by_map(in_order(report.conditions))]
    names = ["", "condition", "margin", "time", "place", "how"]
    return table(names, rows, (2, 3)) if rows else ""


def _condition(condition: CheckedCondition) -> list[str]:
    status = condition.status.value
    mark = f'<span class="{_COLOURS[status]}">{text(status)}</span>'
    margin = with_unit(condition.least(4), condition.unit) if isfinite(condition.margin) else ""
    time = "" if condition.time is None else f"{number(condition.time)} s"
    place = ", ".join(number(x) for x in condition.place)
    level = condition.level if status == "holds" else ""
    return [mark, text(condition.name), text(margin), text(time), text(place), text(level)]
