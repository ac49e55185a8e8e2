"""The robots of a mission: each is drawn, with what is added, removed, kept and changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from compiler.expressions.exact_numbers import exact_text
from compiler.missions.robot_changes import Changes
from compiler.robots.frame_table import SemanticsError
from grammar_lang import ir
from srgc.render.html_text import many, text, with_unit
from srgc.render.module_drawing import ModuleDrawing, module_drawing
from srgc.render.module_marks import marked_robot
from srgc.render.module_picture import SIGNS, robot_picture, signs_of
from srgc.report.missions.line_of_robots import StandingRobot, module_places
from srgc.report.missions.mission_evidence import MissionEvidence

if TYPE_CHECKING:
    from srgc.results.mission_folder import MissionFolder

Modules = Mapping[str, ir.Module]
CARD = 330.0
"""The width of the picture of a robot."""
MOST_DRAWN = 12
"""The number of robots to draw; the table has all of them."""


def robots_section(evidence: MissionEvidence) -> str:
    """The section of the page; empty if there is no robot at all."""
    line = evidence.line
    if not line:
        return ""
    drawings = [_drawing(evidence.mission, robot) for robot in line[:MOST_DRAWN]]
    cards = "".join(
        _card(evidence, number, drawing, [each for each in drawings if each is not None])
        for number, drawing in enumerate(drawings)
    )
    left = len(line) - MOST_DRAWN
    more = f"<p>{many(left, 'more robot')} of the line are in the table.</p>" if left > 0 else ""
    title = "The line of robots"
    if len(line) == 1:
        title = "The robot" if line[0].tasks else "The robot before"
    return (
        f'<section id="robots"><h2>{title}</h2>{_legend(evidence)}'
        f'<ol class="line">{cards}</ol>{more}{_table(evidence)}</section>'
    )


def _legend(evidence: MissionEvidence) -> str:
    said = (
        "Drawn with their real lengths, all to one scale, in poses that show all modules and are "
        "not those of the tasks. A name consists of the module and its place in the word, counted "
        "from 0."
    )
    if len(evidence.line) == 1:
        return f"<p>{said}</p>"
    return (
        f'<p>{said}</p><ul class="legend">'
        f'<li><span class="mark added">{SIGNS["added"]}</span> added before the task, drawn with a '
        "margin</li>"
        f'<li><span class="mark removed">{SIGNS["removed"]}</span> removed after it, drawn dashed'
        "</li>"
        f'<li><span class="mark changed">{SIGNS["changed"]}</span> a parameter changed before it'
        '</li><li><span class="mark">&#160;</span> without a sign: kept</li></ul>'
    )


def _drawing(mission: MissionFolder, robot: StandingRobot) -> ModuleDrawing | None:
    if robot.derivation is None or robot.model is None:
        return None
    program = mission.program
    grammar = program.grammars[program.tasks[mission.mission.tasks[0]].grammar]
    try:
        marked = marked_robot(grammar, program.modules, robot.derivation, robot.model.dimension)
    except SemanticsError:
        return None
    return module_drawing(marked, robot.word, dict(program.modules), robot.theta)


def _card(
    evidence: MissionEvidence,
    number: int,
    drawing: ModuleDrawing | None,
    beside: Sequence[ModuleDrawing],
) -> str:
    robot = evidence.line[number]
    modules = evidence.mission.program.modules
    picture = "<p>It cannot be built as the specification is now, and is not drawn.</p>"
    if drawing is not None:
        picture = robot_picture(drawing, _values(robot), robot.fates, beside, CARD)
    return (
        f"<li>{_step(evidence, robot, modules)}<h3>{_title(robot)}</h3>"
        f"<figure>{picture}</figure>{_chips(robot, modules)}</li>"
    )


def _title(robot: StandingRobot) -> str:
    if not robot.tasks:
        return "There before"
    return f"For {', '.join(text(task) for task in robot.tasks)}"


def _step(evidence: MissionEvidence, robot: StandingRobot, modules: Modules) -> str:
    """The changes before a robot, and their cost."""
    if robot.step is None:
        if evidence.mission.mission.prices is None:
            return ""
        said = (
            "the existing robot"
            if not robot.tasks
            else "the first robot; to build it costs nothing"
        )
        return f'<p class="step">{said}</p>'
    parts = [text(part) for part in change_words(robot.step, robot.earlier, robot.word, modules)]
    kept = many(len(robot.step.kept), "module")
    return (
        f'<p class="step"><span aria-hidden="true">→</span> {"; ".join(parts) or "no change"}; '
        f"{kept} kept: <b>cost {exact_text(robot.step.cost)}</b></p>"
    )


def change_words(
    step: Changes, old: Sequence[str], new: Sequence[str], modules: Modules
) -> Iterator[str]:
    """What is removed, added and changed, with the places in the words."""
    before, after = module_places(old, modules), module_places(new, modules)
    if step.removed:
        yield f"{SIGNS['removed']} {_named(old, (before[i] for i in step.removed))}"
    if step.added:
        yield f"{SIGNS['added']} {_named(new, (after[j] for j in step.added))}"
    for _, j, name in step.changed:
        yield f"{SIGNS['changed']} {new[after[j]]} {after[j]}.{name}"


def _named(word: Sequence[str], places: Iterable[int]) -> str:
    return ", ".join(f"{word[place]} {place}" for place in places)


def _values(robot: StandingRobot) -> dict[int, list[str]]:
    """By place in the word, the values of its parameters; unknown ones are omitted."""
    found: dict[int, list[str]] = {}
    for parameter, value in robot.known:
        found.setdefault(parameter.symbol, []).append(with_unit(value, parameter.unit))
    return found


def _chips(robot: StandingRobot, modules: Modules) -> str:
    """The word, with the signs of what happens to its modules."""
    chips = []
    for place, name in enumerate(robot.word):
        if name not in modules:
            chips.append(f'<li class="edge">{text(name)}</li>')
            continue
        fates = robot.fates.get(place, frozenset())
        sign = f"<b>{signs_of(fates)}</b> " if fates else ""
        kind = " ".join(["chip", modules[name].role, *sorted(fates)])
        chips.append(f'<li class="{kind}">{sign}{text(name)}<sub>{place}</sub></li>')
    return f'<ol class="chips" aria-label="The word">{"".join(chips)}</ol>'


# --- The table ------------------------------------------------------------------------------------

HEADS = ("robot for", "word", "removed", "added", "changed", "kept", "cost", "in all")
FIGURES = HEADS[5:]
"""Columns of numbers."""


def _table(evidence: MissionEvidence) -> str:
    """All robots with the changes before each; empty without prices, or if no robot was found."""
    if evidence.mission.mission.prices is None or not evidence.tasks:
        return ""
    total, rows = Fraction(0), []
    for robot in evidence.line:
        total += Fraction(0) if robot.step is None else robot.step.cost
        cells = _changed_cells(robot, evidence.mission.program.modules)
        spent = "" if robot.step is None else exact_text(robot.step.cost)
        name = ", ".join(robot.tasks) or "there before"
        rows.append(
            f'<tr><th scope="row">{text(name)}</th><td class="word">'
            f"{text(' '.join(robot.word))}<br/>{_stated(robot)}</td>{cells}"
            f'<td class="figure">{spent}</td><td class="figure">{exact_text(total)}</td></tr>'
        )
    heads = "".join(
        f'<th scope="col" class="figure">{head}</th>' if head in FIGURES else f"<th>{head}</th>"
        for head in HEADS
    )
    return (
        f'<div class="scroll"><table class="steps"><thead><tr>{heads}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _stated(robot: StandingRobot) -> str:
    """The values of the robot's parameters."""
    said = [
        f"{parameter.module} {parameter.symbol}.{parameter.name} = "
        f"{with_unit(value, parameter.unit, 6)}"
        for parameter, value in robot.known
    ]
    return f'<span class="soft">{text(", ".join(said))}</span>'


def _changed_cells(robot: StandingRobot, modules: Modules) -> str:
    step = robot.step
    if step is None:
        return "<td></td>" * 3 + '<td class="figure"></td>'
    before, after = module_places(robot.earlier, modules), module_places(robot.word, modules)
    changed = ", ".join(f"{robot.word[after[j]]} {after[j]}.{name}" for _, j, name in step.changed)
    parts = (
        _named(robot.earlier, (before[i] for i in step.removed)),
        _named(robot.word, (after[j] for j in step.added)),
        changed,
    )
    cells = "".join(f"<td>{text(part) or 'none'}</td>" for part in parts)
    return f'{cells}<td class="figure">{len(step.kept)} of {len(before)}</td>'
