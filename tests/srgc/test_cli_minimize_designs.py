"""``synth --all`` and ``synth --pareto`` of tasks that say what is to be least."""

from __future__ import annotations

import csv
import random
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

import srgc as api
from compiler.expressions.exact_numbers import Bounds
from grammar_lang import ir
from srgc.results.pareto_front import ParetoRow, judged, objective_figure
from tests.oracles import result_files
from tests.oracles.priced_slides import DOMINATED, FRONT, KINDS, priced_slides, word
from tests.oracles.slides import slides
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]
PRICE, MASS, EFFORT = (
    ir.Objective(kind, attribute="price" if kind == "sum" else None)
    for kind in ("sum", "mass", "effort")
)


def values(kind: str) -> list[float]:
    """The price and the mass of a robot, by hand."""
    mass, price = KINDS[kind]
    return [price, mass]


def kinds(entries: list[dict[str, object]]) -> list[str]:
    return [str(entry["word"][2]) for entry in entries]  # type: ignore[index]


def test_all_designs_are_compared_by_what_is_to_be_least(srgc: Srgc, priced: Path) -> None:
    content = result_files.read(priced, "pareto.json")
    assert (content["objectives"], content["units"]) == (["sum(price)", "mass"], ["", "kg"])
    assert content["ended"] is None
    assert kinds(content["designs"]) == list(FRONT)
    assert kinds(content["dominated"]) == [DOMINATED]
    for entry in (*content["designs"], *content["dominated"]):
        kind = entry["word"][2]
        assert entry["values"] == values(kind)
        alone = result_files.read(priced / entry["folder"], "design.json")
        assert alone["word"] == entry["word"]
        assert [each["value"] for each in alone["objectives"]] == values(kind)
        assert srgc("verify", priced / entry["folder"]).status == 0
    best = result_files.read(priced, "design.json")
    assert best["word"] == content["designs"][0]["word"] == word("Heavy").split()
    assert content["chosen"] == content["designs"][0]["structure"]
    with (priced / "pareto.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["structure", "sum(price)", "mass (kg)", "word", "folder"]
    assert [[float(cell) for cell in row[1:3]] for row in rows] == [values(kind) for kind in FRONT]


def test_the_table_names_objectives_with_their_units(priced_made: Path) -> None:
    lines = (priced_made / "stdout").read_text(encoding="utf-8").splitlines()
    start = lines.index("designs: 3")
    assert lines[start + 1] == "structure price mass (kg)  robot"
    assert lines[start + 2].split()[1:3] == ["10", "4"]
    assert lines[start + 3].split()[1:3] == ["30", "2"]
    assert lines[start + 4] == "dominated:"
    assert lines[start + 5].endswith(f"{word(DOMINATED)} (by 1)")


def test_the_front_alone_is_kept(srgc: Srgc, spec, tmp_path: Path, priced: Path) -> None:
    out = tmp_path / "front"
    ran = srgc("synth", spec(priced_slides()), "--pareto", "-o", out)
    assert ran.status == 0
    assert "dominated: 1 design, named in pareto.json" in ran.out
    assert word(DOMINATED) not in ran.out
    content, whole = (result_files.read(each, "pareto.json") for each in (out, priced))
    assert content["designs"] == whole["designs"]
    (other,) = content["dominated"]
    assert other == whole["dominated"][0] | {"folder": None}
    names = sorted(path.name for path in (out / "designs").iterdir())
    assert names == sorted(str(entry["structure"]) for entry in content["designs"])
    assert result_files.read(out, "design.json")["front"] is True
    assert srgc("verify", out).status == 0
    refused = srgc("synth", spec(priced_slides()), "--all", "-o", out)
    assert refused.status == 2
    assert "for all designs or for those that none dominates" in refused.err
    page = srgc("report", out)
    assert page.status == 0


@pytest.mark.usefixtures("without_pictures")
def test_without_objectives_it_is_the_front_of_the_usual_table(srgc: Srgc, spec, tmp_path: Path):
    """The lighter slide is as small and more robust."""
    two = slides("const mass = 4 kg; const mass = 2 kg", kinds="Slow Fast")
    out = tmp_path / "out"
    assert srgc("synth", spec(two), "--pareto", "-o", out).status == 0
    content = result_files.read(out, "pareto.json")
    assert content["objectives"] == ["modules", "total_length", "robustness"]
    assert (kinds(content["designs"]), kinds(content["dominated"])) == (["Fast"], ["Slow"])
    assert "values" not in content["designs"][0]
    assert [path.name for path in (out / "designs").iterdir()] == ["1"]
    assert srgc("report", out).status == 0


@pytest.mark.usefixtures("without_pictures")
def test_of_one_objective_the_front_is_the_least(srgc: Srgc, spec, tmp_path: Path) -> None:
    out = tmp_path / "out"
    text = priced_slides("minimize mass;")
    assert srgc("synth", spec(text), "--pareto", "-o", out).status == 0
    content = result_files.read(out, "pareto.json")
    assert kinds(content["designs"]) == ["Light"]
    assert kinds(content["dominated"]) == ["Heavy", "Worse"]
    assert result_files.read(out, "design.json")["word"] == word("Light").split()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--gap", "5 %"), "the task has `minimize`"),
        (("--gap", "5 %", "--pareto"), "--pareto does not go with --gap"),
        (("--gap", "5 %", "--all"), "--all does not go with --gap"),
    ],
)
def test_a_gap_of_robustness_is_refused(options, says, srgc: Srgc, spec, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ran = srgc("synth", spec(priced_slides()), *options, "-o", out)
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert says in ran.err
    assert not out.exists()


def test_in_python_too(spec, tmp_path: Path) -> None:
    program = api.load(spec(priced_slides()))
    with pytest.raises(api.SrgcError, match="the task has `minimize`"):
        api.synthesize(program, gap=5)
    with pytest.raises(api.SrgcError, match="`pareto` does not go with `gap`"):
        api.synthesize(program, gap=5, pareto=True)


# --- Dominance ------------------------------------------------------------------------------------


def row(number: int, objectives: tuple[ir.Objective, ...], bounds: list[Bounds]) -> ParetoRow:
    figures = (objective_figure(each, own) for each, own in zip(objectives, bounds, strict=True))
    return ParetoRow(number, ("B",), (), tuple(figures))


@pytest.mark.parametrize("seed", range(20))
def test_the_front_never_has_a_design_that_another_dominates(seed: int) -> None:
    """Against the definition: exact prices and masses, efforts to four digits."""
    draw = random.Random(seed)
    points = [
        (
            Fraction(draw.randint(1, 6), 3),
            Fraction(draw.choice(("1.00001", "1.00002", "2"))),
            draw.choice((0.11111, 0.11113, 0.2, 0.3)),
        )
        for _ in range(30)
    ]
    rows = [
        row(i, (PRICE, MASS, EFFORT), [(a, a), (b, b), (Fraction(str(c)),) * 2])
        for i, (a, b, c) in enumerate(points)
    ]
    keys = [(a, b, float(f"{c:.4g}")) for a, b, c in points]
    for judgement, own in zip(judged(rows), keys, strict=True):
        better = [
            i
            for i, other in enumerate(keys)
            if other != own and all(x <= y for x, y in zip(other, own, strict=True))
        ]
        assert judgement.dominated_by == (better[0] if better else None)


def test_what_is_exact_is_compared_as_it_is() -> None:
    near = Fraction(10**9 + 1, 10**9)
    one, more = (row(i, (MASS,), [(v, v)]) for i, v in enumerate((Fraction(1), near)))
    assert [each.dominated_by for each in judged([one, more])] == [None, 0]
    rounded = row(1, (MASS,), [(Fraction(1), near)])
    assert [each.dominated_by for each in judged([one, rounded])] == [None, None]
