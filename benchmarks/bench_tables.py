"""What solvers made of the benchmark set, as tables in Markdown and as curves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from statistics import median
from typing import Any

from bench_solvers import CHECKED, Task, tasks

Told = Mapping[str, Any]
Answers = Mapping[str, Mapping[str, Told]]
SOLVED = {"found", "impossible"}
TITLES = {
    "links": "links of the arm",
    "cells": "obstacles",
    "modules": "modules of the kit",
    "horizon": "steps",
}
"""What the families that grow are measured by."""


def solved(told: Told | None) -> bool:
    """Whether an answer is a verdict with evidence that was checked."""
    return told is not None and told["verdict"] in SOLVED and told.get("evidence") in CHECKED


def is_wrong(told: Told, task: Task) -> bool:
    """Whether an answer contradicts what is known, or its evidence was refused."""
    known = task.known in SOLVED and told["verdict"] in SOLVED and told["verdict"] != task.known
    return known or told.get("evidence") == "refused"


def gap(told: Told) -> float | None:
    """How much of the value of an objective is above what is proved, in parts of it."""
    value, bound = told.get("value"), told.get("bound")
    if value is None or bound is None:
        return None
    return 0.0 if value == bound else (value - bound) / abs(value)


def page(content: Mapping[str, Any]) -> str:
    """All tables."""
    answers: Answers = content["answers"]
    every = {
        name: task for name, task in tasks().items() if any(name in a for a in answers.values())
    }
    parts = [summary(answers, every)]
    if len(answers) > 1:
        parts.append(ablation(answers, every))
    parts += [f"### {name}\n\n{per_task(own, every)}" for name, own in answers.items()]
    head = (
        f"{content['limit_cpu_seconds']} s of processor time for each task; {content['machine']}."
    )
    return "\n\n".join([head, *parts]) + "\n"


def table(head: Iterable[str], rows: Iterable[Iterable[object]], right: int) -> str:
    """A table whose columns from ``right`` on are numbers."""
    titles = list(head)
    marks = ["---" if place < right else "--:" for place in range(len(titles))]
    lines = [titles, marks, *([str(cell) for cell in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def summary(answers: Answers, every: Mapping[str, Task]) -> str:
    """Solvers by families: solved of all, and wrong answers."""
    families = list(dict.fromkeys(task.family for task in every.values()))
    rows = []
    for name, own in answers.items():
        counts = []
        for family in families:
            members = [task for task in every.values() if task.family == family]
            good = sum(solved(own.get(task.name)) for task in members)
            counts.append(f"{good}/{len(members)}")
        wrong = sum(is_wrong(told, every[task]) for task, told in own.items())
        rows.append([name, *counts, sum(map(solved, own.values())), wrong])
    return table(["solver", *families, "solved", "wrong"], rows, 1)


def ablation(answers: Answers, every: Mapping[str, Task]) -> str:
    """Each solver against the first: what it loses, gains, and its time where both solve a task."""
    (first, base), *others = answers.items()
    rows = []
    for name, own in others:
        both = [task for task in every if solved(own.get(task)) and solved(base.get(task))]
        lost = [task for task in every if solved(base.get(task)) and not solved(own.get(task))]
        more = [task for task in every if solved(own.get(task)) and not solved(base.get(task))]
        ratios = [own[t]["cpu_seconds"] / max(base[t]["cpu_seconds"], 0.1) for t in both]
        times = [f"{median(ratios):.2f}", f"{max(ratios):.1f}"] if ratios else ["-", "-"]
        rows.append([name, ", ".join(lost) or "-", ", ".join(more) or "-", len(both), *times])
    head = [
        "solver",
        f"solved by {first} alone",
        "solved by it alone",
        "both",
        "median ratio",
        "largest",
    ]
    return table(head, rows, 3)


def per_task(own: Mapping[str, Told], every: Mapping[str, Task]) -> str:
    """A line for each task."""
    rows = []
    for name, told in own.items():
        task, far = every[name], gap(told)
        verify = told.get("verify_cpu_seconds")
        verdict = f"**{told['verdict']} (wrong)**" if is_wrong(told, task) else told["verdict"]
        rows.append([
            name, task.known, verdict, told.get("evidence", "-"), told.get("size", "-"),
            told["cpu_seconds"], "-" if verify is None else verify,
            "-" if far is None else f"{100 * far:.1f} %",
        ])  # fmt: skip
    head = ["task", "known", "verdict", "evidence", "size", "seconds", "verified in", "gap"]
    return table(head, rows, 5)


def draw_curves(content: Mapping[str, Any], path: Path) -> None:
    """Times over the sizes of the families that grow, a curve for each solver."""
    every, answers = tasks(), content["answers"]
    good = {task for own in answers.values() for task, told in own.items() if solved(told)}
    present = [family for family in TITLES if any(every[task].family == family for task in good)]
    if not present:
        return
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    with mpl.rc_context({"svg.hashsalt": "srgc", "svg.fonttype": "none", "font.size": 9}):
        figure, axes = plt.subplots(
            1, len(present), figsize=(3.2 * len(present), 3.2), squeeze=False
        )
        for panel, family in zip(axes.flat, present, strict=True):
            for name, own in answers.items():
                points = sorted(
                    (every[task].size or 0, told["cpu_seconds"] if solved(told) else math.nan)
                    for task, told in own.items()
                    if every[task].family == family
                )
                panel.plot(*zip(*points, strict=True), marker="o", markersize=3, label=name)
            panel.set(xlabel=TITLES[family], ylabel="seconds", xscale="log", yscale="log")
            sizes = sorted({task.size or 0 for task in every.values() if task.family == family})
            panel.set_xticks(sizes, [str(size) for size in sizes])
            panel.minorticks_off()
        axes.flat[0].legend(frameon=False)
        figure.tight_layout()
        figure.savefig(path, format="svg", metadata={"Date": None})
        plt.close(figure)
