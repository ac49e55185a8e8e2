"""Runs that are killed in the middle of their evaluations, by other processes or not."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import fields

import pytest

from grammar_lang.load import load
from solvers.execution.process_pool import ProcessPool
from srgc.results import synthesis_run
from srgc.results.folder_writer import JOURNAL
from srgc.results.result_folder import Identity, ResultFolder
from srgc.results.synthesis_run import SynthesisOptions, run_synthesis
from tests.conftest import OPTIONS, ROOT
from tests.oracles.small_specs import TURNER
from tests.oracles.some_cases import some

pytestmark = pytest.mark.usefixtures("without_pictures")


RESULTS = ("design.json", "certificate.json", "trajectory.csv")

KILLED = """\
import os, signal, sys
from srgc.results.result_folder import ResultFolder
from solvers.execution import process_pool

process_pool.PATIENCE = 0.0
left, record = [int(sys.argv.pop(1))], ResultFolder.record


def killed(folder, key, value):
    record(folder, key, value)
    left[0] -= 1
    if not left[0]:
        os.kill(os.getpid(), signal.SIGKILL)


ResultFolder.record = killed
if __name__ == "__main__":
    from srgc.cli import main

    main()
"""
"""A run that is killed once it has recorded so many steps."""


@pytest.fixture
def keys(monkeypatch):
    """The keys that are recorded from now on."""
    keys = []
    record = ResultFolder.record

    def noted(folder, key, value):
        keys.append(key)
        record(folder, key, value)

    monkeypatch.setattr(ResultFolder, "record", noted)
    return keys


@pytest.fixture
def whole(tmp_path, keys):
    """A folder of a run that nothing interrupts, and the steps it records."""
    path = tmp_path / "turner.srg"
    path.write_text(TURNER, encoding="utf-8")
    run(path, tmp_path / "whole")
    expected = list(keys)
    keys.clear()
    return tmp_path / "whole", expected


def run(path, folder):
    program = load(path).program
    options = SynthesisOptions(folder, 0, 1, None, force=False, quiet=True)
    return run_synthesis(path, program, program.tasks["Turn"], options)


def same_bytes(folder, other):
    return all((folder / name).read_bytes() == (other / name).read_bytes() for name in RESULTS)


def steps_of(folder):
    lines = (folder / JOURNAL).read_text(encoding="utf-8").splitlines()[1:]
    return [json.loads(line)[0] for line in lines]


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_no_evaluation_is_made_twice(tmp_path, keys, whole, jobs):
    path, cut = tmp_path / "turner.srg", tmp_path / "cut"
    folder, expected = whole
    assert len(set(expected)) == len(expected)
    evaluations = [key for key in expected if not key.startswith("examined|")]
    assert len(evaluations) > 8
    begun = len(expected) - len(evaluations)
    for more in (1, 5):
        # Killed twice: in the first evaluation, and five evaluations later.
        arguments = ["synth", str(path), "-o", str(cut), "--jobs", jobs]
        finished = subprocess.run(
            [sys.executable, "-c", KILLED, str(begun + 1 if more == 1 else more), *arguments],
            cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, check=False,
        )  # fmt: skip
        assert finished.returncode == -signal.SIGKILL, finished.stderr
    done = steps_of(cut)
    assert done == expected[: begun + 6]
    run(path, cut)
    assert keys == expected[begun + 6 :]
    assert same_bytes(cut, folder)
    assert not (cut / JOURNAL).exists()


@pytest.mark.parametrize("spec", some(["turner", "beyond_reach"], 1))
def test_other_processes_have_the_same_bytes(made, tmp_path, monkeypatch, spec):
    """From the first job on: a run of the command starts them later, or never where it is short."""
    place = made(spec)
    path = tmp_path / f"{spec}.srg"
    path.write_bytes((place / path.name).read_bytes())
    program = load(path).program
    (task,) = program.tasks.values()
    begun = []

    class Ready(ProcessPool):
        def start(self, function, job):
            begun.append(function.__name__)
            return super().start(function, job)

    @contextmanager
    def workers(*_):
        pool = Ready(2, patience=0.0)
        while not pool._is_ready(abs):
            pass
        try:
            yield pool
        finally:
            pool.close()

    monkeypatch.setattr(synthesis_run, "workers_for", workers)
    options = SynthesisOptions(
        tmp_path / "out", 0, 2, None, force=False, quiet=True, lemmas=spec not in OPTIONS
    )
    run_synthesis(path, program, task, options)
    assert len(begun) > 3
    for name in ("design.json", "certificate.json"):
        assert (tmp_path / "out" / name).read_bytes() == (place / "out" / name).read_bytes()


def test_a_journal_with_values_of_another_kind_is_of_no_use_and_no_harm(tmp_path, keys, whole):
    path, odd = tmp_path / "turner.srg", tmp_path / "odd"
    folder, expected = whole
    shutil.copytree(folder, odd)
    (odd / "certificate.json").unlink()
    identity = json.loads((odd / "design.json").read_bytes())
    head = {field.name: identity.get(field.name) for field in fields(Identity)}
    values = (1.0, None, [], [None], {"x": 1}, "y", [[{}, None], 2])
    lines = [[key, values[i % len(values)]] for i, key in enumerate(expected)]
    text = "".join(f"{json.dumps(line)}\n" for line in (head, *lines))
    (odd / JOURNAL).write_text(text, encoding="utf-8")
    keys.clear()
    run(path, odd)
    assert keys == expected
    assert same_bytes(odd, folder)
