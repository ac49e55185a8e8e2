"""The folder of an unknown task whose nearest motion is known: a found one, whose claim is gone."""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.oracles import result_files


def without_claim(folder: Path, copy: Path) -> Path:
    """A copy of a found result as an unknown one, whose nearest motion is that of the design."""
    shutil.copytree(folder, copy)
    (copy / "certificate.json").unlink()
    (copy / "trajectory.csv").rename(copy / "nearest.csv")
    design = result_files.read(copy, "design.json")
    nearest = {
        "word": design["word"], "derivation": design["derivation"],
        "parameters": design["parameters"], "effector": 0, "leader": 0, "cells": [],
        "robustness": -0.1, "at_samples": False,
        "stuck": {"time": 1.0, "position": [0.5, 1.0]},
        "cause": "no motion was found along the path", "reason": "it lacks a little",
        "try_first": "more steps",
    }  # fmt: skip
    for each in design["structures_tried"]:
        if each["verdict"] == "found":
            each.update(verdict="unresolved", evidence="no motion")
    changed = {"verdict": "unknown", "reason": "1 structure is neither", "nearest": nearest}
    gone = {"word": None, "derivation": None, "parameters": []}
    result_files.write(copy, design | gone | changed, "design.json")
    return copy
