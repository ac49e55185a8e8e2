"""The search: what was tried, and with which results."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from srgc.render.charts import Point, scatter_chart
from srgc.render.heat_map import plane_chart
from srgc.render.html_text import many, number, text, with_code
from srgc.report.compared_designs import designs_part
from srgc.report.evidence import GROUPS, Evidence, TriedRobot, tried_robots
from srgc.report.tables import Evaluation, varied

MOST_STRUCTURES = 4
MOST_PARAMETERS = 4
MOST_POINTS = 150
"""The number of evaluations in one picture; the last ones are shown."""
MOST_CELLS = 1_200
"""The most cells of a landscape to draw on the page."""
MOST_ROBOTS = 300
"""The number of distinct robots to list for a verdict; all are in ``design.json``."""
MOST_EQUAL = 60
ALL_EQUAL = 1_200
"""The number of equal structures to list for one robot, and for all robots together."""
MOST_COUNTEREXAMPLES = 200
HEADINGS = {
    "found": "found",
    "unresolved": "neither built nor refuted",
    "inadmissible": "without dynamics",
    "refuted": "refuted",
}


def history_section(evidence: Evidence) -> str:
    """Structures, designs, evaluations, landscape and counterexamples."""
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
    reason = f"{with_code(robot.reason)}; " if robot.reason else ""
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
        f"<summary>{many(len(found), 'cell path')} that {robots} could not follow</summary>"
        "<p>No motion was found that visits the cells named here, in this order where arrows join "
        "them; where none is named, none was found whatever the cells. Paths through the same "
        "cells were deferred until after all others; counted are those with at most two cells "
        "more. This steers the search and proves nothing.</p>"
        '<div class="scroll"><table><thead><tr><th class="figure">structure</th><th>word</th>'
        '<th>cells</th><th class="figure">cells on the path</th><th class="figure">deferred</th>'
        '<th class="figure">gets stuck by</th><th class="figure">robustness</th>'
        f"</tr></thead><tbody>{rows}</tbody></table></div>{rest}</details>"
    )


def _counterexample(one: Mapping[str, Any], words: Sequence[Sequence[str]]) -> str:
    structure = one["structure"]
    # A search that was cut off has no record of its last structure.
    word = " ".join(words[structure]) if structure < len(words) else "not finished"
    time = "" if one["time"] is None else f"{number(one['time'])} s"
    robustness = "" if one["robustness"] is None else number(one["robustness"])
    return (
        f'<tr><td class="figure">{structure}</td><td class="word">{text(word)}</td>'
        f"<td>{text((' → ' if one.get('ordered', True) else ', ').join(one['cells']))}</td>"
        f'<td class="figure">{one.get("of", "")}</td>'
        f'<td class="figure">{one.get("deferred", "")}</td>'
        f'<td class="figure">{time}</td><td class="figure">{robustness}</td></tr>'
    )


# --- Evaluations and landscapes -------------------------------------------------------------------


def evaluations_part(evidence: Evidence) -> str:
    """The evaluations of the structures with the best ones."""
    samples = evidence.evaluations
    if not samples:
        return ""
    best: dict[int, float] = {}
    for each in samples:
        best[each.structure] = max(each.robustness, best.get(each.structure, each.robustness))
    order = sorted(best, key=lambda number: (number != _found(evidence), -best[number], number))
    parts = [_structure(evidence, each) for each in order[:MOST_STRUCTURES]]
    more = len(order) - MOST_STRUCTURES
    also = many(more, "more structure")
    rest = f"<p>There are evaluations of {also}, less robust.</p>" if more > 0 else ""
    design = (
        ", the diamond is the design, which was improved after the last evaluation"
        if evidence.found is not None
        else ""
    )
    return (
        "<h3>Evaluations</h3><p>Each evaluation is the most robust motion that was found for some "
        f"parameters. Circles can be followed, crosses cannot{design}.{_lacking(samples)}</p>"
        f"{''.join(parts)}{rest}"
    )


def _found(evidence: Evidence) -> int | None:
    return None if evidence.record is None else evidence.record.structure


def _structure(evidence: Evidence, structure: int) -> str:
    samples = [each for each in evidence.evaluations if each.structure == structure]
    words = [each["word"] for each in evidence.design["structures_tried"]]
    word = " ".join(words[structure]) if structure < len(words) else "not finished"
    feasible = sum(each.feasible for each in samples)
    head = (
        f'<p><span class="word">{text(word)}</span>: {many(len(samples), "evaluation")}, '
        f"{feasible} that can be followed</p>"
    )
    shown = samples[-MOST_POINTS:]
    if len(shown) < len(samples):
        head += f"<p>The last {MOST_POINTS} are drawn; all are in <code>evaluations.csv</code>.</p>"
    figures = [_figure("in order", scatter_chart(*_progress(shown), counted=True))]
    for name in varied(shown)[:MOST_PARAMETERS]:
        points = _over(evidence, shown, structure, name)
        label, unit = _named(evidence, structure, name)
        figures.append(_figure(f"over {label}", scatter_chart(points, label, unit)))
    return f'{head}<div class="charts">{"".join(figures)}</div>'


def _figure(title: str, chart: str) -> str:
    return f"<figure><figcaption><span>robustness {text(title)}</span></figcaption>{chart}</figure>"


def _progress(
    samples: Sequence[Evaluation],
) -> tuple[list[Point], str, str, list[tuple[float, float]]]:
    """Evaluations in order, with the best value so far."""
    points, best = [], list[tuple[float, float]]()
    for place, each in enumerate(samples, start=1):
        points.append(_point(float(place), each, f"evaluation {place}"))
        if each.feasible:
            top = max(each.robustness, best[-1][1]) if best else each.robustness
            if best:
                best.append((float(place), best[-1][1]))
            best.append((float(place), top))
    return points, "the evaluations", "evaluation", best


def _point(x: float, each: Evaluation, says: str) -> Point:
    mark = "good" if each.feasible else "bad"
    return Point(x, each.robustness, mark, f"{says}: robustness {number(each.robustness)}")


def _over(
    evidence: Evidence, samples: Sequence[Evaluation], structure: int, name: str
) -> list[Point]:
    points = [
        _point(each.theta[name], each, number(each.theta[name]))
        for each in samples
        if name in each.theta
    ]
    design = _design(evidence)
    if structure == _found(evidence) and name in design and evidence.record is not None:
        rho = evidence.record.robustness
        says = f"design, {number(design[name])}: robustness {number(rho)}"
        points.append(Point(design[name], rho, "design", says))
    return points


def _design(evidence: Evidence) -> dict[str, float]:
    """The parameters of the design by name."""
    found = evidence.found
    if found is None:
        return {}
    return {
        f"{each.symbol}.{each.name}": float(value)
        for each, value in zip(found.model.parameters, found.theta, strict=True)
    }


def _lacking(samples: Sequence[Evaluation]) -> str:
    """A remark about infeasible points, which have their own scale; empty without such points."""
    if all(each.feasible for each in samples):
        return ""
    return " What cannot be followed has a scale of its own: below 0, by how much the motion fails."


def _named(evidence: Evidence, structure: int, name: str) -> tuple[str, str]:
    """A parameter's name for people, and its unit if the design has that parameter."""
    words = [each["word"] for each in evidence.design["structures_tried"]]
    place, _, own = name.partition(".")
    known = structure < len(words) and place.isdigit() and int(place) < len(words[structure])
    module = words[structure][int(place)] if known else "symbol"
    unit = ""
    if evidence.found is not None and structure == _found(evidence):
        units = {f"{p.symbol}.{p.name}": p.unit for p in evidence.found.model.parameters}
        unit = units.get(name, "")
    return f"{module}.{own}, symbol {place}", "" if unit == "1" else unit


