"""``srgc compare``: results side by side, against masses and prices by hand."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from srgc.comparisons.side_by_side import Measure, SideBySide, Standing
from srgc.comparisons.side_by_side_text import labels, sentences
from srgc.results.pareto_front import rounded_figure
from tests.oracles.priced_slides import KINDS, word
from tests.oracles.slides import slides
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]


def table(srgc: Srgc, *folders: Path) -> dict[str, Any]:
    ran = srgc("compare", *folders, "--json")
    assert (ran.status, ran.err) == (0, "")
    found: dict[str, Any] = json.loads(ran.out)
    return found


@pytest.fixture
def of(priced: Path) -> Callable[[str], Path]:
    """The folder of the slide of a kind."""
    content = json.loads((priced / "pareto.json").read_text(encoding="utf-8"))
    entries = [*content["designs"], *content["dominated"]]
    return lambda kind: next(priced / each["folder"] for each in entries if kind in each["word"])


def test_two_designs_of_which_none_dominates(srgc: Srgc, of) -> None:
    found = table(srgc, of("Heavy"), of("Light"))
    for one, kind in zip(found["results"], ("Heavy", "Light"), strict=True):
        mass, price = KINDS[kind]
        assert (one["verdict"], one["task"], one["word"]) == ("found", "Go", word(kind).split())
        values = one["values"]
        assert (values["sum(price)"], values["mass"]) == (price, mass)
        assert (values["modules"], values["time"]) == (3, pytest.approx(2))
        # The least force is 4 m d / T^2, of 20 N.
        assert values["effort"] == pytest.approx(4 * mass * 0.8 / 4 / 20, rel=1e-3)
    by_name = {each["name"]: each for each in found["measures"]}
    assert by_name["sum(price)"] == {
        "name": "sum(price)", "unit": "", "objective": True, "least": [0],
    }  # fmt: skip
    assert (by_name["mass"]["unit"], by_name["mass"]["least"]) == ("kg", [1])
    assert (by_name["modules"]["objective"], by_name["modules"]["least"]) == (False, [])
    assert found["compared_by"] == ["sum(price)", "mass"]
    assert found["dominated_by"] == [None, None]
    assert found["says"] == ["A has less price, B less mass: neither dominates."]


def test_one_that_dominates_whatever_the_order(srgc: Srgc, of) -> None:
    for folders, dominated in ((("Heavy", "Worse"), [None, 0]), (("Worse", "Heavy"), [1, None])):
        found = table(srgc, *map(of, folders))
        assert found["dominated_by"] == dominated
        better, worse = ("A", "B") if dominated[0] is None else ("B", "A")
        assert found["says"] == [f"{better} has less price and less mass: it dominates {worse}."]


def test_three_with_their_table(srgc: Srgc, of) -> None:
    folders = [of(kind) for kind in ("Heavy", "Light", "Worse")]
    ran = srgc("compare", *folders)
    assert ran.status == 0
    lines = ran.out.splitlines()
    assert lines[:2] == [f"A: {folders[0]}, task Go: found", f"   {word('Heavy')}"]
    rows = {line.split()[0]: line.split()[1:] for line in lines if line[:1].islower()}
    assert rows["price"] == ["10", "*", "30", "40"]
    assert rows["mass"] == ["(kg)", "4", "2", "*", "4.5"]
    assert rows["modules"] == ["3", "3", "3"]
    assert lines[-1] == "By price and mass none dominates A and B; A dominates C."


def test_a_design_and_itself(srgc: Srgc, of) -> None:
    found = table(srgc, of("Heavy"), of("Heavy"))
    assert found["says"] == ["A and B have as much of each: price and mass."]


@pytest.mark.usefixtures("without_pictures")
def test_results_of_different_tasks(srgc: Srgc, spec, of, tmp_path: Path, made) -> None:
    """The other one names no objective: designs are compared by what all have."""
    out = tmp_path / "other"
    text = slides("const mass = 1 kg").replace("task Go", "task Move")
    assert srgc("synth", spec(text), "-o", out, "--quiet").status == 0
    found = table(srgc, of("Heavy"), out)
    assert found["compared_by"] == ["modules", "mass", "effort"]
    assert "sum(price)" not in found["results"][0]["values"]
    assert found["says"] == [
        "B has less mass and less effort, and as many modules: it dominates A.",
        "Their tasks differ (Go, Move): who does one need not do another.",
    ]
    found = table(srgc, of("Heavy"), made("beyond_reach") / "out")
    assert (found["results"][1]["word"], found["results"][1]["values"]) == (None, {})
    assert found["dominated_by"] == [None, None]
    assert found["says"][0] == "Only A has a design."


def test_parameters_stand_side_by_side(srgc: Srgc, made) -> None:
    ran = srgc("compare", made("turner") / "out", made("beyond_reach") / "out")
    assert ran.status == 0
    (row,) = [line for line in ran.out.splitlines() if line.startswith("4.length")]
    assert row.split()[1] == "(m)"
    assert row.split()[-1] == "-"
    assert 1 <= float(row.split()[2]) <= 2


def test_without_any_design(srgc: Srgc, made) -> None:
    folder = made("beyond_reach") / "out"
    ran = srgc("compare", folder, folder)
    assert ran.status == 0
    assert ran.out.splitlines()[-1] == "None of them has a design."


def test_what_cannot_be_put_side_by_side(srgc: Srgc, of, tmp_path: Path) -> None:
    ran = srgc("compare", of("Heavy"))
    assert (ran.status, ran.out) == (2, "")
    assert "name another folder beside" in ran.err
    ran = srgc("compare", of("Heavy"), tmp_path)
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert "it holds no finished results" in ran.err
    certificate = of("Light") / "certificate.json"
    certificate.write_text(certificate.read_text().replace('"30"', '"29"'), encoding="utf-8")
    assert srgc("compare", of("Heavy"), of("Light")).status == 2


MEASURES = (Measure("mass", "mass", "kg", objective=True), Measure("modules", "modules", "", True))


def standing(mass: float, modules: float) -> Standing:
    figures = {"mass": rounded_figure(mass), "modules": rounded_figure(modules)}
    return Standing(Path("x"), "found", None, "T", "0", (), ("B",), figures, {}, ())


@pytest.mark.parametrize(
    ("points", "says"),
    [
        ([(1, 2), (2, 1)], "A has less mass, B fewer modules: neither dominates."),
        ([(1, 2), (1, 1)], "B has fewer modules, and as much mass: it dominates A."),
        ([(1, 3), (2, 2), (3, 1)], "By mass and modules none dominates another."),
        ([(1, 1), (2, 2), (1, 1)], "By mass and modules none dominates A and C; A dominates B."),
    ],
)
def test_sentences(points, says) -> None:
    found = SideBySide(tuple(standing(*point) for point in points), MEASURES, MEASURES)
    assert sentences(found) == [says]


def test_many_results_are_numbered() -> None:
    assert labels(3) == ["A", "B", "C"]
    assert labels(27)[-1] == "27"
