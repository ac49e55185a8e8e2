"""Why refuted robots cannot do the task, and what would help if no robot was found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from grammar_lang.source import Span, written
from solvers.explanation.conflict import Conflict
from solvers.verifier.claims.certificate import ImpossibleClaim, exact
from solvers.verifier.report import Outcome
from srgc.render.html_text import many, text, with_code
from srgc.report.evidence import Evidence, TriedRobot, tried_robots
from srgc.report.spec_source import line_anchor

UNCONFIRMED = (Outcome.REFUTED, Outcome.UNDECIDED, Outcome.UNCHECKED)
MOST_REASONS = 30
MOST_REGIONS = 12


def why_not_section(evidence: Evidence) -> str:
    """Conflicting lines, reasons and evidence; empty if all robots were successful."""
    robots = tried_robots(evidence.design)
    refuted = [each for each in robots if each.verdict == "refuted"]
    parts = [
        *_headline(evidence, robots),
        *(_conflict(evidence, each) for each in evidence.conflicts),
        *_separation(evidence),
        *_lemmas(evidence),
        *_open(evidence, [each for each in robots if each.verdict == "unresolved"]),
        *_reasons(refuted),
        *_kinds(evidence, refuted),
    ]
    if not parts:
        return ""
    title = "Why not these robots" if evidence.found is not None else "Why not"
    return f'<section id="why-not"><h2>{title}</h2>{"".join(parts)}{_ask(evidence)}</section>'


def _headline(evidence: Evidence, robots: Sequence[TriedRobot]) -> Iterator[str]:
    report = evidence.report
    if evidence.verdict == "impossible" and report is not None and report.outcome in UNCONFIRMED:
        yield "<p>The certificate was not confirmed: this is what the folder says.</p>"
    if evidence.verdict != "unknown":
        return
    listed = any(each.verdict == "unresolved" for each in robots)
    reason = str(evidence.design["reason"] or "no reason is stated")
    what = "what is open is listed here" if listed else with_code(reason)
    yield (
        f"<p>The verdict is unknown: {what}. The task may be possible, or impossible for a reason "
        "that the refuters do not see.</p>"
    )


def _ask(evidence: Evidence) -> str:
    if evidence.found is not None:
        return ""
    return (
        "<p><code>srgc why .</code>, run in the folder of this page, says which lines of the "
        "specification conflict, and which changes of one line make the task possible, each "
        "confirmed by a run.</p>"
    )


# --- Conflicting lines ---------------------------------------------------------------------------


def _conflict(evidence: Evidence, conflict: Conflict) -> str:
    many = len(conflict.lines) > 1
    subject = "These lines together rule" if many else "This line rules"
    whom = "every robot, whatever its size"
    if conflict.words:
        longest = max(conflict.words, key=len)
        whom = f'the robot <span class="word">{text(" ".join(longest))}</span>'
    lines = "".join(
        f"<li>{_place(evidence, line.span)}<br>{_says(line.says)}</li>" for line in conflict.lines
    )
    needed = ", and none of them can be spared" if many else ""
    return f'<p>{subject} out {whom}{needed}:</p><ul class="lines">{lines}</ul>'


def _says(sentence: str) -> str:
    return f'<span class="soft">{text(sentence.replace("`", ""))}</span>'


def _place(evidence: Evidence, span: Span) -> str:
    """A statement, with a link to its first line in the source below."""
    source = evidence.program.sources[span.file]
    number, _ = source.position(span.start)
    place = f"{source.path}:{number}"
    return (
        f'<a href="#{line_anchor(span.file, number)}">{text(place)}</a> '
        f"<code>{text(written(span, evidence.program.sources) or source.line(number).strip())}"
        "</code>"
    )


# --- What was tried ------------------------------------------------------------------------------


def _separation(evidence: Evidence) -> Iterator[str]:
    claim = evidence.claim
    if not isinstance(claim, ImpossibleClaim) or claim.separation is None:
        return
    cut = claim.separation
    walls = ", ".join(f"<code>{text(name)}</code>" for name in cut.avoided[:MOST_REGIONS])
    more = len(cut.avoided) - MOST_REGIONS
    rest = f" and {more} more" if more > 0 else ""
    yield (
        f"<p>From <code>{text(cut.source)}</code> an effector gets to {len(cut.cells)} cells "
        f"without entering {walls or 'any region'}{rest}; <code>{text(cut.target)}</code> is not "
        "among them. So no robot was tried.</p>"
    )


def _lemmas(evidence: Evidence) -> Iterator[str]:
    """The statements about many robots at once, each with its condition and its bound."""
    lemmas = evidence.design.get("lemmas", [])
    if not lemmas:
        return
    rows = "".join(
        f'<tr><td class="figure">{number}</td><td><code>{text(lemma["condition"])}</code></td>'
        f"<td>{_argument(lemma)}</td></tr>"
        for number, lemma in enumerate(lemmas[:MOST_REASONS], 1)
    )
    more = len(lemmas) - MOST_REASONS
    rest = f"<p>and {more} more, in <code>design.json</code></p>" if more > 0 else ""
    yield (
        "<h3>Lemmas</h3><p>Each is about all robots of the family whose words have a condition, "
        "as <code>accept</code> has it; these were not tried one by one.</p>"
        f'<div class="scroll"><table data-lemmas="{len(lemmas)}"><thead><tr>'
        '<th class="figure">no.</th><th>words with</th><th>what was shown</th></tr></thead>'
        f"<tbody>{rows}</tbody></table></div>{rest}"
    )


def _argument(lemma: Mapping[str, Any]) -> str:
    """What a lemma says about its robots."""
    if "region" not in lemma:
        word = f'<span class="word">{text(" ".join(lemma["word"]))}</span>'
        if "most" in lemma:
            return f"the drives of {word} are too weak, with up to {lemma['most']} weights anywhere"
        return f"none has poses that {word}, which is refuted, has not"
    region = f"<code>{text(lemma['region'])}</code>"
    vector = ", ".join(_short(x) for x in lemma["vector"])
    bound = _short(lemma["bound"])
    if lemma["argument"] == "too far":
        kept = f"none is farther than {bound} m along ({vector}), all of {region} is"
    else:
        kept = f"none is nearer than {bound} m to ({vector}), all of {region} is"
    return f"no effector gets into {region}: {kept}"


def _short(number: str) -> str:
    return f"{float(exact(number)):.4g}"


def _open(evidence: Evidence, robots: Sequence[TriedRobot]) -> Iterator[str]:
    if evidence.found is not None or not robots:
        return
    items = "".join(
        f'<li><span class="word">{text(" ".join(each.word))}</span><br>'
        f'<span class="soft">{text(each.evidence)}</span></li>'
        for each in robots[:MOST_REASONS]
    )
    more = len(robots) - MOST_REASONS
    rest = f"<li>and {more} more</li>" if more > 0 else ""
    yield f"<h3>Neither built nor refuted</h3><ul>{items}{rest}</ul>"


def _reasons(refuted: Sequence[TriedRobot]) -> Iterator[str]:
    """The reasons in words, with the number of robots that each refutes."""
    groups: dict[str, list[TriedRobot]] = {}
    for each in refuted:
        groups.setdefault(each.reason or "refuted", []).append(each)
    if not groups:
        return
    rows = "".join(
        f'<tr><td class="figure">{len(group)}</td><td>{with_code(reason)}</td>'
        f'<td class="word">{text(" ".join(group[-1].word))}</td></tr>'
        for reason, group in list(groups.items())[:MOST_REASONS]
    )
    more = len(groups) - MOST_REASONS
    rest = f"<p>and {more} more reasons, in <code>design.json</code></p>" if more > 0 else ""
    yield (
        '<h3>Refuted</h3><div class="scroll"><table data-refuted="'
        f'{len(refuted)}"><thead><tr><th class="figure">robots</th><th>what was shown</th>'
        f"<th>for example</th></tr></thead><tbody>{rows}</tbody></table></div>{rest}"
    )


def _kinds(evidence: Evidence, refuted: Sequence[TriedRobot]) -> Iterator[str]:
    """The kinds of evidence, and the meaning of each kind."""
    covered = [each for each in refuted if each.boxes is not None]
    scripts = [each for each in refuted if each.evidence.endswith(".smt2")]
    if covered:
        known = [evidence.coverings.get(each.boxes or "") for each in covered]
        sizes = [each for each in known if each is not None]
        counted = ""
        if sizes:
            parameters, coordinates = (
                sum(each.parameters for each in sizes), sum(each.coordinates for each in sizes)
            )  # fmt: skip
            boxes = many(parameters, "box"), many(coordinates, "box")
            counted = f", {boxes[0]} of parameters and {boxes[1]} of coordinates in all"
        yield (
            f"<p>{many(len(covered), 'robot')} {_is(covered)} refuted by a covering "
            f"(<code>proofs/*.boxes</code>{counted}): "
            "all parameters and all coordinates are divided into boxes, on each of which the "
            "verifier computes for itself, in ball arithmetic, whether the robot is blocked. No "
            "chain of boxes that are not blocked leads from the start to the goal, or the drives "
            "are too weak for it.</p>"
        )
    if scripts:
        also = " A covering proves the same without a solver." if covered else ""
        yield (
            f"<p>{many(len(scripts), 'robot')} {_is(scripts)} refuted by a script in SMT-LIB 2 "
            "(<code>proofs/*.smt2</code>) that asks for poses of the robot at the start and at the "
            "goal, with all parameters free: the solver z3 answered <code>unsat</code>, there are "
            f"none. Limits and dynamics are left out of it, which can only add solutions.{also}</p>"
        )


def _is(robots: Sequence[TriedRobot]) -> str:
    return "is" if len(robots) == 1 else "are"