# --- Landscape -----------------------------------------------------------------------------------


def landscape_part(evidence: Evidence) -> str:
    """The picture of ``landscape.csv``, if the file exists and is about this design."""
    samples, design = evidence.landscape, _design(evidence)
    names = varied(samples)
    if not samples or evidence.record is None or not set(names) <= design.keys():
        return ""
    structure = evidence.record.structure
    labels = [_named(evidence, structure, name)[0] for name in names]
    head = (
        f"<h3>Landscape</h3><p>Robustness over {text(' and '.join(labels))}: {len(samples)} "
        f"points, {sum(each.feasible for each in samples)} that can be followed. Other parameters, "
        f"the cell path and its timing are those of the design, the diamond.{_lacking(samples)}</p>"
    )
    if not 1 <= len(names) <= 2 or len(samples) > MOST_CELLS:
        return head + "<p>The picture is <code>figures/landscape.svg</code>.</p>"
    if len(names) == 1:
        points = _over(evidence, samples, structure, names[0])
        unit = _named(evidence, structure, names[0])[1]
        chart = scatter_chart(points, labels[0], unit)
    else:
        first, second = names
        cells = [
            (each.theta[first], each.theta[second], each.robustness, each.feasible)
            for each in samples
        ]
        chart = plane_chart(cells, (design[first], design[second]), (labels[0], labels[1]))
    return f'{head}<div class="charts wide">{_figure("of the landscape", chart)}</div>'
