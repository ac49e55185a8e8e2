"""The search: what was tried, and what came of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from srgc.render.html_text import many, number, text
from srgc.report.designs import designs_part
from srgc.report.evaluations import evaluations_part, landscape_part
from srgc.report.evidence import Evidence
from srgc.report.structure_groups import GROUPS, TriedRobot, tried_robots

MOST_ROBOTS = 300
"""So many different robots are listed of one verdict; all are in ``design.json``."""
MOST_EQUAL = 60
ALL_EQUAL = 1_200
"""So many structures equal to one robot are listed, and of all robots together."""
MOST_COUNTEREXAMPLES = 200
HEADINGS = {
    "found": "found",
    "unresolved": "neither built nor refuted",
    "inadmissible": "without dynamics",
    "refuted": "refuted",
}


def history_section(evidence: Evidence) -> str:
    """Structures, evaluations, landscape, counterexamples, designs."""
    robots = tried_robots(evidence.design)
    counts = "".join(
        f"<div><dt>{text(name)}</dt><dd>{text(value)}</dd></div>"
        for name, value in _counts(evidence, robots)
    )
    groups = "".join(
        _group(verdict, [each for each in robots if each.verdict == verdict]) for verdict in GROUPS
    )
    return (
        f'<section id="search"><h2>The search</h2><dl class="facts">{counts}</dl>'
        f"{_structures(evidence, groups)}{designs_part(evidence)}{evaluations_part(evidence)}"
        f"{landscape_part(evidence)}{_counterexamples(evidence)}</section>"
    )


def _counts(evidence: Evidence, robots: Sequence[TriedRobot]) -> Iterator[tuple[str, object]]:
    tried = evidence.design["iterations"]
    listed = len(evidence.design["structures_tried"])
    refuted = sum(1 for each in robots if each.verdict == "refuted")
    yield "structures", listed
    yield "different robots", len(robots)
    yield "robots refuted", refuted
    yield "questions to z3", tried.get("smt", 0)
    yield "cell paths", tried.get("paths", 0)
    yield "evaluations", tried.get("evaluations", 0)
    seconds = evidence.log.get("search_s")
    if isinstance(seconds, int | float):
        yield "search", f"{number(seconds, 3)} s"
    yield "seed", evidence.design["seed"]


def _structures(evidence: Evidence, groups: str) -> str:
    if not groups:
        return (
            "<p>No structure was tried: the verdict was known before one was looked at.</p>"
            if evidence.verdict == "impossible"
            else "<p>No structure was finished.</p>"
        )
    order = "of their length" if evidence.task.origin is None else "of how many modules they change"
    return (
        "<h3>Structures</h3><p>A structure is a derivation of the grammar. Structures were tried "
        f"in order {order}; those that are the same robot as an earlier one stand beside "
        f"it.</p>{groups}"
    )


def _group(verdict: str, robots: Sequence[TriedRobot]) -> str:
    if not robots:
        return ""
    equal = sum(len(each.equal) for each in robots)
    same = f", {many(equal, 'more structure')} equal to {_them(robots)}" if equal else ""
    robots_said = many(len(robots), "robot")
    shown = robots[:MOST_ROBOTS]
    most = max(2, min(MOST_EQUAL, ALL_EQUAL // len(shown)))
    rows = "".join(_row(each, most) for each in shown)
    more = len(robots) - MOST_ROBOTS
    rest = f"<p>{more} more robots are listed in <code>design.json</code>.</p>" if more > 0 else ""
    opened = " open" if verdict != "refuted" and len(robots) <= 12 else ""
    return (
        f'<details class="structures"{opened} data-robots="{len(robots)}" data-equal="{equal}">'
        f"<summary>{HEADINGS[verdict]}: {robots_said}{same}</summary>"
        '<div class="scroll"><table><thead><tr><th class="figure">no.</th><th>word</th>'
        "<th>why</th><th>the same robot</th></tr></thead>"
        f"<tbody>{rows}</tbody></table></div>{rest}</details>"
    )


def _them(robots: Sequence[TriedRobot]) -> str:
    return "it" if len(robots) == 1 else "them"


def _row(robot: TriedRobot, most: int) -> str:
    return (
        f'<tr data-structure="{robot.number}"><td class="figure">{robot.number}</td>'
        f'<td class="word">{text(" ".join(robot.word))}</td><td>{_why(robot)}</td>'
        f"<td>{_equal(robot, most)}</td></tr>"
    )


def _why(robot: TriedRobot) -> str:
    if robot.verdict != "refuted":
        return text(robot.evidence)
    reason = f"{text(robot.reason)}; " if robot.reason else ""
    files = dict.fromkeys(name for name in (robot.evidence, robot.boxes) if name)
    return reason + " and ".join(f"<code>{text(name)}</code>" for name in files)


def _equal(robot: TriedRobot, most: int) -> str:
    if not robot.equal:
        return ""
    shown = "".join(
        f'<li><span class="soft">{place}</span> {text(" ".join(word))}</li>'
        for place, word in robot.equal[:most]
    )
    more = len(robot.equal) - most
    rest = f"<li>and {more} more</li>" if more > 0 else ""
    return f"<details><summary>{len(robot.equal)}</summary><ul>{shown}{rest}</ul></details>"


# --- counterexamples -----------------------------------------------------------------------------


def _counterexamples(evidence: Evidence) -> str:
    found = evidence.design.get("counterexamples", [])
    if not found:
        return ""
    words = [each["word"] for each in evidence.design["structures_tried"]]
    rows = "".join(_counterexample(each, words) for each in found[:MOST_COUNTEREXAMPLES])
    more = len(found) - MOST_COUNTEREXAMPLES
    rest = f"<p>{more} more are in <code>design.json</code>.</p>" if more > 0 else ""
    numbers = Counter(each["structure"] for each in found)
    robots = "one robot" if len(numbers) == 1 else f"{len(numbers)} robots"
    return (
        f'<h3>Counterexamples</h3><details data-counterexamples="{len(found)}">'
        f"<summary>{many(len(found), 'beginning')} of cell paths that {robots} could not follow"
        "</summary>"
        "<p>Each was the shortest beginning of a path that the best motion found cannot follow; "
        "paths that begin so were not tried again. They steer the search and prove nothing.</p>"
        '<div class="scroll"><table><thead><tr><th class="figure">structure</th><th>word</th>'
        '<th>cells</th><th class="figure">gets stuck by</th><th class="figure">robustness</th>'
        f"</tr></thead><tbody>{rows}</tbody></table></div>{rest}</details>"
    )


def _counterexample(one: Mapping[str, Any], words: Sequence[Sequence[str]]) -> str:
    structure = one["structure"]
    # A search that was cut off has no record of the structure it was at.
    word = " ".join(words[structure]) if structure < len(words) else "not finished"
    time = "" if one["time"] is None else f"{number(one['time'])} s"
    robustness = "" if one["robustness"] is None else number(one["robustness"])
    return (
        f'<tr><td class="figure">{structure}</td><td class="word">{text(word)}</td>'
        f"<td>{text(' → '.join(one['cells']))}</td>"
        f'<td class="figure">{time}</td><td class="figure">{robustness}</td></tr>'
    )
