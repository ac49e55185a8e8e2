"""The parts of the page of `make paper`: statistics, records, traces, the errata as a table."""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.stats import binom

from tests.oracles.html_tables import Page

ROOT = Path(__file__).resolve().parents[1]
ERRATA = (ROOT / "docs" / "explanation" / "errata.md").read_text(encoding="utf-8")
Load = Callable[[str], ModuleType]


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Load:
    """The modules of the page import each other by their bare names."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module


@pytest.mark.parametrize("count", [1, 2, 3, 5, 6, 9, 20, 21, 50])
def test_intervals_of_medians_by_the_binomial_distribution(load: Load, count: int) -> None:
    rank, coverage = load("paper.searches").order(count)

    def covered(r: int) -> float:
        return binom.cdf(count - r, count, 0.5) - binom.cdf(r - 1, count, 0.5)

    assert coverage == pytest.approx(covered(rank))
    assert coverage >= 0.95 or rank == 1
    assert covered(rank + 1) < 0.95


def test_a_median_and_its_interval(load: Load) -> None:
    """Of 20 values the interval is from the 6th to the 15th (Conover, Table A3)."""
    values = np.random.default_rng(1).permutation(np.arange(1.0, 21.0))
    found = load("paper.searches").median_of(values)
    assert (found.value, found.low, found.high) == (10.5, 6.0, 15.0)


def test_methods_are_compared_as_counted_by_hand(load: Load) -> None:
    searches, methods = load("paper.searches"), load("search_methods").COMPARED
    runs = {name: np.full((3, 4), -1.0) for name in methods}
    runs["gp-acb"] = np.array([[1, 10, 2, 3], [9.5, 0, 0, 0], [-5, -4, 9.6, 9.7]])
    runs["nelder-mead"] = np.array([[1, 2, 3, 9.5], [9.4, 9, 9, 9.5], [0, 9.9, 3, 9.95]])
    best, found = searches.compared(list(runs.values()))
    assert best == 10
    ours, theirs, worst = found[0], found[2], found[-1]
    assert (ours.method, theirs.method, worst.method) == ("gp-acb", "nelder-mead", "random")
    # 95 % of 10 is reached after 2, 1 and 3 evaluations, by Nelder-Mead after 4, 4 and 2.
    assert (ours.needed.value, ours.reached, ours.best.value) == (2, 3, 9.7)
    assert (theirs.needed.value, theirs.reached, theirs.best.value) == (4, 3, 9.5)
    assert (worst.needed.value, worst.reached) == (5, 0)
    assert ours.saved is None
    assert theirs.saved.part == pytest.approx(1 - 6 / 10)
    assert worst.saved.part == pytest.approx(1 - 6 / 15)


def test_a_saving_that_all_seeds_agree_on_has_no_spread(load: Load) -> None:
    saving = load("search_runs").saving([2, 3, 5, 8], [4, 6, 10, 16])
    assert saving.part == pytest.approx(0.5)
    assert saving.interval == pytest.approx((0.5, 0.5))
    assert saving.text == "50 (50 to 50)"


def test_a_record_is_made_once_for_what_it_is_of(load: Load, tmp_path: Path) -> None:
    kept, made = load("paper.kept_records").kept, list[int]()

    def make() -> list[int]:
        made.append(len(made))
        return [*made]

    file = tmp_path / "folder" / "record.json"
    assert kept(file, {"seed": 1}, make) == kept(file, {"seed": 1}, make) == [0]
    assert kept(file, {"seed": 2}, make) == [0, 1]
    # What an interrupted run left is no record.
    file.rename(file.with_suffix(".part"))
    assert kept(file, {"seed": 2}, make) == [0, 1, 2]


def test_seeds_that_were_finished_are_not_searched_again(
    load: Load, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    searches, asked = load("paper.searches"), list[tuple[float, ...]]()

    def hill(links: int, point: np.ndarray) -> float:
        asked.append(tuple(point))
        return -float(np.sum((point - 0.3) ** 2))

    monkeypatch.setattr(searches, "robustness", hill)
    first = searches.search_runs(tmp_path, 3, 10, 1)
    assert [values.shape for values in first] == [(3, 10)] * 6
    # What two methods ask for with one seed is evaluated once: three seeds, each point once.
    assert len(asked) == len(set(asked)) < 3 * 6 * 10
    record = json.loads((tmp_path / "seed-01.json").read_text(encoding="utf-8"))["content"]
    for run in record.values():
        lengths, values = np.array(run["lengths"]), np.array(run["values"])
        np.testing.assert_allclose(
            values, -np.sum(((lengths - 0.5) / 4.5 - 0.3) ** 2, axis=1), atol=1e-12
        )
    asked.clear()
    (tmp_path / "seed-01.json").unlink()
    again = searches.search_runs(tmp_path, 3, 10, 1)
    assert np.array_equal(first, again)
    assert 0 < len(asked) <= 60
    asked.clear()
    searches.search_runs(tmp_path, 2, 10, 1)
    assert not asked


def test_the_trace_of_a_search(load: Load) -> None:
    told = (
        "structure 0: B eps EN", "too short", "structure 3: B eps L eps EN", "path: S > a > T",
        "best robustness: -1.5 N*m", "best robustness: 2.25 N*m", "path: S > T",
    )  # fmt: skip
    algorithm = load("paper.algorithm_1")
    first, second = algorithm.structures(told)
    assert (first.number, first.symbols, first.paths) == (0, ("B", "eps", "EN"), [])
    assert (second.number, len(second.symbols)) == (3, 5)
    assert [path.cells for path in second.paths] == [("S", "a", "T"), ("S", "T")]
    assert [path.best for path in second.paths] == [[-1.5, 2.25], []]


def test_every_erratum_is_a_row(load: Load) -> None:
    table = load("paper.errata_table")
    rows = Page.of(table.errata_section(ERRATA).content).tables[0].rows
    headings = re.findall(r"^## (4\.\d+) (.+)$", ERRATA, re.MULTILINE)
    assert [row[0].split(" ", 1) for row in rows] == [[*heading] for heading in headings]
    for row in rows:
        assert len(row) == 5
        assert all(row)
        assert re.fullmatch(
            r"((Definition|Theorem|Example|Equation|Algorithm|Problem|Section) [\d.]+(, |$))+",
            row[1],
        )
        number = int(re.search(r"Shown by (\d+) tests?\.$", row[4])[1])
        own = ERRATA.split(f"\n## {row[0]}\n")[1].split("\n## ")[0]
        assert number == len(re.findall(r"`tests/[\w/]+\.py::\w+`", own))


def test_an_erratum_without_its_place_is_refused(load: Load) -> None:
    without = ERRATA.replace("**The paper.** *Theorem 2.* ", "**The paper.** ")
    assert without != ERRATA
    with pytest.raises(ValueError, match=r"4\.8 A fictitious input that hides"):
        load("paper.errata_table").errata(without)


@pytest.mark.parametrize(
    ("markdown", "html"),
    [
        ("ρ\\* of `a < b`", "ρ* of <code>a &lt; b</code>"),
        ("*no* pose & [decision 5](../d.md)", "<em>no</em> pose &amp; decision 5"),
        ("**srgc** has", "<strong>srgc</strong> has"),
        ("(N ∪ Z)\\*, *not* 2 * 3", "(N ∪ Z)*, <em>not</em> 2 * 3"),
    ],
)  # fmt: skip
def test_markdown_of_a_paragraph(load: Load, markdown: str, html: str) -> None:
    assert load("paper.section").inline_html(markdown) == html


def test_inertias_of_two_links_by_hand(load: Load) -> None:
    """Unit rods, stretched out: as printed D12 is 1/3 + 1/2, which is right for equal lengths."""
    case = load("paper.case_study")
    for matrix in (case.printed_inertia(1, 1, 0.0), case.derived_inertia(1, 1, 0.0)):
        np.testing.assert_allclose(matrix, [[8 / 3, 5 / 6], [5 / 6, 1 / 3]])
    printed, derived = case.printed_inertia(2, 1, 0.0), case.derived_inertia(2, 1, 0.0)
    assert printed[0, 1] == pytest.approx(8 / 3 + 1)
    assert derived[0, 1] == pytest.approx(1 / 3 + 1)


def test_the_graphs_have_a_circle_for_each_word(load: Load) -> None:
    """The run of nine words has two neighbours beside each but the first."""
    found = Page.of(load("paper.figure_2").figure_2().content)
    (picture,) = found.pictures
    circles = [each for each in picture.iter() if each.tag.endswith("circle")]
    nodes = {(each.get("cx"), each.get("cy")) for each in circles}
    assert len(nodes) == 9 + 2 * 8
    # The last word has an effector, and so have those beside six others; B ε EN has no joint.
    assert len(circles) - len(nodes) == 7
    red = [each for each in circles if each.get("stroke") == "#b3261e"]
    assert len({(each.get("cx"), each.get("cy")) for each in red}) == 9
    assert [row[3] for row in found.tables[0].rows] == [
        "agrees",
        "agrees",
        "corrected",
        "corrected",
    ]
