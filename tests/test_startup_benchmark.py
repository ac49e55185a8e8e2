"""What `benchmarks/startup.py` measures is what it says."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

import pytest

from srgc.cli.command_table import TABLE

ROOT = Path(__file__).parents[1]


def benchmark(*arguments):
    return subprocess.run(
        [sys.executable, "benchmarks/startup.py", *map(str, arguments)],
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=300,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    path = tmp_path_factory.mktemp("startup") / "deep" / "figures.json"
    finished = benchmark("--runs", 1, "--only", "version", "check", "--json", path)
    assert finished.returncode == 0, finished.stderr
    return finished.stdout, json.loads(path.read_text(encoding="utf-8"))


@pytest.mark.slow
def test_text_and_figures_are_the_same(measured):
    text, figures = measured
    starts = {each["command"]: each for each in figures["starts"]}
    assert {"python -c 'import click'", "srgc --version", "srgc check"} <= set(starts)
    for command, each in starts.items():
        (line,) = (line for line in text.splitlines() if line.startswith(f"{command} "))
        assert f"{each['wall']:.3f}" in line
        assert f"{each['ratio']:.2f}" in line
        assert each["wall"] > 0
    # Who checks a spec imports click and more.
    assert starts["srgc check"]["peak"] >= starts["python -c 'import click'"]["peak"]
    required = "met" if starts["srgc --version"]["ratio"] <= 2 else "MISSED"
    assert f"required: srgc --version <= 2 x click: {required}" in text


@pytest.mark.slow
def test_sizes_are_those_of_the_files(measured):
    _, figures = measured
    sizes = {each["name"]: each["bytes"] for each in figures["sizes"]}
    folder = Path(distribution("click").locate_file("click"))
    listed = (
        sum(p.stat().st_size for p in folder.rglob("*.py")) + (folder / "py.typed").stat().st_size
    )
    assert listed < sizes["click"] < listed * 1.2  # and a little for its metadata
    assert {"srgc", "numpy", "casadi", "z3-solver"} <= set(sizes)
    assert "hypothesis" not in sizes
    ours = [ROOT / name for name in ("srgc", "solvers", "compiler", "grammar_lang")]
    python = sum(p.stat().st_size for each in ours for p in each.rglob("*.py"))
    assert python < sizes["srgc"]


def test_a_command_that_fails_ends_it(tmp_path):
    finished = benchmark("--runs", 1, "--only", "verify", "--result", tmp_path)
    assert finished.returncode != 0
    assert "exit status 4" in finished.stderr


def test_every_command_is_measured():
    text = (ROOT / "benchmarks" / "startup.py").read_text(encoding="utf-8")
    assert [name for name in TABLE if f'"{name}": ["{name}"' not in text] == []
