"""Small families whose least robot is known by hand."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from compiler.time_limits.time_limit import OutOfTimeError
from solvers.search.least_search import LeastSearch
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.conftest import srgc_process
from tests.oracles.least_specs import link, spec
from tests.oracles.result_files import read
from tests.oracles.slides import slides
from tests.oracles.small_specs import replaced

pytestmark = pytest.mark.usefixtures("without_pictures")

ONE = "matches Base eps Joint eps (A | B | C) eps Hand"
ARMS = "matches Base eps Joint eps (A eps | B eps)+ Hand"
QUICK = ("--paths", "2", "--evaluations", "3")
PRICES = {"A": "const price = 10;", "B": "const price = 3;"}
TWO = {"a": ("eps A", link("0.5 m", "1 kg")), "b": ("eps B", link("0.25 m", "0.3 kg"))}


def one_link(task: str, **links: tuple[str, str, str]) -> str:
    """Arms of one of three links, of a length, a mass and a price."""
    blocks = {
        name.lower(): (f"eps {name}", link(length, mass))
        for name, (length, mass, _) in links.items()
    }
    modules = {name: f"const price = {price};" for name, (*_, price) in links.items()}
    return spec(modules, blocks, task, accept=ONE)


class Found:
    """What a synthesis says of a specification, whose claim is valid."""

    def __init__(self, text: str, scratch: Path, *options: str) -> None:
        (scratch / "spec.srg").write_text(text, encoding="utf-8")
        folder = scratch / "out"
        asked = ["synth", str(scratch / "spec.srg"), "-o", str(folder), "-q", *QUICK]
        self.status = run([*asked, *options])
        report = verify_directory(folder)
        assert report.outcome is Outcome.VALID, report.reason
        self.word = read(folder)["word"]
        self.design: dict[str, Any] = read(folder, "design.json")
        (claim,) = (c for c in read(folder)["claims"] if c["kind"] == "objectives")
        self.values = [(Fraction(v["value"]), Fraction(v["least"])) for v in claim["values"]]
        self.tried = [(s["word"][4], s["verdict"]) for s in self.design["structures_tried"]]


def test_one_robot_at_two_prices(tmp_path: Path) -> None:
    """Equal robots are tried twice where they cost other sums."""
    text = one_link(
        "modules <= 4; minimize sum(price);",
        A=("0.5 m", "1 kg", "10"), B=("0.5 m", "1 kg", "4"), C=("0.5 m", "1 kg", "4"),
    )  # fmt: skip
    found = Found(text, tmp_path, "--all")
    assert found.values == [(4, 4)]
    assert found.word[4] == "B"
    assert sorted(found.tried) == [("A", "found"), ("B", "found"), ("C", "found")]
    same = [s["same_robot_as"] for s in found.design["structures_tried"]]
    assert same == [None, 0, None]


def test_ties_are_broken_by_the_order_of_words(tmp_path: Path) -> None:
    text = one_link(
        "modules <= 4; minimize sum(price);",
        A=("0.52 m", "1 kg", "5"), B=("0.5 m", "1 kg", "5"), C=("0.3 m", "1 kg", "5"),
    )  # fmt: skip
    found = Found(text, tmp_path)
    assert (found.word[4], found.values) == ("A", [(5, 5)])
    assert found.tried == [("A", "found")]


@pytest.mark.parametrize(
    ("clause", "values"),
    [
        ("sum(price) then modules", [(6, 6), (5, 5)]),
        ("sum(price) within 60 % then modules", [(6, 6), (5, 5)]),
        ("sum(price) within 70 % then modules", [(10, 6), (4, 4)]),
        ("modules then sum(price)", [(4, 4), (10, 10)]),
        ("modules within 25 % then sum(price)", [(5, 4), (6, 6)]),
        ("mass then modules", [(Fraction(3, 5), Fraction(3, 5)), (5, 5)]),
        ("mass within 66 % then modules then sum(price)",
         [(Fraction(3, 5), Fraction(3, 5)), (5, 5), (6, 6)]),
        ("mass within 67 % then modules then sum(price)",
         [(1, Fraction(3, 5)), (4, 4), (10, 10)]),
    ],
)  # fmt: skip
def test_several_objectives(
    clause: str, values: list[tuple[Fraction, Fraction]], tmp_path: Path
) -> None:
    text = spec(PRICES, TWO, f"modules <= 5; minimize {clause};", accept=ARMS)
    assert Found(text, tmp_path).values == values


def touching(**prices: str) -> str:
    """Arms of which two reach the target in one point, at its border, and one well."""
    return one_link(
        "modules <= 4; minimize sum(price);",
        A=("0.45 m", "1 kg", prices["A"]), B=("0.45 m", "2 kg", prices["B"]),
        C=("0.5 m", "1 kg", prices["C"]),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("prices", "least", "said"),
    [
        (("3", "4", "5"), 3, "least price 5, unless one of 2 undecided robots does it for less"),
        (("3", "6", "5"), 3, "least price 5, unless the undecided robot does it for less"),
        (("5", "6", "5"), 5, "least price 5"),
        (("6", "7", "5"), 5, "least price 5"),
    ],
)
def test_undecided_robots(
    prices: tuple[str, str, str],
    least: int,
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = Found(touching(**dict(zip("ABC", prices, strict=True))), tmp_path)
    assert (found.word[4], found.values) == ("C", [(5, least)])
    assert f"verdict: found ({said})\n" in capsys.readouterr().out
    (entry,) = found.design["objectives"]
    assert entry["undecided"] == sum(price < "5" for price in prices[:2])
    assert entry["all_tried"]


def test_the_time_ends_after_the_first_design(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The design stays, and nothing is claimed of other robots."""
    before = LeastSearch.prepare

    def late(search: LeastSearch, *arguments: Any) -> None:
        if search.run.every_design:
            raise OutOfTimeError
        before(search, *arguments)

    monkeypatch.setattr(LeastSearch, "prepare", late)
    text = spec(PRICES, TWO, "modules <= 5; minimize modules then sum(price);", accept=ARMS)
    found = Found(text, tmp_path)
    assert found.values == [(4, 0), (10, 0)]
    assert not any(each["all_tried"] for each in found.design["objectives"])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["alone", "learnt"])
