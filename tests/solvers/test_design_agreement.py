"""``design.json``, which people and programs read, held against the certificate."""

from __future__ import annotations

import math

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.result_files import read, write
from tests.oracles.small_specs import SLIDER, replaced

DESIGN_FIELDS = [
    "verdict", "task", "spec", "word", "derivation", "dofs", "parameters", "robustness",
    "effort_peak", "step", "horizon", "path", "cells", "spec_sha256",
]  # fmt: skip


@pytest.mark.parametrize("field", DESIGN_FIELDS)
def test_a_design_that_says_something_else(result, field):
    folder = result("slider")
    design = read(folder, "design.json")
    for other in (None, ["x"]):
        write(folder, design | {field: other}, "design.json")
        report = verify_directory(folder)
        assert report.outcome is Outcome.REFUTED
        assert report.reason == f"design.json and certificate.json differ in `{field}`"


def test_a_design_parameter_off_by_little(result):
    folder = result("turner")
    design = read(folder, "design.json")
    value = design["parameters"][0]["value"]
    design["parameters"][0]["value"] = math.nextafter(value, 3)
    write(folder, design, "design.json")
    assert "differ in `parameters`" in str(verify_directory(folder).reason)


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff", b"[" * 100_000, b"3"])
def test_a_design_that_is_none(result, content):
    folder = result("slider")
    (folder / "design.json").write_bytes(content)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "design.json is no" in str(report.reason)


@pytest.mark.parametrize(
    ("field", "path", "kind"),
    [
        ("horizon", ("horizon",), float),
        ("dofs", ("dofs", 0, "symbols", 0), float),
        ("parameters", ("parameters", 0, "symbol"), float),
        ("parameters", ("parameters", 0, "value"), str),
        ("effort_peak", ("effort_peak",), str),
    ],
)
def test_a_number_of_another_kind(result, field, path, kind):
    """Neither 2.0 is an index nor "2.0" a number."""
    folder = result("turner")
    design = read(folder, "design.json")
    place = design
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = kind(place[path[-1]])
    write(folder, design, "design.json")
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason == f"design.json and certificate.json differ in `{field}`"


@pytest.mark.parametrize("kind", [float, str, lambda value: value + 1])
def test_an_index_of_an_equal_robot(result, kind):
    folder = result("beyond_reach")
    design = read(folder, "design.json")
    equal = [s for s in design["structures_tried"] if s["same_robot_as"] is not None]
    assert equal
    equal[0]["same_robot_as"] = kind(equal[0]["same_robot_as"])
    write(folder, design, "design.json")
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "differ in `structures_tried`" in str(report.reason)


@pytest.mark.parametrize(
    ("value", "outcome"), [(1, Outcome.VALID), (1.0, Outcome.VALID), (True, Outcome.REFUTED)]
)
def test_a_writer_that_drops_zeros(tmp_path, value, outcome):
    """1 says of a step what 1.0 does; true says nothing of one."""
    spec, folder = tmp_path / "slider.srg", tmp_path / "out"
    text = replaced(SLIDER, "horizon 10 steps of 0.2 s", "horizon 3 steps of 1 s")
    spec.write_text(text, encoding="utf-8")
    assert run(["synth", str(spec), "-o", str(folder)]) == 0
    design = read(folder, "design.json")
    assert isinstance(design["step"], float)
    write(folder, design | {"step": value}, "design.json")
    assert verify_directory(folder).outcome is outcome
