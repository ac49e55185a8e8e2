"""Results side by side, as a table with a sentence about it, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

from srgc.comparisons.side_by_side import Measure, SideBySide, Standing

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


def side_by_side_text(found: SideBySide) -> str:
    """The results, the values of their designs with the best marked, and which dominates which."""
    names = labels(len(found.standings))
    lines = [line for name, each in zip(names, found.standings, strict=True)
             for line in _said(name, each)]  # fmt: skip
    rows = [*_measured(found), *_parameters(found)]
    if rows:
        lines += ["", *_table(["", *names], rows)]
    return "\n".join([*lines, "", *sentences(found)])


def labels(count: int) -> list[str]:
    """Short names for ``count`` results: letters, then numbers."""
    return list(LETTERS[:count]) if count <= len(LETTERS) else [str(k + 1) for k in range(count)]


def _said(name: str, standing: Standing) -> Iterator[str]:
    yield f"{name}: {standing.folder}, task {standing.task}: {standing.verdict}"
    said = standing.reason if standing.word is None else " ".join(standing.word)
    yield f"   {said}"


def _measured(found: SideBySide) -> Iterator[list[str]]:
    """A row for each measure, with the best values marked."""
    for measure in found.measures:
        best = found.best(measure)
        cells = []
        for k, each in enumerate(found.standings):
            figure = each.figures.get(measure.name)
            cells.append("-" if figure is None else f"{figure.shown}{' *' if k in best else '  '}")
        yield [_heading(measure), *cells]


def _heading(measure: Measure) -> str:
    return f"{measure.word} ({measure.unit})" if measure.unit else measure.word


def _parameters(found: SideBySide) -> Iterator[list[str]]:
    """A row for each parameter of any design."""
    keys = sorted({(at, name, unit) for s in found.standings for at, name, _, unit in s.parameters})
    for at, name, unit in keys:
        values = [
            {(p[0], p[1]): p[2] for p in each.parameters}.get((at, name))
            for each in found.standings
        ]
        cells = ["-" if value is None else f"{value:.5g}  " for value in values]
        yield [f"{at}.{name}" + ("" if unit == "1" else f" ({unit})"), *cells]


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Rows with aligned numbers, and room for the mark of the best."""
    lines = [[head[0], *(f"{name}  " for name in head[1:])], *rows]
    padded = [[row[0], *(f"{cell}  " if cell == "-" else cell for cell in row[1:])]
              for row in lines]  # fmt: skip
    widths = [max(len(row[k]) for row in padded) for k in range(len(head))]
    for first, *cells in padded:
        rest = "  ".join(f"{cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True))
        yield f"{first:<{widths[0]}}  {rest}".rstrip()


# --- The verdict, in sentences --------------------------------------------------------------------


def sentences(found: SideBySide) -> list[str]:
    """Which design is better, and what prevents a comparison."""
    names = labels(len(found.standings))
    said = [_verdict(found, names)]
    if len(found.tasks) > 1:
        tasks = ", ".join(found.tasks)
        said.append(f"Their tasks differ ({tasks}): who does one need not do another.")
    elif not found.same_spec:
        said.append("Their specifications differ.")
    return said


def _verdict(found: SideBySide, names: Sequence[str]) -> str:
    designs = found.found
    if not designs:
        return "None of them has a design."
    if len(designs) == 1:
        return f"Only {names[designs[0]]} has a design."
    if len(designs) == 2:
        return _of_two(found, names, *designs)
    return _of_many(found, names)


def _of_two(found: SideBySide, names: Sequence[str], one: int, other: int) -> str:
    if found.less(other, one) and not found.less(one, other):
        one, other = other, one
    a, b = names[one], names[other]
    mine, theirs = found.less(one, other), found.less(other, one)
    if not mine:
        words = _and([each.word for each in found.decisive])
        return f"{a} and {b} have as much of each: {words}."
    if theirs:
        return f"{a} has {_amounts(mine)}, {b} {_amounts(theirs)}: neither dominates."
    same = [_as_much(each) for each in found.decisive if each not in mine]
    rest = f", and {_and(same)}" if same else ""
    return f"{a} has {_amounts(mine)}{rest}: it dominates {b}."


def _of_many(found: SideBySide, names: Sequence[str]) -> str:
    front = [names[k] for k in found.found if found.dominated_by(k) is None]
    parts = []
    for k in found.found:
        by = found.dominated_by(k)
        if by is not None:
            parts.append(f"{names[by]} dominates {names[k]}")
    by_what = _and([each.word for each in found.decisive])
    if not parts:
        return f"By {by_what} none dominates another."
    return f"By {by_what} none dominates {_and(front)}; {'; '.join(parts)}."


def _amounts(measures: Sequence[Measure]) -> str:
    """Less of some measures, in words."""
    return _and([_less(measure) for measure in measures])


def _less(measure: Measure) -> str:
    return "fewer modules" if measure.name == "modules" else f"less {measure.word}"


def _as_much(measure: Measure) -> str:
    return "as many modules" if measure.name == "modules" else f"as much {measure.word}"


def _and(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


# --- As JSON --------------------------------------------------------------------------------------


def side_by_side_json(found: SideBySide) -> str:
    """The comparison as JSON; results are counted from 0."""
    content = {
        "results": [_result(each, found.measures) for each in found.standings],
        "measures": [
            {
                "name": each.name,
                "unit": each.unit,
                "objective": each.objective,
                "least": list(found.best(each)),
            }
            for each in found.measures
        ],
        "compared_by": [each.name for each in found.decisive],
        "dominated_by": [
            None if each.word is None else found.dominated_by(k)
            for k, each in enumerate(found.standings)
        ],
        "same_spec": found.same_spec,
        "says": sentences(found),
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _result(standing: Standing, measures: Sequence[Measure]) -> dict[str, Any]:
    values = {
        each.name: standing.figures[each.name].value
        for each in measures
        if each.name in standing.figures
    }
    return {
        "folder": str(standing.folder),
        "verdict": standing.verdict,
        "reason": standing.reason,
        "task": standing.task,
        "word": None if standing.word is None else list(standing.word),
        "values": values,
        "parameters": [
            {"symbol": at, "name": name, "value": value, "unit": unit}
            for at, name, value, unit in standing.parameters
        ],
    }