def test_the_same_bytes_whatever_jobs_and_hashes(name: str, tmp_path: Path) -> None:
    options = ["--no-lemmas"] if name == "alone" else []
    (tmp_path / "spec.srg").write_text(
        spec(PRICES, TWO, "modules <= 6; minimize sum(price) within 10 % then mass;", accept=ARMS),
        encoding="utf-8",
    )
    found = set[tuple[str, str]]()
    for number, (seed, jobs) in enumerate([("0", "1"), ("1", "2"), ("77", "1")]):
        asked = ["synth", "spec.srg", "-o", f"out{number}", "-q", "--jobs", jobs, *options]
        with srgc_process(asked, tmp_path, PYTHONHASHSEED=seed) as process:
            process.communicate()
        assert process.returncode == 0
        folder = tmp_path / f"out{number}"
        names = sorted(str(path.relative_to(folder)) for path in folder.rglob("*.boxes"))
        texts = [(folder / each).read_text(encoding="utf-8") for each in names]
        certificate = (folder / "certificate.json").read_text(encoding="utf-8")
        found.add((certificate, "".join([*names, *texts])))
    assert len(found) == 1


SLIDES = [4, 2, 5, 6, 7, 8]
"""Masses in kg, in the order of words: the lighter a slide, the faster it is."""


def slides_for_less(minimize: str) -> str:
    """Slides of as many modules each, and the least of what words say nothing of."""
    masses = "; ".join(f"const mass = {mass} kg" for mass in SLIDES)
    text = slides(masses, kinds=" ".join(f"S{mass}" for mass in SLIDES))
    asked = f"horizon at most 20 steps of 0.1 s; minimize {minimize};"
    return replaced(text, "horizon 20 steps of 0.1 s;", asked)


def slides_tried(found: Found) -> list[str]:
    return [each["word"][2] for each in found.design["structures_tried"]]


def test_a_later_objective_of_motions_ends_at_a_limit_that_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing is proved of energies, however many robots are searched."""
    found = Found(slides_for_less("modules then energy"), tmp_path)
    assert slides_tried(found) == ["S4", "S2", "S5", "S6", "S7"]
    assert found.word[2] == "S2"
    assert [entry["all_tried"] for entry in found.design["objectives"]] == [True, False]
    said = "ended:   the search for less energy ended at its limit of 3 robots in a row that have"
    assert said in capsys.readouterr().out


def test_a_limit_is_not_named_where_nobody_has_less(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The drives show that none of the robots that were not searched is faster."""
    found = Found(slides_for_less("modules then time"), tmp_path)
    assert slides_tried(found) == ["S4", "S2", "S5", "S6", "S7"]
    (_, (value, least)) = found.values
    assert value == least
    assert all(entry["all_tried"] for entry in found.design["objectives"])
    assert "ended:" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("minimize", "options"), [("energy", ()), ("modules then energy", ("--all",))]
)
def test_all_robots_are_searched_where_that_is_asked(
    minimize: str, options: tuple[str, ...], tmp_path: Path
) -> None:
    found = Found(slides_for_less(minimize), tmp_path, *options)
    assert slides_tried(found) == [f"S{mass}" for mass in SLIDES]
    assert all(entry["all_tried"] for entry in found.design["objectives"])
