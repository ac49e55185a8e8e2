"""The tasks of a mission: the essentials of each design, and what is refuted in each task."""

from __future__ import annotations

from collections.abc import Iterator

from compiler.expressions.exact_numbers import exact_text
from srgc.render.html_text import many, number, text, with_code, with_unit
from srgc.report.evidence import Evidence
from srgc.report.missions.mission_evidence import MissionEvidence
from srgc.report.verdict import least_clearance
from srgc.results.mission_folder import TaskRefutations
from srgc.results.undecided_robots import StatedUndecided, undecided_by_task
from srgc.text_reports.synthesis_report import robustness_text, used_inputs

MOST_REASONS = 12
MOST_NAMED = 3
"""The number of robots to name that are undecided for one reason."""


def tasks_section(evidence: MissionEvidence) -> str:
    """Each task with the figures of its motion, and the commands that tell more."""
    if not evidence.tasks:
        return ""
    cards = "".join(_card(task) for task in evidence.tasks)
    title = "The task" if len(evidence.tasks) == 1 else "Task by task"
    return (
        f'<section id="tasks"><h2>{title}</h2><p>Each design is an ordinary result, in a folder of '
        f"its own, which every command takes.</p>{cards}</section>"
    )


def _card(task: Evidence) -> str:
    name = text(task.task.name)
    folder = f"tasks/{name}"
    figures = "".join(
        f"<div><dt>{text(term)}</dt><dd>{text(value)}</dd></div>" for term, value in _figures(task)
    )
    word = "" if task.found is None else text(" ".join(task.found.claim.word))
    return (
        f'<div class="task" data-task="{name}"><h3>{name}</h3><p class="word">{word}</p>'
        f'<dl class="facts">{figures}</dl>'
        f'<pre class="commands">srgc verify {folder}\nsrgc report {folder}</pre></div>'
    )


def _figures(task: Evidence) -> Iterator[tuple[str, str]]:
    found = task.found
    if found is None:
        return
    used = used_inputs(found.model, found.task, found.claim.inputs)
    yield "checked", _checked(task)
    yield "motion", f"{number(float(found.task.step * found.task.steps), 6)} s"
    peaks = [with_unit(each.peak, each.unit) for each in used if each.effort]
    yield "peak effort", " and ".join(peaks) or "no joint has a free input"
    if used:
        yield "robustness", robustness_text(used, with_unit)
    clearance = least_clearance(task)
    if clearance is not None:
        yield "least clearance", clearance


def _checked(task: Evidence) -> str:
    if task.report is None:
        return "not for this page"
    level = "" if task.report.level is None else f", level {task.report.level}"
    return f"{task.report.outcome.value}{level}, {many(len(task.report.conditions), 'condition')}"


# --- What is refuted ------------------------------------------------------------------------------


def refuted_section(evidence: MissionEvidence) -> str:
    """What is refuted in each task; empty if nothing is and the verdict is found."""
    refuted = evidence.mission.refuted
    found = evidence.mission.verdict == "found"
    title = "What rules other robots out" if found else "Why there are no robots"
    if evidence.mission.verdict == "unknown":
        title = "What is known"
    if not any(map(_is_something, refuted)):
        said = _nothing(evidence)
        if not said:
            return ""
        return f'<section id="refuted"><h2>{title}</h2><p>{said}</p>{_open(evidence)}</section>'
    rows = "".join(_row(evidence, each) for each in refuted)
    reasons = "".join(_reasons(each) for each in refuted)
    return (
        f'<section id="refuted"><h2>{title}</h2><p>{_said(evidence)}</p>'
        '<div class="scroll"><table><thead><tr><th>task</th><th class="figure">structures</th>'
        '<th class="figure">lemmas</th><th class="figure">boxes of parameters</th>'
        f"<th>coverings</th></tr></thead><tbody>{rows}</tbody></table></div>{reasons}{_open(evidence)}"
        f"{_ask(evidence)}"
        "</section>"
    )


def _is_something(each: TaskRefutations) -> bool:
    return bool(each.structures or each.lemmas or each.boxes or each.separated)


def _nothing(evidence: MissionEvidence) -> str:
    if evidence.mission.verdict == "unknown":
        return "No robot was refuted before the search ended."
    if evidence.mission.verdict == "impossible":
        return "There is no robot of the family within the bounds of the tasks."
    return ""


def _said(evidence: MissionEvidence) -> str:
    mission = evidence.mission
    each = (
        "Robots that are refuted in a task, whatever became of the others: single structures with "
        "all their parameters, lemmas about all words of a condition, and boxes of the parameters "
        "of structures that are not refuted as a whole."
    )
    if mission.verdict == "unknown":
        return f"{each} Other robots are left."
    if mission.claim is not None and mission.claim.modules is not None:
        return f"{each} All is about robots of at most {many(mission.claim.modules, 'module')}."
    return each


