"""Result folders that have lost one of the two files that say what was found."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import srgc as api

AGAIN = "the same `srgc synth turner.srg` again writes"


@pytest.fixture
def without_certificate(result) -> Path:
    folder: Path = result("turner")
    (folder / "certificate.json").unlink()
    return folder


@pytest.fixture
def without_design(result) -> Path:
    folder: Path = result("turner")
    (folder / "design.json").unlink()
    return folder


@pytest.mark.parametrize(
    "command", [("report",), ("export", "--to", "urdf"), ("landscape",), ("why",)]
)
def test_a_design_without_certificate_is_not_called_impossible(srgc, without_certificate, command):
    ran = srgc(*command, without_certificate)
    assert (ran.status, ran.out) == (2, "")
    assert "has lost its certificate.json, although its verdict is found" in ran.err
    assert "no robot" not in ran.err
    assert ran.err.endswith(f"hint: {AGAIN} it\n")


def test_the_advice_of_verify_is_no_circle(srgc, without_certificate):
    ran = srgc("verify", without_certificate)
    assert ran.status == 4
    assert ran.out.endswith(f"next:    {AGAIN} certificate.json\n")


def test_nothing_is_left_to_explain(srgc, without_certificate):
    (without_certificate / "design.json").unlink()
    assert srgc("why", without_certificate).status == 2
    said = srgc("verify", without_certificate).out.splitlines()[-1]
    assert said.startswith("next:    name a folder with results")


def test_the_same_synth_writes_the_certificate_again(srgc, made, without_certificate):
    ran = srgc("synth", made("turner") / "turner.srg", "-o", without_certificate, "-q")
    assert ran.status == 0
    known = (made("turner") / "out" / "certificate.json").read_bytes()
    assert (without_certificate / "certificate.json").read_bytes() == known


def test_the_same_of_an_impossible_task(srgc, result):
    folder = result("beyond_reach")
    (folder / "certificate.json").unlink()
    ran = srgc("verify", folder)
    said = "next:    the same `srgc synth beyond_reach.srg` again writes certificate.json\n"
    assert (ran.status, ran.out[-len(said) :]) == (4, said)
    assert "its verdict is impossible" in srgc("export", folder, "--to", "urdf").err


def test_a_certificate_without_design(srgc, without_design):
    """The certificate is valid, but only a new folder gets a new design.json."""
    writes = "the same `srgc synth turner.srg` into another folder writes"
    ran = srgc("verify", without_design)
    assert ran.status == 0
    assert ran.out.endswith(f"next:    {writes} design.json\n")
    for command in (("report",), ("why",), ("landscape",)):
        ran = srgc(*command, without_design)
        assert (ran.status, ran.out) == (2, "")
        assert "has lost its design.json" in ran.err
        assert ran.err.endswith(f"hint: {writes} it\n")
    assert srgc("export", without_design, "--to", "urdf").status == 0


@pytest.mark.parametrize("options", [(), ("--force",)])
def test_synth_leaves_a_certificate_without_design_alone(srgc, made, without_design, options):
    """It must not recommend `--force`, with which it refuses the folder, too."""
    before = sorted(without_design.rglob("*"))
    ran = srgc("synth", made("turner") / "turner.srg", "-o", without_design, *options)
    assert ran.status == 2
    assert ran.err.endswith("no design.json to tell whose it is; choose another folder\n")
    assert sorted(without_design.rglob("*")) == before


def test_a_mission_without_its_claim(srgc, made, tmp_path):
    folder = tmp_path / "mission"
    shutil.copytree(made("mission_both") / "out", folder)
    (folder / "mission.json").unlink()
    ran = srgc("verify", folder)
    assert ran.status == 4
    assert ran.out.endswith("again writes mission.json\n")


def test_a_certificate_of_a_mission_is_written_by_its_run(srgc, made, tmp_path):
    folder = tmp_path / "mission"
    shutil.copytree(made("mission_both") / "out", folder)
    task = min((folder / "tasks").iterdir())
    (task / "certificate.json").unlink()
    ran = srgc("export", task, "--to", "urdf")
    assert ran.status == 2
    assert ran.err.endswith(f"hint: the same run that wrote {folder} again writes it\n")


def test_from_python(without_certificate):
    with pytest.raises(api.SrgcError, match="although its verdict is found"):
        api.open_result(without_certificate).robot()


def test_a_file_that_is_no_json(srgc, result):
    folder = result("turner")
    (folder / "certificate.json").unlink()
    (folder / "design.json").write_text("[", encoding="utf-8")
    assert srgc("verify", folder).status == 4
    ran = srgc("export", folder, "--to", "urdf")
    assert (ran.status, ran.err.count("\n")) == (2, 1)
