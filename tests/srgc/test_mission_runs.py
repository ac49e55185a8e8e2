"""Missions: the same bytes whatever the hash seed and the processes, and after a run was killed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, srgc_process
from tests.oracles.mission_families import MissionFamily
from tests.oracles.some_cases import some
from tests.srgc.test_resuming import KILLED

SEEDS = (36, 31, 52, 25)
"""Chains with fixed lengths, choices and intervals, and one robot."""
ASKED = ("synth", "mission.srg", "--mission", "M", "-o", "out")


def written(folder: Path) -> dict[str, bytes]:
    """What a mission wrote but for times, pictures and pages."""
    out = folder / "out"
    names = (str(path.relative_to(out)) for path in sorted(out.rglob("*")) if path.is_file())
    kinds = (".json", ".boxes", ".smt2", ".csv")
    return {
        name: (out / name).read_bytes()
        for name in names
        if name.endswith(kinds) and "log.json" not in name
    }


def made(folder: Path, seed: int, *options: str, hash_seed: str = "1") -> dict[str, bytes]:
    folder.mkdir()
    (folder / "mission.srg").write_text(MissionFamily(seed).text, encoding="utf-8")
    with srgc_process([*ASKED, *options], folder, PYTHONHASHSEED=hash_seed) as process:
        _, err = process.communicate(timeout=900)
    assert process.returncode == 0, err
    return written(folder)


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], dict[str, bytes]]:
    base, known = tmp_path_factory.mktemp("missions"), dict[int, dict[str, bytes]]()

    def get(seed: int) -> dict[str, bytes]:
        if seed not in known:
            known[seed] = made(base / str(seed), seed)
        return known[seed]

    return get


@pytest.mark.parametrize("seed", some(SEEDS, 1))
def test_two_processes_and_another_hash_seed(
    seed: int, first: Callable[[int], dict[str, bytes]], tmp_path: Path
) -> None:
    again = made(tmp_path / "again", seed, "--jobs", "2", hash_seed="2")
    assert "mission.json" in again
    assert again == first(seed)


@pytest.mark.slow
@pytest.mark.parametrize("left", [1, 3, 6])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_run_that_was_killed(
    seed: int, left: int, first: Callable[[int], dict[str, bytes]], tmp_path: Path
) -> None:
    folder = tmp_path / "killed"
    folder.mkdir()
    (folder / "mission.srg").write_text(MissionFamily(seed).text, encoding="utf-8")
    (folder / "killed.py").write_text(KILLED, encoding="utf-8")
    ended = subprocess.run(
        [sys.executable, "killed.py", str(left), *ASKED, "-q"],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, check=False,
    )  # fmt: skip
    assert ended.returncode == -9, ended.stderr
    with srgc_process([*ASKED, "-q"], folder, PYTHONHASHSEED="3") as process:
        _, err = process.communicate(timeout=900)
    assert process.returncode == 0, err
    assert written(folder) == first(seed)
