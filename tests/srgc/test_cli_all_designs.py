"""``synth --all``: the table of all designs, and a folder of results for each."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import pytest

from solvers.search.search_state import StructureState
from srgc.results.pareto_front import (
    Figure,
    ParetoRow,
    judged,
    rounded_figure,
    whole_figure,
)
from tests.oracles import result_files
from tests.oracles.extended_arm import extended_arm
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]
OBJECTIVES = ("modules", "total_length", "robustness")


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_tables_say_what_the_folders_say(designs: Path) -> None:
    content = result_files.read(designs, "pareto.json")
    assert content["objectives"] == list(OBJECTIVES)
    assert content["ended"] is None
    (best,), (other,) = content["designs"], content["dominated"]
    assert (best["structure"], other["structure"], other["dominated_by"]) == (0, 1, 0)
    for entry, modules in ((best, 4), (other, 5)):
        design = result_files.read(designs / entry["folder"], "design.json")
        assert entry["word"] == design["word"]
        assert entry["modules"] == modules
        assert entry["robustness"] == design["robustness"]
        # The arm is straight: its length is the sum of those of its links.
        lengths = [parameter["value"] for parameter in design["parameters"]]
        assert [parameter["value"] for parameter in entry["parameters"]] == lengths
        assert entry["total_length"] == pytest.approx(sum(lengths), rel=1e-14)
    (row,) = table(designs / "pareto.csv")
    assert list(row) == ["structure", *OBJECTIVES, "word", "folder"]
    assert [row["structure"], row["folder"]] == ["0", "designs/0"]
    assert float(row["robustness"]) == best["robustness"]


def test_every_design_is_verified_by_itself(srgc: Srgc, designs: Path) -> None:
    for number in (0, 1):
        ran = srgc("verify", designs / "designs" / str(number))
        assert (ran.status, ran.out.splitlines()[0]) == (0, "valid: found, level validated")
        design = result_files.read(designs / "designs" / str(number), "design.json")
        (tried,) = design["structures_tried"]
        assert (tried["verdict"], tried["word"]) == ("found", design["word"])
    assert srgc("verify", designs).status == 0


def test_the_first_design_is_the_same_without_all(
    srgc: Srgc, designs_made: Path, tmp_path: Path
) -> None:
    alone, every = tmp_path / "alone", designs_made / "out"
    assert srgc("synth", designs_made / "arm.srg", "-o", alone).status == 0
    for name in ("certificate.json", "trajectory.csv"):
        assert (alone / name).read_bytes() == (every / name).read_bytes()
    one, more = (result_files.read(folder, "design.json") for folder in (alone, every))
    assert [len(one["structures_tried"]), len(more["structures_tried"])] == [1, 2]
    assert [one["all_designs"], more["all_designs"]] == [False, True]
    changed = {key for key in one if one[key] != more[key]}
    assert changed == {"structures_tried", "iterations", "all_designs"}
    assert not (alone / "designs").exists()
    assert not (alone / "pareto.csv").exists()


def test_lemmas_of_the_family_are_none_of_a_design(srgc: Srgc, spec, tmp_path: Path) -> None:
    """The link is needed, which is learnt; a design's own folder tells of its one structure."""
    path = spec(
        replaced(TURNER, "effort <= 10 N*m", "modules <= 4; effort <= 10 N*m"), "turner.srg"
    )
    out = tmp_path / "out"
    assert srgc("synth", path, "--all", "-o", out).status == 0
    whole = result_files.read(out, "design.json")
    assert [lemma["condition"] for lemma in whole["lemmas"]] == ["count(L) <= 0"]
    (alone,) = (out / "designs").iterdir()
    design = result_files.read(alone, "design.json")
    assert "lemmas" not in design
    assert [tried["verdict"] for tried in design["structures_tried"]] == ["found"]
    assert srgc("verify", alone).status == 0


def test_a_folder_of_the_other_kind_is_refused(srgc: Srgc, designs: Path, spec) -> None:
    path = spec(extended_arm("[0.5, 1]"), "arm.srg")
    ran = srgc("synth", path, "-o", designs)
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert "for all designs or for the first" in ran.err
    assert srgc("synth", path, "-o", designs, "--force").status == 0
    assert not (designs / "designs").exists()
    assert not (designs / "pareto.json").exists()


