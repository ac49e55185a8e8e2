"""What the search of parameters evaluated, and the landscape where there is one."""

from __future__ import annotations

from collections.abc import Sequence

from srgc.render.heat_map import plane_chart
from srgc.render.html_text import many, number, text
from srgc.render.point_chart import Point, scatter_chart
from srgc.report.evaluation_table import Evaluation, varied
from srgc.report.evidence import Evidence

MOST_STRUCTURES = 4
MOST_PARAMETERS = 4
MOST_POINTS = 150
"""In one picture; of more evaluations, the last ones."""
MOST_CELLS = 1_200
"""Of a landscape that is drawn here."""


def evaluations_part(evidence: Evidence) -> str:
    """The evaluations of the structures with the best of them."""
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
        else "; their robustness is by how much they fail"
    )
    return (
        "<h3>Evaluations</h3><p>Each evaluation is the most robust motion that was found for some "
        f"parameters. Circles can be followed, crosses cannot{design}.</p>{''.join(parts)}{rest}"
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
    """Evaluations in their order, with the best so far."""
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
    """The parameters of the design by their names."""
    found = evidence.found
    if found is None:
        return {}
    return {
        f"{each.symbol}.{each.name}": float(value)
        for each, value in zip(found.model.parameters, found.theta, strict=True)
    }


def _named(evidence: Evidence, structure: int, name: str) -> tuple[str, str]:
    """A parameter for people, and its unit where the design has it."""
    words = [each["word"] for each in evidence.design["structures_tried"]]
    place, _, own = name.partition(".")
    known = structure < len(words) and place.isdigit() and int(place) < len(words[structure])
    module = words[structure][int(place)] if known else "symbol"
    unit = ""
    if evidence.found is not None and structure == _found(evidence):
        units = {f"{p.symbol}.{p.name}": p.unit for p in evidence.found.model.parameters}
        unit = units.get(name, "")
    return f"{module}.{own}, symbol {place}", "" if unit == "1" else unit


# --- landscape -----------------------------------------------------------------------------------


def landscape_part(evidence: Evidence) -> str:
    """The picture of ``landscape.csv``, where it is there and about this design."""
    samples, design = evidence.landscape, _design(evidence)
    names = varied(samples)
    if not samples or evidence.record is None or not set(names) <= design.keys():
        return ""
    structure = evidence.record.structure
    labels = [_named(evidence, structure, name)[0] for name in names]
    head = (
        f"<h3>Landscape</h3><p>Robustness over {text(' and '.join(labels))}: {len(samples)} "
        f"points, {sum(each.feasible for each in samples)} that can be followed. Other parameters, "
        "the cell path and its timing are those of the design, the diamond.</p>"
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
            (each.theta[first], each.theta[second], each.robustness if each.feasible else None)
            for each in samples
        ]
        chart = plane_chart(cells, (design[first], design[second]), (labels[0], labels[1]))
    return f'{head}<div class="charts wide">{_figure("of the landscape", chart)}</div>'
