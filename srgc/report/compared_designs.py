"""The designs of ``pareto.json`` with the values they are compared by, and their table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from srgc.render.charts import Point, scatter_chart
from srgc.render.html_text import text, with_unit
from srgc.report.evidence import Evidence

DIGITS, LENGTH = 4, 12
"""Digits of numbers, and of whole numbers."""


@dataclass(frozen=True, slots=True)
class Axis:
    """A value by which designs are compared: its name, its unit, and the heading of its column."""

    name: str
    unit: str
    heading: str


USUAL = (
    Axis("modules", "", "modules"),
    Axis("total_length", "m", "length"),
    Axis("robustness", "", "robustness"),
)


@dataclass(frozen=True, slots=True)
class Compared:
    """A design with a value per axis; ``folder`` is None if it was not kept."""

    structure: int
    word: str
    values: tuple[float, ...]
    folder: str | None
    dominated_by: int | None


@dataclass(frozen=True, slots=True)
class ComparedDesigns:
    """All designs, those that no other dominates first.

    ``chosen`` is the structure that the result is about if the task has objectives, else None.
    """

    axes: tuple[Axis, ...]
    front: tuple[Compared, ...]
    dominated: tuple[Compared, ...]
    chosen: int | None
    ended: str | None

    @property
    def named(self) -> bool:
        """Whether designs are compared by the objectives of the task."""
        return self.chosen is not None


def compared_designs(evidence: Evidence) -> ComparedDesigns | None:
    """The designs of a result; None without a table of designs."""
    content = evidence.pareto
    if not content.get("designs"):
        return None
    axes: tuple[Axis, ...] = USUAL
    if "units" in content:
        pairs = zip(content["objectives"], content["units"], strict=True)
        axes = tuple(Axis(name, unit, name) for name, unit in pairs)
    front, dominated = (
        tuple(_compared(one, axes) for one in content.get(group, []))
        for group in ("designs", "dominated")
    )
    return ComparedDesigns(axes, front, dominated, content.get("chosen"), content.get("ended"))


def _compared(one: Mapping[str, Any], axes: tuple[Axis, ...]) -> Compared:
    values = one["values"] if "values" in one else [one[axis.name] for axis in axes]
    return Compared(
        one["structure"], " ".join(one["word"]), tuple(values), one["folder"],
        one.get("dominated_by"),
    )  # fmt: skip


# --- The part of the page -------------------------------------------------------------------------


def designs_part(evidence: Evidence) -> str:
    """The table of all designs and a picture of them; empty without a table."""
    designs = compared_designs(evidence)
    if designs is None:
        return ""
    front, others = designs.front, designs.dominated
    left = f"<p>Not all structures were tried: {text(designs.ended)}.</p>" if designs.ended else ""
    count = "One design" if len(front) == 1 else f"{len(front)} designs"
    better = (
        "Little of each objective is better"
        if designs.named
        else "Few modules, a short total length and a large robustness are better"
    )
    kept = "Each" if all(each.folder for each in others) else "Each of the former"
    picture = "" if designs.named else f'<div class="charts">{_figure(designs)}</div>'
    return (
        f"<h3>All designs</h3><p>{count} that none dominates, {len(others)} dominated. {better}. "
        f"{kept} is a result folder of its own, for which <code>srgc report</code> makes a page, "
        f"too.</p>{left}{picture}{designs_table(designs)}"
    )


def designs_table(designs: ComparedDesigns) -> str:
    """A row for each design."""
    heads = "".join(f'<th class="figure">{text(axis.heading)}</th>' for axis in designs.axes)
    rows = "".join(_row(each, designs.axes) for each in (*designs.front, *designs.dominated))
    return (
        f'<div class="scroll"><table><thead><tr><th class="figure">structure</th>{heads}'
        "<th>word</th><th>folder</th><th>dominated by</th></tr>"
        f"</thead><tbody>{rows}</tbody></table></div>"
    )


def _row(one: Compared, axes: tuple[Axis, ...]) -> str:
    values = "".join(
        f'<td class="figure">{shown(value, axis)}</td>'
        for value, axis in zip(one.values, axes, strict=True)
    )
    folder = "" if one.folder is None else f"<code>{text(one.folder)}</code>"
    by = "" if one.dominated_by is None else one.dominated_by
    return (
        f'<tr data-design="{one.structure}"><td class="figure">{one.structure}</td>{values}'
        f'<td class="word">{text(one.word)}</td><td>{folder}</td><td>{by}</td></tr>'
    )


def shown(value: float, axis: Axis) -> str:
    """A value with its unit, as HTML."""
    return with_unit(value, text(axis.unit), LENGTH if float(value).is_integer() else DIGITS)


def _figure(designs: ComparedDesigns) -> str:
    points = [
        Point(each.values[1], each.values[2], mark, _says(each))
        for mark, group in (("good", designs.dominated), ("design", designs.front))
        for each in group
    ]
    chart = scatter_chart(points, "total length", "total length (m)")
    return (
        "<figure><figcaption><span>robustness over total length; diamonds: none is better"
        f"</span></figcaption>{chart}</figure>"
    )


def _says(one: Compared) -> str:
    return f"structure {one.structure}, {one.values[0]} modules: {one.word}"
