"""Kills and interrupts: a result file is whole or absent, and the next run goes on."""

from __future__ import annotations

import json
import os
import random
import signal
import time

import pytest

from grammar_lang.load import load
from solvers.verifier.claims.certificate import spec_digest
from solvers.verifier.verification import Outcome, verify_directory
from srgc.render import result_pictures
from srgc.results import folder_writer, synthesis_run
from srgc.results.folder_writer import JOURNAL
from srgc.results.result_folder import Identity, open_folder
from srgc.results.synthesis_run import SynthesisOptions, run_synthesis
from tests.conftest import srgc_process
from tests.oracles.some_cases import examples, some

KEPT = b"interrupted; what was done is kept in out: the same command goes on from there"
RESULTS = ("design.json", "certificate.json", "trajectory.csv", "figures/workspace.svg")


class Killed(BaseException):
    """Ends a run where a kill would: nothing of ours catches it."""


def whole_or_absent(folder):
    """No half-written result is left."""
    for name in ("design.json", "certificate.json"):
        if (folder / name).exists():
            assert isinstance(json.loads((folder / name).read_bytes()), dict)
    report = verify_directory(folder)
    if (folder / "certificate.json").exists():
        assert report.outcome is Outcome.VALID, report.reason
    else:
        assert report.outcome is Outcome.UNDECIDED


def same_results(folder, other):
    for name in RESULTS:
        assert (folder / name).read_bytes() == (other / name).read_bytes(), name
    assert sorted(p.name for p in folder.iterdir()) == sorted(p.name for p in other.iterdir())
    # Robots that lemmas are about leave no files.
    proofs = sorted(p.name for p in (folder / "proofs").glob("*"))
    assert proofs == sorted(p.name for p in (other / "proofs").glob("*"))


@pytest.mark.slow
def test_kills_at_random_moments(made, tmp_path):
    chance = random.Random(1)
    place = made("turner")
    folder = tmp_path / "out"
    (tmp_path / "turner.srg").write_bytes((place / "turner.srg").read_bytes())
    arguments = ["synth", "turner.srg", "-o", "out"]
    for _ in range(examples(1, 2)):
        with srgc_process(arguments, tmp_path) as process:
            time.sleep(chance.uniform(0.5, 3.0))
            process.kill()
            process.communicate()
        if folder.exists():
            whole_or_absent(folder)
    with srgc_process(arguments, tmp_path) as process:
        _, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    same_results(folder, place / "out")
    whole_or_absent(folder)


def test_a_kill_at_every_write(made, tmp_path, monkeypatch):
    """Every write is cut once, before it, in its middle and just before the file is moved."""
    path = tmp_path / "turner.srg"
    path.write_bytes((made("turner") / "turner.srg").read_bytes())
    program = load(path).program
    task = program.tasks["Turn"]
    complete = tmp_path / "complete"
    # The search itself is made once: what matters here is how its outcome is written.
    results, better = [], []
    search = synthesis_run.synthesise

    def remembered(*arguments, told, **options):
        if not results:
            results.append(search(*arguments, told=better.append, **options))
        for design in better:
            told(design)
        return results[0]

    monkeypatch.setattr(synthesis_run, "synthesise", remembered)
    for name in ("workspace_figure", "input_figure"):
        monkeypatch.setattr(result_pictures, name, lambda *_: "<svg/>", raising=False)

    def options(folder):
        return SynthesisOptions(folder, 0, 1, None, force=False, quiet=True)

    calls = []
    sync = os.fsync

    def counted(descriptor):
        calls.append(descriptor)
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", counted)
    run_synthesis(path, program, task, options(complete))
    writes = len(calls)
    assert writes >= 8
    for number in range(writes):
        folder = tmp_path / f"cut-{number}"
        left = [number]

        def cut(descriptor, left=left):
            if left[0] == 0:
                os.ftruncate(descriptor, os.fstat(descriptor).st_size // 2)
                raise Killed
            left[0] -= 1

        monkeypatch.setattr(folder_writer.os, "fsync", cut)
        with pytest.raises(Killed):
            run_synthesis(path, program, task, options(folder))
        whole_or_absent(folder)
        monkeypatch.setattr(folder_writer.os, "fsync", sync)
        run_synthesis(path, program, task, options(folder))
        same_results(folder, complete)


def identity_of(path):
    return Identity(spec_digest({path.name: path.read_bytes()}), "Turn", 0, "1")


def opened(path):
    """The folder beside a spec, as one that was opened and let go."""
    with open_folder(path.parent / "out", identity_of(path), force=False) as folder:
        return folder


def test_a_journal_cut_in_its_last_line(tmp_path):
    path = tmp_path / "a.srg"
    path.write_text("// a")
    folder = opened(path)
    folder.record("a", 1.5)
    folder.record("b|ä", -0.1)
    folder.record("c", float("-inf"))
    journal = tmp_path / "out" / JOURNAL
    content = journal.read_bytes()
    for length in range(content.index(b"\n") + 1, len(content) + 1):
        journal.write_bytes(content[:length])
        again = opened(path)
        assert again.values.items() <= folder.values.items()
        # A step recorded after the cut is found again, and the cut line is not joined to it.
        again.record("d", 2.25)
        third = opened(path)
        assert third.values == again.values
    journal.write_bytes(content)
    whole = opened(path)
    assert whole.values == folder.values


@pytest.mark.parametrize("jobs", some(["2", "1"], 1))
def test_an_interrupt_is_one_line(arm_file, tmp_path, jobs):
    """As from a terminal, which interrupts the workers as well; the run is a long one."""
    arguments = ["synth", arm_file, "-o", "out", "--jobs", jobs]
    with srgc_process(arguments, tmp_path) as process:
        assert process.stderr is not None
        while b"robustness" not in process.stderr.readline():
            assert process.poll() is None
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, b"")
    assert b"Traceback" not in err
    said = [line for line in err.splitlines() if line and not line.startswith(b"[")]
    assert said == [KEPT]
    whole_or_absent(tmp_path / "out")
