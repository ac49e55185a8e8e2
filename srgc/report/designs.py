"""All designs of ``synth --all`` beside each other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from srgc.render.html_text import number, text
from srgc.render.point_chart import Point, scatter_chart
from srgc.report.evidence import Evidence


def designs_part(evidence: Evidence) -> str:
    """The table of ``pareto.json``, those that none dominates first; nothing without it."""
    content = evidence.pareto
    best, others = content.get("designs", []), content.get("dominated", [])
    if not best:
        return ""
    rows = "".join(_row(each) for each in [*best, *others])
    ended = content.get("ended")
    left = f"<p>Not all structures were tried: {text(ended)}.</p>" if ended else ""
    many = "One design" if len(best) == 1 else f"{len(best)} designs"
    return (
        f"<h3>All designs</h3><p>{many} that none dominates, {len(others)} dominated. Few modules, "
        "a short total length and a large robustness are better. Each is a result folder of its "
        "own, for which <code>srgc report</code> makes a page, too.</p>"
        f'{left}<div class="charts">{_figure(best, others)}</div>'
        '<div class="scroll"><table><thead><tr><th class="figure">structure</th>'
        '<th class="figure">modules</th><th class="figure">length</th>'
        '<th class="figure">robustness</th><th>word</th><th>folder</th><th>dominated by</th></tr>'
        f"</thead><tbody>{rows}</tbody></table></div>"
    )


def _row(one: Mapping[str, Any]) -> str:
    return (
        f'<tr data-design="{one["structure"]}"><td class="figure">{one["structure"]}</td>'
        f'<td class="figure">{one["modules"]}</td>'
        f'<td class="figure">{number(one["total_length"])} m</td>'
        f'<td class="figure">{number(one["robustness"])}</td>'
        f'<td class="word">{text(" ".join(one["word"]))}</td>'
        f"<td><code>{text(one['folder'])}</code></td><td>{one.get('dominated_by', '')}</td></tr>"
    )


def _figure(best: list[Mapping[str, Any]], others: list[Mapping[str, Any]]) -> str:
    points = [
        Point(each["total_length"], each["robustness"], mark, _says(each))
        for mark, group in (("good", others), ("design", best))
        for each in group
    ]
    chart = scatter_chart(points, "total length", "total length (m)")
    return (
        "<figure><figcaption><span>robustness over total length; diamonds: none is better"
        f"</span></figcaption>{chart}</figure>"
    )


def _says(one: Mapping[str, Any]) -> str:
    return f"structure {one['structure']}, {one['modules']} modules: {' '.join(one['word'])}"
