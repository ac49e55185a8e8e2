"""``srgc synth --search``: parameters by other methods."""

from __future__ import annotations

import csv
import json

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.small_specs import TURNER

pytestmark = pytest.mark.usefixtures("without_pictures")


GONE = ["gp-ucb", "particle-swarm", "simulated-annealing", "random"]


def test_another_search_finds_what_is_valid(srgc, spec, tmp_path):
    out = tmp_path / "out"
    ran = srgc("synth", spec(TURNER), "-o", out, "--search", "Nelder-Mead", "--json")
    assert ran.status == 0
    assert json.loads(ran.out)["search"] == "nelder-mead"
    assert verify_directory(out).outcome is Outcome.VALID
    with (out / "evaluations.csv").open(encoding="utf-8", newline="") as file:
        assert len(list(csv.reader(file))) > 8


def test_the_usual_search_by_name(srgc, spec, tmp_path):
    written = []
    for number, search in enumerate([[], ["--search", "gp-acb"]]):
        out = tmp_path / str(number)
        assert srgc("synth", spec(TURNER), "-o", out, *search).status == 0
        written.append((out / "design.json").read_bytes())
    assert written[0] == written[1]


@pytest.mark.parametrize("name", ["annealing", *GONE])
def test_an_unknown_search(name, srgc, spec, tmp_path):
    ran = srgc("synth", spec(TURNER), "-o", tmp_path / "out", "--search", name)
    assert ran.status == 2
    assert f"there is no parameter search `{name}`" in ran.err
    assert "known are `gp-acb` and `nelder-mead`" in " ".join(ran.err.split())
    assert not (tmp_path / "out").exists()


def test_a_folder_belongs_to_its_search(srgc, spec, tmp_path):
    file, out = spec(TURNER), tmp_path / "out"
    assert srgc("synth", file, "-o", out, "--search", "nelder-mead").status == 0
    refused = srgc("synth", file, "-o", out)
    assert refused.status == 2
    assert "another search of parameters" in refused.err
