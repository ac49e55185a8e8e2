"""The verdict, what was proved, the task in words, and the robot in figures."""

from __future__ import annotations

import math
from collections.abc import Iterator

from solvers.verifier.claims.bound_claims import bound_text
from solvers.verifier.claims.certificate import FoundClaim, ImpossibleClaim, control_of
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Outcome, Report
from srgc.render.html_text import many, number, text, with_code, with_unit
from srgc.report.controller import commanded_peak
from srgc.report.evidence import Evidence, tried_robots
from srgc.report.task_sentences import task_sentences
from srgc.results.found_design import FoundDesign
from srgc.text_reports.synthesis_report import (
    NOT_HELD,
    NOT_HELD_FIRST,
    UNASKED_SELF,
    robustness_text,
    steps_taken,
    used_inputs,
)
from srgc.text_reports.verification_report import by_map

MODEL = (
    "It is a statement about the robot and the workspace as the specification models them: rigid "
    "bodies, and inputs that are held over each step."
)


def verdict_head(evidence: Evidence) -> str:
    """The head of the page: the task, the verdict and the robot."""
    word, kind = judged_words(evidence.verdict, evidence.report)
    return (
        f'<header><p class="kicker">srgc report · {text(evidence.design["spec"])}</p>'
        f"<h1>{text(evidence.task.name)}</h1>"
        f'<p class="verdict {kind}">{text(word)}</p>{_robot_line(evidence)}</header>'
    )


def proved_section(evidence: Evidence) -> str:
    """What was proved, the task in words, and the robot in figures."""
    proved = "".join(f"<p>{sentence}</p>" for sentence in _proved(evidence))
    sentences = "".join(
        f"<li>{with_code(sentence)}</li>"
        for sentence in task_sentences(evidence.program, evidence.task)
    )
    return (
        f'<section id="verdict"><div class="columns"><div><h2>What was proved</h2>{proved}</div>'
        f"<div><h2>The task</h2><ul>{sentences}</ul></div></div>{_facts(evidence)}</section>"
    )


def _robot_line(evidence: Evidence) -> str:
    if evidence.found is not None:
        return f'<p class="word">{text(" ".join(evidence.found.claim.word))}</p>'
    claim = evidence.claim
    if isinstance(claim, ImpossibleClaim):
        return f'<p class="reason">{with_code(_claimed(claim))}</p>'
    reason = evidence.design["reason"]
    return "" if reason is None else f'<p class="reason">{with_code(str(reason))}</p>'


def _claimed(claim: ImpossibleClaim) -> str:
    """The claim of a certificate, which may differ from what ``design.json`` says."""
    if claim.separation is not None:
        return f"no effector gets from `{claim.separation.source}` to `{claim.separation.target}`"
    bounded = f"of at most {many(claim.modules or 0, 'module')}"
    within = "of the family" if claim.modules is None else bounded
    if claim.lemmas:
        alone = len(claim.structures)
        rest = f", and {many(alone, 'other structure')} one by one" if alone else ""
        return f"all structures {within} are refuted, by {many(len(claim.lemmas), 'lemma')}{rest}"
    match len(claim.structures):
        case 0:
            return f"the family has no robot {'' if claim.modules is None else bounded}".strip()
        case 1:
            return f"the only structure {within} is refuted"
        case count:
            return f"all {count} structures {within} are refuted"


def judged_words(
    verdict: str, report: Report | None, claim: str = "certificate"
) -> tuple[str, str]:
    """The words of the badge, and its class.

    Args:
        verdict: the verdict of the result.
        report: the verifier's report on it, None if it was not asked.
        claim: the word for what the result claims.
    """
    if verdict == "unknown":
        return "unknown", "open"
    if report is None:
        return f"{verdict}, not checked for this page", "open"
    match report.outcome:
        case Outcome.VALID:
            level = "" if report.level is None else f", level {report.level}"
            return f"{verdict}, proved{level}", "good" if verdict == "found" else "settled"
        case Outcome.UNCHECKED:
            return f"{verdict}, scripts not run", "open"
        case Outcome.UNDECIDED | Outcome.UNEXPECTED:
            return f"{verdict}, not confirmed", "open"
        case Outcome.REFUTED | Outcome.DISAGREEMENT:
            return f"{verdict}: the {claim} is refuted", "bad"


# --- What was proved -----------------------------------------------------------------------------


def _proved(evidence: Evidence) -> Iterator[str]:
    """Paragraphs of HTML."""
    verdict, report = evidence.verdict, evidence.report
    if verdict == "unknown":
        yield _proved_of_unknown(evidence)
    elif report is None:
        yield (
            "The certificate was not checked when this page was made "
            "(<code>--no-verify</code>). <code>srgc verify</code> checks it."
        )
    elif report.outcome in (Outcome.REFUTED, Outcome.UNDECIDED):
        yield (
            f"The check of the certificate, done again for this page, ends "
            f"<strong>{report.outcome.value}</strong>: {text(report.reason or 'no reason')}. "
            "Do not rely on what this folder says."
        )
    elif verdict == "found":
        yield from _proved_motion(evidence)
    else:
        yield from _proved_impossible(evidence)


def _proved_of_unknown(evidence: Evidence) -> str:
    robots = tried_robots(evidence.design)
    refuted = sum(1 for each in robots if each.verdict == "refuted")
    also = f" Of {len(robots)} different robots that were tried, {refuted} are refuted."
    return (
        "Nothing about the task: there is neither a robot that is proved to do it nor a proof that "
        f"none can.{also if refuted else ''}"
    )


