"""What a page says of objectives, and its front of designs, against prices and masses by hand."""

from __future__ import annotations

import csv
import json
import re
import shutil
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

from srgc.cli import run
from srgc.report import front_motions
from srgc.report.evidence import read_evidence
from tests.oracles import result_files
from tests.oracles.html_page import Page
from tests.oracles.priced_slides import DOMINATED, FRONT, KINDS, priced_slides, word
from tests.srgc.conftest import Ran
from tests.srgc.report.conftest import page_of
from tests.srgc.report.test_page import sound

Srgc = Callable[..., Ran]


@pytest.fixture(scope="module")
def page(priced_made: Path) -> Page:
    return page_of(priced_made / "out")


def test_each_objective_has_its_row(page: Page) -> None:
    price, mass = (" ".join(row.text.split()) for row in page.with_attribute("data-objective"))
    assert price.startswith("price1010")
    assert price.endswith("No robot has less.")
    assert mass.startswith("mass4 kg4 kg")
    assert mass.endswith("No robot within what the objectives before it leave has less.")
    assert "were checked with the rest of the certificate, and hold" in page.section("objectives")
    assert "least is asked for: sum(price), then mass" in page.section("verdict")
    sound(page)


def test_without_a_check_nothing_is_said_to_hold(priced: Path) -> None:
    unchecked = page_of(priced, "--no-verify")
    assert "were not checked for this page" in unchecked.section("objectives")

    def cheaper(content: dict[str, Any]) -> None:
        (claim,) = [each for each in content["claims"] if each["kind"] == "objectives"]
        claim["values"][0]["value"] = claim["values"][0]["least"] = "9"

    result_files.alter(priced, cheaper, sign=True)
    design = result_files.read(priced, "design.json")
    design["objectives"][0] |= {"value": 9.0, "least": 9.0}
    result_files.write(priced, design, "design.json")
    assert "nothing is proved of them" in page_of(priced).section("objectives")


def marks(page: Page, kind: str) -> list[str]:
    """The titles of the marks of a kind in the chart."""
    drawn = [each for each in page.elements if each.name in ("path", "circle")]
    return [
        each.text
        for each in drawn
        if kind in each.attributes.get("class", "").split()
        and each.parent is not None
        and "front-chart" in each.parent.attributes.get("class", "")
    ]


def says(kind: str) -> str:
    mass, price = KINDS[kind]
    return f"{word(kind)}: price {price}, mass {mass} kg"


def test_the_chart_names_designs_with_their_values(page: Page) -> None:
    assert marks(page, "choice") == [says(kind) for kind in FRONT]
    assert marks(page, "good") == [says(DOMINATED)]
    assert len(page.all("svg", data_axes="0-1")) == 1


def test_the_chart_is_to_scale(page: Page) -> None:
    """Cheaper ones are on the left, lighter ones below."""
    choices = [each for each in page.all("path") if "data-front" in each.attributes]
    (x1, y1), (x2, y2) = (
        map(float, each.attributes["d"][1:].split("l")[0].split()) for each in choices
    )
    assert x1 < x2
    assert y1 < y2, "y goes down in a picture"


def test_a_table_does_without_scripts(page: Page) -> None:
    rows = page.with_attribute("data-front-row")
    assert [word(kind) in row.text for kind, row in zip(FRONT, rows, strict=True)] == [True] * 2
    buttons = page.all("button", class_="choice")
    assert [each.attributes["aria-label"] for each in buttons] == [
        f"Show {word(kind)}" for kind in FRONT
    ]
    (scene,) = page.all("figure", class_="front-scene screen-only")
    assert "hidden" in scene.attributes


