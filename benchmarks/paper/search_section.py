"""GP-ACB against the other searches: a table with intervals, and plots over evaluations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from search_runs import CLAIM, Saving

from compiler.arrays import Array
from paper.searches import OURS, SHARE, THEIRS, Compared, Median, compared, median_of, order
from paper.section import (
    Answer,
    Claim,
    Figure,
    Section,
    claims_table,
    figures_of,
    number_of,
    paragraph,
    table,
)
from srgc.render.axes import Plot, Scale, axes, labelled, titles
from srgc.render.html_text import many, text
from srgc.render.svg import SAMPLE, document, line_path

WIDTH, HEIGHT = 320.0, 190.0
LEFT, RIGHT, TOP, BELOW = 44.0, 8.0, 8.0, 40.0
FLOOR = 0.8
"""Values below this part of the best one are drawn at the lower edge."""


def search_section(runs: Sequence[Array]) -> Section:
    """The comparison; ``runs`` has the values (seeds, evaluations) of each method."""
    best, methods = compared(runs)
    seeds, budget = runs[0].shape
    rank, coverage = order(seeds)
    saved = {each.method: each.saved for each in methods if each.saved is not None}
    ours = next(each for each in methods if each.method == OURS)
    plots = [
        Figure(
            _plot(ours, other, best),
            _says(ours, other, budget),
            f"{OURS} (blue) and {text(other.method)} (orange): the median of the best value so "
            "far, with its interval.",
        )
        for other in methods
        if other.method != OURS
    ]
    intro = (
        f"{many(seeds, 'seed')}, the same for all methods, {budget} control syntheses for each "
        f"search. The best value of all is {number_of(best, 3)} N*m; a search gets there when it "
        f"has {100 * SHARE:.0f} % of that. Intervals of medians lie between order statistics, here "
        f"{_between(rank)} of {seeds}: whatever the "
        f"distribution, they hold the median with probability {100 * coverage:.1f} %. Intervals of "
        "savings are the 2.5th and the 97.5th percentile of a bootstrap over seeds; a search that "
        f"does not get there counts as {budget + 1} evaluations."
    )
    content = (
        paragraph(intro)
        + search_table(methods, seeds, budget)
        + figures_of(plots)
        + claims_table("Section 4.3: GP-ACB", _claims(saved))
    )
    return Section("searches", "GP-ACB against other searches", content)


def search_table(methods: Sequence[Compared], seeds: int, budget: int) -> str:
    """A row for each method."""
    rows = [
        (
            each.method,
            _evaluations(each.needed, budget),
            f"{each.reached} of {seeds}",
            f"{number_of(each.best.value, 3)} ({_ends(each.best, 3)})",
            "" if each.saved is None else _percent(each.saved),
        )
        for each in methods
    ]
    names = (
        "Method", f"Evaluations to {100 * SHARE:.0f} %", "Got there",
        f"Best ρ after {budget} (N*m)", f"Saving of {OURS} (%)",
    )  # fmt: skip
    return table("Medians with intervals", names, rows, numbers=(1, 2, 3, 4))


def _evaluations(one: Median, budget: int) -> str:
    shown = [
        f"&gt; {budget}" if end > budget else f"{end:g}" for end in (one.value, one.low, one.high)
    ]
    return f"{shown[0]} ({shown[1]} to {shown[2]})"


def _ends(one: Median, digits: int) -> str:
    return f"{number_of(one.low, digits)} to {number_of(one.high, digits)}"


def _percent(one: Saving) -> str:
    return one.text.replace("-", "\N{MINUS SIGN}")


def _claims(saved: dict[str, Saving]) -> list[Claim]:
    theirs, upper = saved[THEIRS], saved["gp-ucb"]
    low, high = theirs.interval
    answer: Answer
    if low > 0 and high >= CLAIM[0]:
        answer, says = "agrees", "the interval lies above 0, and reaches what the paper claims"
    elif high < CLAIM[0]:
        answer, says = "differs", "the interval lies below what the paper claims"
    else:
        answer, says = (
            "not confirmed",
            "the interval holds the claim together with no saving at all",
        )
    return [
        Claim(
            "Section 4.3",
            f"GP-ACB is {100 * CLAIM[0]:.0f} to {100 * CLAIM[1]:.0f} % faster than Nelder-Mead, on "
            "average.",
            f"On the case study it needs {_percent(theirs)} % fewer evaluations: {says}. On other "
            "functions see decision 87.",
            answer,
        ),
        Claim(
            "Section 4.3",
            "GP-ACB outperforms GP-UCB, in theory.",
            f"It needs {_percent(upper)} % fewer evaluations than GP-UCB here; as printed the rule "
            "is no confidence bound (erratum 4.12).",
            "agrees" if upper.interval[0] > 0 else "not confirmed",
        ),
        Claim(
            "Section 4.3",
            "Many other techniques may suffer from slow convergence.",
            "; ".join(f"{method}: {_percent(each)} %" for method, each in saved.items())
            + " fewer evaluations with GP-ACB.",
            "agrees" if all(each.interval[0] > 0 for each in saved.values()) else "not confirmed",
        ),
    ]


# --- the plots ------------------------------------------------------------------------------------


def _says(ours: Compared, other: Compared, budget: int) -> str:
    return (
        f"Best value so far over {budget} evaluations: at the end {OURS} has a median of "
        f"{number_of(ours.best.value, 3)} N*m, {other.method} of {number_of(other.best.value, 3)}."
    )


def _plot(ours: Compared, other: Compared, best: float) -> str:
    """Two methods over the evaluations, and the value that is to be reached."""
    budget = ours.curve.shape[1]
    across = Scale(1, max(budget, 2), LEFT, WIDTH - RIGHT)
    plot = Plot(across, Scale(FLOOR * best, best, HEIGHT - BELOW, TOP))
    y = plot.up(SHARE * best)
    goal = f'<line class="bound" x1="{plot.left:g}" x2="{plot.right:g}" y1="{y:.1f}" y2="{y:.1f}"/>'
    counts = [(value, says) for value, says in labelled(across, 6) if value.is_integer()]
    frame = axes(
        plot, counts, labelled(plot.up, 5), more=titles(plot, "evaluations", "best ρ (N*m)", 34)
    )
    marks = "".join(_curve(each, plot, k) for k, each in enumerate((other, ours)))
    legend = [
        (f'<path class="line series-{series}" d="M0 6h{SAMPLE:g}"/>', each.method)
        for series, each in ((1, ours), (2, other))
    ]
    legend.append((f'<line class="bound" x1="0" x2="{SAMPLE:g}" y1="6" y2="6"/>', "to be reached"))
    return document(f"{frame}{goal}{marks}", (WIDTH, HEIGHT), "chart", "", legend)


def _curve(one: Compared, plot: Plot, ours: int) -> str:
    series = 1 if ours else 2
    medians = [median_of(column) for column in one.curve.T]
    numbers = np.arange(1, len(medians) + 1)

    def points(values: Sequence[float]) -> Array:
        shown = np.maximum(values, plot.up.low)
        return np.array([(plot.across(n), plot.up(v)) for n, v in zip(numbers, shown, strict=True)])

    band = np.concatenate(
        [points([each.high for each in medians]), points([each.low for each in medians])[::-1]]
    )
    return (
        f'<path class="tube series-{series}" d="{line_path(band)}Z"/>'
        f'<path class="line series-{series}" d="{line_path(points([m.value for m in medians]))}"/>'
    )


def _between(rank: int) -> str:
    if rank == 1:
        return "the least and the largest"
    kind = 0 if rank % 100 in (11, 12, 13) else rank % 10
    ordinal = f"{rank}{({1: 'st', 2: 'nd', 3: 'rd'}).get(kind, 'th')}"
    return f"the {ordinal} least and the {ordinal} largest"