def _proved_motion(evidence: Evidence) -> Iterator[str]:
    report = evidence.report
    count = 0 if report is None else len(list(by_map(report.conditions)))
    disturbed = (
        " The same holds of every motion that the stated disturbances allow."
        if evidence.task.robust is not None
        else ""
    )
    yield (
        "This robot, started and driven as its certificate says, does the task at every instant of "
        "its motion, not only at the samples. The verifier followed the nonlinear equations of "
        "motion in ball arithmetic, which rounds outwards, and showed "
        f"{many(count, 'condition')}, which are below with their margins.{disturbed}"
    )
    if isinstance(evidence.claim, FoundClaim) and evidence.claim.controller is not None:
        yield (
            "At every step its controller measures coordinates and rates, and corrects the inputs "
            "by what they are off from its reference. What was followed is this closed loop; the "
            "bounds of the inputs hold for all that it commands."
        )
    if evidence.design.get("held_at_start") is False:
        yield with_code(f"{NOT_HELD_FIRST[0].upper()}{NOT_HELD_FIRST[1:]}.")
    if evidence.design.get("held_at_end") is False:
        yield with_code(f"It is at rest there for an instant only; {NOT_HELD}.")
    if evidence.task.avoid_self is None:
        yield with_code(f"{UNASKED_SELF[0].upper()}{UNASKED_SELF[1:]}: it may pass through itself.")
    if evidence.task.repeat:
        yield (
            "The motion goes on for ever. The certificate states a set of states in which every "
            "round of the loop begins: all motions are in it where the prefix ends, and every "
            "motion that begins a round anywhere in it ends the round in it. Conditions are about "
            "all rounds, except those on the start, the path of cells and the planned inputs."
        )
    yield (
        "It was checked again when this page was made, from the specification and the certificate "
        f"alone; the search is not believed. {MODEL}"
    )


def _proved_impossible(evidence: Evidence) -> Iterator[str]:
    report = evidence.report
    claim = evidence.claim
    bound = claim.modules if isinstance(claim, ImpossibleClaim) else None
    within = f" with at most {bound} modules" if bound is not None else ""
    no_robot = f"no robot of the family{within} can do the task, whatever its parameters and inputs"
    if report is not None and report.outcome is Outcome.UNCHECKED:
        yield (
            f"The certificate says that {no_robot}. That is not checked here: "
            f"{text(report.reason or '')}."
        )
        return
    yield f"{no_robot[0].upper()}{no_robot[1:]}."
    if isinstance(claim, ImpossibleClaim) and claim.lemmas:
        coverings = ", the coverings of the other structures," if claim.structures else ""
        yield (
            "The verifier checked again, when this page was made, what each lemma says of all "
            f"robots of its words{coverings} and that these are all words of the family; no solver "
            "has to be believed."
        )
    elif evidence.design["structures_tried"]:
        yield (
            "The verifier went through the covering of every structure again when this page was "
            "made, in ball arithmetic; no solver has to be believed."
        )
    else:
        yield "The verifier computed the cells and what leads from one to the other again."
    yield MODEL.replace("the robot and the workspace", "robots and workspaces")


# --- Figures -------------------------------------------------------------------------------------


def _facts(evidence: Evidence) -> str:
    found = evidence.found
    if found is None:
        return ""
    items = "".join(
        f"<div><dt>{text(name)}</dt><dd>{text(value)}</dd></div>"
        for name, value in _figures(evidence, found)
    )
    return f'<dl class="facts">{items}</dl>'


def _figures(evidence: Evidence, found: FoundDesign) -> Iterator[tuple[str, str]]:
    design = evidence.design
    for value in found.parameters:
        known = value.parameter
        name = f"{known.module}.{known.name}, symbol {known.symbol}"
        yield name, with_unit(float(value), known.unit, 5)
    lasts = f"{number(float(found.task.step * found.task.steps), 6)} s"
    taken = f", {steps_taken(found.task.steps, evidence.task)}" if evidence.task.at_most else ""
    yield "motion", lasts + taken
    if found.claim.loop is not None:
        begins = number(float(found.task.step * found.claim.loop.first), 6)
        yield "repeats", f"from {begins} s to {lasts}, for ever"
    used = used_inputs(found.model, found.task, found.claim.inputs)
    peaks = [with_unit(each.peak, each.unit) for each in used if each.effort]
    yield "peak effort", " and ".join(peaks) or "no joint has a free input"
    for each in used:
        if not each.effort:
            yield each.name, f"{number(each.low)} to {with_unit(each.high, each.unit)}"
    yield from commanded_peak(evidence, found)
    if used:
        yield "control", control_of(found.claim)
    if used:
        yield "robustness", robustness_text(used, with_unit)
    if found.claim.bound is not None:
        yield "bound on robustness", bound_text(found.claim.bound)
    for place, each in enumerate(design["satisfy"], start=1):
        value = each["robustness"]
        yield f"satisfy {place}, robustness", "always" if value is None else f"{number(value)} m"
    clearance = least_clearance(evidence)
    if clearance is not None:
        yield "least clearance", clearance


def least_clearance(evidence: Evidence) -> str | None:
    """The least clearance that was proved for the motion; None if none was proved."""
    report = evidence.report
    margins = (
        []
        if report is None
        else [
            each.margin
            for each in report.conditions
            if each.name.startswith("clearance")
            and math.isfinite(each.margin)
            and each.status is Status.HOLDS
        ]
    )
    return f"{number(min(margins), 3)} m" if margins else None