def _row(evidence: MissionEvidence, each: TaskRefutations) -> str:
    known = evidence.coverings.get(each.task)
    said = ""
    if known is not None and known.coverings:
        size = known.size
        said = (
            f"{known.coverings}, with {many(size.parameters, 'box')} of parameters and "
            f"{many(size.coordinates, 'box')} of coordinates"
        )
    return (
        f'<tr data-task="{text(each.task)}"><th scope="row">{text(each.task)}</th>'
        f'<td class="figure">{each.structures}</td><td class="figure">{len(each.lemmas)}</td>'
        f'<td class="figure">{each.boxes}</td><td>{said}</td></tr>'
    )


def _reasons(each: TaskRefutations) -> str:
    items = [f"<li>{text(lemma.replace('`', ''))}</li>" for lemma in each.lemmas]
    if each.separated:
        items.append("<li>obstacles separate the start from the target, for every robot</li>")
    items += [
        f"<li>{many(count, 'structure')}: {with_code(reason)}, for example "
        f'<span class="word">{text(" ".join(word))}</span></li>'
        for reason, count, word in each.reasons
    ]
    if not items:
        return ""
    more = len(items) - MOST_REASONS
    rest = f"<li>and {many(more, 'more reason')}, in <code>design.json</code></li>"
    shown = "".join(items[:MOST_REASONS]) + (rest if more > 0 else "")
    return f"<h3>{text(each.task)}</h3><ul>{shown}</ul>"


def _open(evidence: MissionEvidence) -> str:
    """The robots that are neither found nor refuted, by task, and what to try first."""
    mission, parts = evidence.mission, list[str]()
    for task, each in undecided_by_task(mission.undecided).items():
        where = "all tasks together" if task is None else task
        items = "".join(f"<li>{_undecided(one)}</li>" for one in each[:MOST_REASONS])
        more = len(each) - MOST_REASONS
        if more > 0:
            items += f"<li>and {many(more, 'more reason')}, in <code>design.json</code></li>"
        parts.append(f"<h3>Undecided in {text(where)}</h3><ul>{items}</ul>")
    first = mission.design.get("try_first")
    if first is not None:
        parts.append(f"<p>Try first: {_plain(first)}.</p>")
    return "".join(parts)


def _undecided(one: StatedUndecided) -> str:
    said = _plain(one.says(MOST_NAMED))
    return said if one.try_first is None else f"{said}. Try first: {_plain(one.try_first)}"


def _plain(said: str) -> str:
    return text(said.replace("`", ""))


def _ask(evidence: MissionEvidence) -> str:
    if evidence.mission.verdict == "found":
        return ""
    return (
        "<p><code>srgc why .</code>, run in the folder of this page, says the same as text, and "
        "what the cheapest robots that are left would cost.</p>"
    )


# --- The history ----------------------------------------------------------------------------------


def earlier_section(evidence: MissionEvidence) -> str:
    """The robots that led to the existing robot; empty without a history."""
    if not evidence.earlier:
        return ""
    rows = "".join(
        f'<tr><td class="figure">{each.number}</td><th scope="row">{text(each.task)}</th>'
        f'<td class="word">{text(" ".join(each.word))}<br/>'
        f'<span class="soft">{text(", ".join(each.values))}</span></td>'
        f'<td class="figure">{"" if each.cost is None else exact_text(each.cost)}</td>'
        f"<td>{text(each.spec)}</td></tr>"
        for each in evidence.earlier
    )
    now = len(evidence.earlier) + 1
    cost = evidence.mission.cost
    for task, robot in zip(evidence.mission.mission.tasks, evidence.mission.robots, strict=False):
        rows += (
            f'<tr><td class="figure">now</td><th scope="row">{text(task)}</th><td class="word">'
            f'{text(" ".join(robot.claim.word))}</td><td class="figure">'
            f"{'' if cost is None else exact_text(cost)}</td><td>{text(robot.claim.spec)}</td></tr>"
        )
    return (
        f'<section id="earlier" data-robots="{now}"><h2>The robots before</h2><p>The results that '
        "led to the robot there was are in <code>history</code>, each checkable on its own.</p>"
        '<div class="scroll"><table><thead><tr><th class="figure">result</th><th>task</th>'
        '<th>robot</th><th class="figure">cost of changes</th><th>specification</th></tr></thead>'
        f"<tbody>{rows}</tbody></table></div></section>"
    )
