"""Counterexamples in ``design.json``: what the search could not follow, and what it deferred."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.oracles import result_files
from tests.oracles.html_page import Page

Made = tuple[Path, Page]


def test_they_are_cells_of_paths_that_fail(weak: Made) -> None:
    folder, page = weak
    design = result_files.read(folder, "design.json")
    found = design["counterexamples"]
    assert found
    end = design["step"] * design["horizon"]
    for one in found:
        assert 0 <= len(one["cells"]) <= one["of"]
        assert one["effector"] == 0
        assert one["robustness"] < 0
        assert one["time"] is None or 0 < one["time"] <= end
        assert design["structures_tried"][one["structure"]]["same_robot_as"] is None
    assert design["iterations"]["paths"] >= len(found)
    assert "cells on the path</th>" in page.source


def test_what_fails_without_cells_is_said_once(weak: Made) -> None:
    """The drives are too weak whatever the path: one counterexample without cells, no more."""
    found = result_files.read(weak[0], "design.json")["counterexamples"]
    assert [one["cells"] for one in found] == [[]]


def test_each_belongs_to_a_path_that_was_evaluated(weak: Made) -> None:
    folder, _ = weak
    with (folder / "evaluations.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for one in result_files.read(folder, "design.json")["counterexamples"]:
        own = [
            row
            for row in rows
            if (int(row["structure"]), int(row["path"])) == (one["structure"], one["path"])
        ]
        assert own
        assert not any(int(row["feasible"]) for row in own)