def content(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != "log.json"
    }


def test_a_time_limit_leaves_the_first_design_and_the_next_run_goes_on(
    srgc: Srgc, designs_made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limit is reached when the second structure begins; in the end all bytes are the same."""
    from compiler.time_limits.time_limit import OutOfTimeError
    from solvers.search.structure_search import StructureSearch

    path, folder = designs_made / "arm.srg", tmp_path / "out"
    given = StructureSearch.states

    def late(self: StructureSearch, effectors: Sequence[int]) -> Iterator[StructureState]:
        if self.given.number:
            raise OutOfTimeError
        return given(self, effectors)

    with monkeypatch.context() as patched:
        patched.setattr(StructureSearch, "states", late)
        ran = srgc("synth", path, "--all", "-o", folder)
    assert ran.status == 0
    assert "not all structures were tried: the time limit was reached" in ran.out
    assert result_files.read(folder, "pareto.json")["ended"] == "the time limit was reached"
    assert (folder / "journal.jsonl").exists()
    assert srgc("verify", folder).status == 0
    ran = srgc("synth", path, "--all", "-o", folder)
    assert ran.status == 0
    assert content(folder) == content(designs_made / "out")
    assert "designs/1/certificate.json" in content(folder)


def test_the_table_is_printed(designs_made: Path) -> None:
    lines = (designs_made / "stdout").read_text(encoding="utf-8").splitlines()
    start = lines.index("designs: 2")
    assert lines[start + 1].split() == [
        "structure",
        "modules",
        "length",
        "(m)",
        "robustness",
        "robot",
    ]
    assert lines[start + 2].split()[:2] == ["0", "4"]
    assert lines[start + 3] == "dominated:"
    assert lines[start + 4].endswith("(by 0)")


def test_evaluations_are_kept_by_structure(designs: Path) -> None:
    rows = table(designs / "evaluations.csv")
    assert list(rows[0]) == ["structure", "path", "4.length", "6.length", "rho", "feasible"]
    assert {row["structure"] for row in rows} == {"0", "1"}
    for row in rows:
        assert (row["6.length"] == "") == (row["structure"] == "0")
        assert 1 <= Fraction(row["4.length"]) <= 2
        assert row["feasible"] == str(int(float(row["rho"]) >= 0))
    own = table(designs / "designs" / "1" / "evaluations.csv")
    both = [row for row in rows if row["structure"] == "1"]
    assert [row["rho"] for row in own] == [row["rho"] for row in both]
    assert {row["structure"] for row in own} == {"0"}


def test_impossible_has_no_table(srgc: Srgc, spec, tmp_path: Path) -> None:
    from tests.oracles.small_specs import BEYOND_REACH

    assert srgc("synth", spec(BEYOND_REACH), "--all", "-o", tmp_path / "out").status == 3
    assert srgc("verify", tmp_path / "out", "--trust", "z3").status == 0
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert not names & {"pareto.csv", "pareto.json", "designs"}
    assert json.loads((tmp_path / "out" / "design.json").read_text())["all_designs"] is True


def usual(modules: int, length: float, robustness: float) -> tuple[Figure, ...]:
    return (
        whole_figure(modules), rounded_figure(length), rounded_figure(robustness, large=True),
    )  # fmt: skip


def test_dominance_is_that_of_all_pairs() -> None:
    """Against the definition, on all points of a grid; equals do not dominate each other."""
    grid = list(product((4, 5), (1.0, 1.5, 2.0), (0.1, 0.2)))
    points = [*grid, grid[0]]
    rows = [ParetoRow(i, ("B",), (), usual(*point)) for i, point in enumerate(points)]
    for row, (m, length, rho) in zip(judged(rows), points, strict=True):
        better = [
            i
            for i, (a, b, c) in enumerate(points)
            if a <= m and b <= length and c >= rho and (a, b, c) != (m, length, rho)
        ]
        assert row.dominated_by == (better[0] if better else None)


def test_what_is_below_the_digits_shown_decides_nothing() -> None:
    one = ParetoRow(0, ("B",), (), usual(4, 1.2384, 0.65661))
    more = replace(one, structure=1, figures=usual(5, 1.2384, 0.65663))
    assert [row.dominated_by for row in judged([one, more])] == [None, 0]
