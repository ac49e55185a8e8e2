"""What a mission asks for, the verdict, and what is proved about it."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from compiler.expressions.exact_numbers import exact_text
from compiler.objectives.objective_text import gap_text, objective_text
from grammar_lang import ir
from solvers.verifier.report import Outcome, Report
from srgc.render.html_text import many, text
from srgc.report.missions.line_of_robots import different_robots
from srgc.report.missions.mission_evidence import MissionEvidence
from srgc.report.verdict import MODEL, judged_words
from srgc.results.mission_folder import FROM
from srgc.results.stated_objectives import short


def mission_head(evidence: MissionEvidence) -> str:
    """The head of the page: the mission, the verdict and the claim."""
    word, kind = judged_words(evidence.mission.verdict, _report(evidence), "claim")
    mission = evidence.mission
    return (
        f'<header><p class="kicker">srgc report · {text(mission.design["spec"])}</p>'
        f"<h1>{text(mission.mission.name)}</h1>"
        f'<p class="verdict {kind}">{text(word)}</p>{_headline(evidence)}</header>'
    )


def mission_proved_section(evidence: MissionEvidence) -> str:
    """What was proved, and what was asked for."""
    mission = evidence.mission
    proved = "".join(f"<p>{sentence}</p>" for sentence in _proved(evidence))
    asked = "".join(f"<li>{sentence}</li>" for sentence in _asked(evidence))
    what = "One step from a robot that there is" if mission.evolved else "The mission"
    return (
        f'<section id="verdict"><div class="columns"><div><h2>What was proved</h2>{proved}</div>'
        f"<div><h2>{what}</h2><ul>{asked}</ul></div></div>{_facts(evidence)}</section>"
    )


def _report(evidence: MissionEvidence) -> Report | None:
    return None if evidence.report is None else evidence.report.report


def _is_valid(evidence: MissionEvidence) -> bool:
    report = _report(evidence)
    return report is not None and report.outcome is Outcome.VALID


def _headline(evidence: MissionEvidence) -> str:
    """The claim in one line."""
    mission = evidence.mission
    if mission.verdict != "found":
        reason = str(mission.design["reason"] or "no reason is stated")
        return f'<p class="reason">{text(reason.replace("`", ""))}</p>'
    undecided = mission.design["undecided"]
    parts = list(_claims(evidence))
    if undecided:
        parts.append(f"{many(undecided, 'robot')} undecided")
    return f'<p class="claim">{"; ".join(parts)}</p>'


def _claims(evidence: MissionEvidence) -> Iterator[str]:
    """The cost or the objectives of the robots, and what is claimed about all others."""
    mission = evidence.mission
    if mission.cost is not None:
        steps = sum(1 for step in mission.steps if step is not None and step.cost)
        rebuilt = f", the robot rebuilt {many(steps, 'time')}" if steps else ""
        yield f"<b>Changes {exact_text(mission.cost)}</b>{rebuilt}"
        yield _least_words(mission.cost, mission.least or Fraction(0), "robots cost")
        return
    yield f"<b>One robot</b> for {many(len(mission.mission.tasks), 'task')}"
    for each in mission.design["objectives"]:
        value, least = float(each["value"]), float(each["least"])
        name = each["objective"].removeprefix("sum(").removesuffix(")")
        unit = f" {each['unit']}".rstrip()
        said = f"{text(name)} {short(value)}{text(unit)}"
        if least >= value:
            yield f"{said}, none has less"
        elif least > 0:
            yield f"{said}, none has less than {short(least)}{text(unit)}"
        else:
            yield f"{said}, nothing is proved of others"


def _least_words(value: Fraction, least: Fraction, have: str) -> str:
    if least >= value:
        return f"no {have} less"
    if least > 0:
        gap = gap_text(value / least - 1)
        return f"no {have} less than {exact_text(least)}, a gap of {gap}"
    return "nothing is proved of cheaper ones"


# --- What was proved ------------------------------------------------------------------------------


def _proved(evidence: MissionEvidence) -> Iterator[str]:
    """Paragraphs of HTML."""
    verdict, report = evidence.mission.verdict, _report(evidence)
    if verdict == "unknown":
        yield (
            "Nothing about the mission: there are neither robots that are proved to do it nor a "
            "proof that there are none."
        )
        return
    if report is None:
        yield (
            "The claim was not checked when this page was made (<code>--no-verify</code>). "
            "<code>srgc verify</code> checks it."
        )
        return
    if report.outcome is not Outcome.VALID:
        said = report.outcome.value
        yield (
            f"The check of the claim, done again for this page, ends <strong>{said}</strong>: "
            f"{text(report.reason or 'no reason')}. Do not rely on what this folder says."
        )
        return
    yield from _proved_found(evidence) if verdict == "found" else _proved_impossible(evidence)


def _proved_found(evidence: MissionEvidence) -> Iterator[str]:
    mission = evidence.mission
    count = sum(len(each.report.conditions) for each in evidence.tasks if each.report is not None)
    yield (
        "Each design does its task at every instant of its motion, for the nonlinear equations of "
        f"motion, in ball arithmetic: {many(count, 'condition')} in all, on "
        f"{many(len(evidence.tasks), 'task')}."
    )
    if mission.cost is None:
        yield "One robot does all tasks: the same word, and the same parameters to the digit."
    else:
        yield (
            "What is added, removed and changed between the robots was computed again from their "
            "certificates: modules that are kept keep their parameters but for those that are "
            f"free. The cheapest way costs {exact_text(mission.cost)}."
        )
    least = mission.least or Fraction(0)
    if mission.cost and least > 0:
        than = "" if least == mission.cost else f" than {exact_text(least)}"
        yield (
            f"No robots cost less{than}: of every cheaper chain at least one robot is refuted in "
            "its task, by the evidence below."
        )
    yield (
        "All of this was checked again when this page was made, from the specification and the "
        f"certificates alone; the search is not believed. {MODEL}"
    )


def _proved_impossible(evidence: MissionEvidence) -> Iterator[str]:
    mission = evidence.mission.mission
    claim = evidence.mission.claim
    within = ""
    if claim is not None and claim.modules is not None:
        within = f" of at most {many(claim.modules, 'module')}"
    if mission.prices is None:
        yield (
            f"No robot{within} does all tasks: whatever its parameters, it is refuted in one of "
            "them."
        )
    else:
        bound = "" if mission.most is None else f" for {exact_text(mission.most)} or less"
        yield (
            f"No robots{within} do the tasks{bound}: of every chain at least one robot is refuted "
            "in its task."
        )
    yield (
        "The verifier checked again, when this page was made, every lemma and every covering, and "
        f"that they leave none; no solver has to be believed. "
        f"{MODEL.replace('the robot and the workspace', 'robots and workspaces')}"
    )


# --- What was asked for ---------------------------------------------------------------------------


def _asked(evidence: MissionEvidence) -> Iterator[str]:
    """What the mission asks for, in sentences of HTML."""
    mission = evidence.mission.mission
    tasks = ", ".join(f"<code>{text(name)}</code>" for name in mission.tasks)
    one = len(mission.tasks) == 1
    yield f"The task {tasks}." if one else f"The tasks {tasks}, in this order."
    if mission.prices is None:
        yield "One robot does all of them."
    elif evidence.mission.claim is not None or not evidence.mission.evolved:
        yield from _changes_asked(mission, mission.prices)
    if evidence.mission.before is not None:
        word = " ".join(evidence.mission.before.word)
        source = evidence.mission.before.source
        where = "as <code>from</code> says" if source == FROM else f"in {text(source)}"
        yield f"There is a robot already, <code>{text(word)}</code>, {where}."
    if mission.minimize:
        asked = ", then ".join(f"<code>{objective_text(o)}</code>" for o in mission.minimize)
        yield f"The least is asked for of: {asked}."


def _changes_asked(mission: ir.Mission, prices: ir.Prices) -> Iterator[str]:
    add, remove, change = map(exact_text, (prices.add, prices.remove, prices.change))
    also = f", to change a free parameter {change}" if mission.free else ""
    when = "Before it" if len(mission.tasks) == 1 else "Between tasks"
    yield (
        f"{when} the robot may be rebuilt: to add a module costs {add}, to remove one "
        f"{remove}{also}."
    )
    if mission.free:
        free = ", ".join(f"<code>{text(m)}.{text(p)}</code>" for m, p in sorted(mission.free))
        yield f"Kept modules may change {free}; all else of them stays."
    if mission.most is not None:
        yield f"All changes together cost at most {exact_text(mission.most)}."


# --- Figures --------------------------------------------------------------------------------------


def _facts(evidence: MissionEvidence) -> str:
    items = "".join(
        f"<div><dt>{text(name)}</dt><dd>{text(value)}</dd></div>"
        for name, value in _figures(evidence)
    )
    return f'<dl class="facts">{items}</dl>'


def _figures(evidence: MissionEvidence) -> Iterator[tuple[str, str]]:
    mission = evidence.mission
    yield "tasks", str(len(mission.mission.tasks))
    if mission.robots:
        yield "different robots", str(different_robots(mission))
    if mission.cost is not None:
        yield "cost of all changes", exact_text(mission.cost)
        least = mission.least or Fraction(0)
        yield "proved least" if _is_valid(evidence) else "claimed least", exact_text(least)
    if mission.verdict != "found" and mission.design["least"] is not None:
        yield "the cheapest that was left", short(float(mission.design["least"]))
    yield "undecided robots", str(mission.design["undecided"])
    if evidence.log.get("total_s") is not None:
        yield "searched", f"{float(evidence.log['total_s']):.3g} s"
