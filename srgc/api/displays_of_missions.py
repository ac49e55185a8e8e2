"""What the result of a mission shows in a notebook, and as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from grammar_lang.diagnostics.wording import counted
from srgc.api.displays import conditions_table
from srgc.render.html_text import block, code, details, head, image, lines, number, table, text

if TYPE_CHECKING:
    from solvers.verifier.report import Report

MOST_PICTURES = 6
"""So many tasks are shown with their pictures."""
_COLOURS = {"found": "good", "impossible": "bad"}


def mission_lines(design: Mapping[str, Any]) -> Iterator[str]:
    """The outcome in a few lines."""
    yield f"verdict:     {design['verdict']}"
    if design["reason"] is not None:
        yield f"reason:      {design['reason']}"
    for name, said in _facts(design):
        yield f"{name + ':':<12} {said}"
    width = max((len(each["task"]) for each in design["robots"]), default=0)
    for each in design["robots"]:
        yield f"  {each['task']:<{width}}  {' '.join(each['word'])}{_step(each)}"


def _facts(design: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    if design["cost"] is not None:
        yield "changes", f"{design['cost']:g}, proved least {design['least']:g}"
    for each in design["objectives"]:
        name = each["objective"].removeprefix("sum(").removesuffix(")")
        yield name, f"{each['value']:g} {each['unit']}".rstrip() + f", proved {each['least']:g}"
    for each in design["differs"]:
        yield "differs", f"module {each['module']} ({', '.join(each['what'])})"
    if design["undecided"]:
        yield "undecided", counted(design["undecided"], "robot")
    if design.get("try_first") is not None:
        yield "try first", design["try_first"]


def _step(robot: Mapping[str, Any]) -> str:
    """What is changed before a robot, in brief."""
    changes = robot["changes"]
    if changes is None:
        return ""
    counts = [(len(changes[name]), name) for name in ("removed", "added", "changed")]
    said = ", ".join(f"{count} {name}" for count, name in counts if count)
    return f"  ({said or 'nothing changed'}: {changes['cost']:g})"


def mission_html(folder: Path, design: Mapping[str, Any], report: Report | None) -> str:
    """The same as a display; ``report`` is what the verifier has said of the mission."""
    verdict = str(design["verdict"])
    rows = [(text(name), text(said)) for name, said in _facts(design)]
    if design["reason"] is not None:
        rows.insert(0, ("reason", text(design["reason"])))
    robots = [
        [text(each["task"]), code(" ".join(each["word"])), text(_changed(each)), _left(each)]
        for each in design["robots"]
    ]
    checked = lines("not verified yet")
    if report is not None:
        level = f", level {report.level}" if report.level else ""
        checked = lines(f"verified: {report.outcome.value}{level}") + conditions_table(report)
    return block(
        head(f"mission {design['mission']}", verdict, _COLOURS.get(verdict, "open")),
        table(("", ""), rows),
        table(("task", "robot", "changes", "robustness"), robots, (3,)) if robots else "",
        checked,
        _pictures(folder, design),
    )


def _changed(robot: Mapping[str, Any]) -> str:
    return _step(robot).strip().removeprefix("(").removesuffix(")")


def _left(robot: Mapping[str, Any]) -> str:
    return text(number(float(robot["robustness"])))


def _pictures(folder: Path, design: Mapping[str, Any]) -> str:
    """The motions of the first tasks, closed until they are asked for."""
    shown = []
    for each in design["robots"][:MOST_PICTURES]:
        picture = folder / "tasks" / each["task"] / "figures" / "workspace.svg"
        if picture.is_file():
            drawn = image(picture.read_text(encoding="utf-8"), f"the motion for {each['task']}")
            shown.append(details(each["task"], drawn))
    return "".join(shown)
