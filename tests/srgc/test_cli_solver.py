"""``srgc synth --solver``: other convex solvers, by their names in cvxpy."""

from __future__ import annotations

import builtins
import json

import pytest

import solvers.backends.cvxpy_solvers
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.small_specs import SLIDER
from tests.oracles.some_cases import some

pytestmark = pytest.mark.usefixtures("without_pictures")


@pytest.mark.parametrize("name", some(["clarabel", "Osqp"], 1))
def test_another_solver_finds_what_is_valid(name, srgc, spec, tmp_path):
    out = tmp_path / "out"
    ran = srgc("synth", spec(SLIDER), "-o", out, "--solver", name, "--json")
    assert ran.status == 0
    assert json.loads(ran.out)["solver"] == name.upper()
    assert verify_directory(out).outcome is Outcome.VALID


def test_the_own_programs_need_no_cvxpy(srgc, spec, tmp_path, monkeypatch):
    honest = builtins.__import__

    def without(name, *arguments, **named):
        assert not name.startswith("cvxpy")
        return honest(name, *arguments, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    written = []
    for number, solver in enumerate([[], ["--solver", "own"], ["--solver", "OWN"]]):
        out = tmp_path / str(number)
        assert srgc("synth", spec(SLIDER), "-o", out, *solver).status == 0
        written.append((out / "design.json").read_bytes())
    assert written[0] == written[1] == written[2]
    assert json.loads(written[0])["solver"] is None


@pytest.mark.parametrize(
    ("name", "told"), [("nope", "CLARABEL"), ("", "CLARABEL"), ("scipy", "quadratic program")]
)
def test_a_solver_that_cannot_be_used(name, told, srgc, spec, tmp_path):
    ran = srgc("synth", spec(SLIDER), "-o", tmp_path / "out", "--solver", name)
    assert ran.status == 2
    assert ran.err.startswith("error: ")
    assert f"`{name.upper() if name == 'scipy' else name}`" in ran.err
    assert told in ran.err
    assert not (tmp_path / "out").exists()


def test_without_cvxpy_it_is_said_how_to_get_it(srgc, spec, tmp_path, monkeypatch):
    monkeypatch.setattr(solvers.backends.cvxpy_solvers, "find_spec", lambda _name: None)
    ran = srgc("synth", spec(SLIDER), "-o", tmp_path / "out", "--solver", "scs")
    assert ran.status == 2
    assert 'pip install "srgc[solvers]"' in ran.err


def test_a_folder_belongs_to_its_solver(srgc, spec, tmp_path):
    """Folders of earlier versions, which do not say which solver it was, are of our own."""
    file, out = spec(SLIDER), tmp_path / "out"
    assert srgc("synth", file, "-o", out).status == 0
    refused = srgc("synth", file, "-o", out, "--solver", "clarabel")
    assert refused.status == 2
    assert "another solver" in refused.err
    content = json.loads((out / "design.json").read_text(encoding="utf-8"))
    del content["solver"]
    (out / "design.json").write_text(json.dumps(content), encoding="utf-8")
    assert srgc("synth", file, "-o", out).status == 0
    assert srgc("synth", file, "-o", out, "--solver", "clarabel", "--force").status == 0
    assert srgc("synth", file, "-o", out).status == 2