def test_each_design_moves_as_its_folder_says(page: Page, priced_made: Path) -> None:
    data = page.data("front-data")
    assert [one["says"] for one in data["designs"]] == [says(kind) for kind in FRONT]
    for one in data["designs"]:
        table = priced_made / "out" / "designs" / str(one["structure"]) / "trajectory.csv"
        with table.open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        motion = one["motion"]
        (tip,) = motion["effectors"]
        scale = data["grid"]
        for row, points in ((rows[0], motion["points"][0]), (rows[-1], motion["points"][-1])):
            moved = points[2 * tip] - motion["points"][0][2 * tip]
            way = float(row["e1_x"]) - float(rows[0]["e1_x"])
            # A unit of the grid is so many units of the picture, of which there are many in 1 m.
            assert moved * scale == pytest.approx(way * pixels(page, data), abs=2 * scale)


def pixels(page: Page, data: dict[str, object]) -> float:
    """Units of the picture in a metre, by how wide the regions of the task are drawn."""
    (scene,) = page.all("figure", class_="front-scene screen-only")
    faces = [
        each.attributes["d"]
        for each in page.all("path", class_="face")
        if each.within("class", "front-scene screen-only")
    ]
    assert scene
    whole = faces[0]  # the bounds, 4 m wide
    numbers = [float(part) for part in re.findall(r"-?\d+(?:\.\d+)?", whole)]
    return max(map(abs, numbers[2::2])) / 4


def test_what_is_missing_is_left_out(priced: Path) -> None:
    content = result_files.read(priced, "pareto.json")
    shutil.rmtree(priced / content["designs"][1]["folder"])
    page = page_of(priced, "--no-verify")
    assert len(page.data("front-data")["designs"]) == 1
    assert "1 design cannot be shown moving: their folders are missing" in page.section(
        "objectives"
    )
    assert len(marks(page, "choice")) == 2


def test_a_folder_that_is_another_design_is_left_out(priced: Path) -> None:
    content = result_files.read(priced, "pareto.json")
    first, second = (priced / each["folder"] for each in content["designs"])
    shutil.rmtree(second)
    shutil.copytree(first, second)
    assert len(page_of(priced, "--no-verify").data("front-data")["designs"]) == 1


def test_many_designs_are_not_all_in_motion(priced: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(front_motions, "MOST_MOTIONS", 1)
    assert len(read_evidence(priced, verify=False).front) == 1


@pytest.mark.usefixtures("without_pictures")
def test_of_three_objectives_axes_are_chosen(srgc: Srgc, spec, tmp_path: Path) -> None:
    out = tmp_path / "out"
    text = priced_slides("minimize sum(price) then mass then effort;")
    assert srgc("synth", spec(text), "--all", "-o", out, "--quiet").status == 0
    page = page_of(out, "--no-verify")
    shown = ["hidden" not in each.attributes for each in page.with_attribute("data-axes")]
    pairs = [each.attributes["data-axes"] for each in page.with_attribute("data-axes")]
    assert pairs == [f"{a}-{b}" for a, b in combinations(range(3), 2)]
    assert shown == [True, False, False]
    options = [each.attributes["value"] for each in page.all("option") if "-" in
               each.attributes["value"]]  # fmt: skip
    assert options == pairs
    sound(page)


@pytest.mark.usefixtures("without_pictures")
def test_of_one_objective_there_is_no_chart(srgc: Srgc, spec, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert srgc("synth", spec(priced_slides("minimize mass;")), "--all", "-o", out).status == 0
    page = page_of(out, "--no-verify")
    assert not page.with_attribute("data-axes")
    assert len(page.with_attribute("data-front-row")) == 1
    sound(page)


def test_without_minimize_there_is_no_section(designs: Path) -> None:
    page = page_of(designs, "--no-verify")
    assert not page.all("section", id="objectives")
    assert not page.all("script", id="front-data")


@pytest.mark.parametrize(
    "change",
    [
        {"units": [1, 2]}, {"units": ["", ""], "chosen": "1"}, {"units": []},
        {"objectives": ["sum(price)"]}, {"designs": [{"structure": 1, "word": [], "folder": ""}]},
    ],
    ids=str,
)  # fmt: skip
def test_an_altered_table_is_refused(change, priced: Path) -> None:
    content = result_files.read(priced, "pareto.json")
    (priced / "pareto.json").write_text(json.dumps(content | change), encoding="utf-8")
    assert run(["report", str(priced), "--no-verify"]) == 2
