"""``synth --cluster``: the same bytes from a cluster of two workers, and clear refusals."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from solvers.execution.dask_cluster import join_cluster
from solvers.execution.workers import WorkersLostError
from srgc.cli import run
from srgc.results import synthesis_run
from tests.conftest import ROOT, srgc_process
from tests.oracles import worker_jobs
from tests.oracles.cluster import ended, started
from tests.oracles.small_specs import SLIDER


@pytest.mark.slow
def test_the_same_bytes_from_a_cluster(made, tmp_path):
    place = made("turner")
    (tmp_path / "turner.srg").write_bytes((place / "turner.srg").read_bytes())
    cluster, address = started(2)
    try:
        arguments = ["synth", "turner.srg", "-o", "out", "--cluster", address]
        with srgc_process(arguments, tmp_path) as process:
            _, err = process.communicate(timeout=300)
    finally:
        ended(cluster)
    assert process.returncode == 0, err
    said = [line for line in err.splitlines() if not line.startswith(b"[")]
    assert said == []
    for name in ("design.json", "certificate.json"):
        assert (tmp_path / "out" / name).read_bytes() == (place / "out" / name).read_bytes()


@pytest.mark.slow
def test_the_case_study_with_a_worker_killed_in_the_middle(made, tmp_path):
    place = made("planar_arm")
    (tmp_path / "planar_arm.srg").write_bytes((place / "planar_arm.srg").read_bytes())
    cluster, address = started(2)
    try:
        others = join_cluster(address)
        before = {process for process, _ in others.map(worker_jobs.whereabouts, range(12))}
        arguments = ["synth", "planar_arm.srg", "-o", "out", "--cluster", address]
        with srgc_process(arguments, tmp_path) as process:
            assert process.stderr is not None
            while b"robustness" not in process.stderr.readline():
                assert process.poll() is None
            os.kill(min(before), signal.SIGKILL)
            _, err = process.communicate(timeout=600)
        after = {process for process, _ in others.map(worker_jobs.whereabouts, range(12))}
        others.close()
    finally:
        ended(cluster)
    assert process.returncode == 0, err
    assert min(before) not in after
    for name in ("design.json", "certificate.json"):
        assert (tmp_path / "out" / name).read_bytes() == (place / "out" / name).read_bytes()


def test_a_cluster_that_is_not_there(made, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    spec = str(made("turner") / "turner.srg")
    assert run(["synth", spec, "--cluster", "nowhere"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("error: the cluster at nowhere cannot be reached: ")
    assert err.count("\n") == 1
    assert run(["synth", spec, "--cluster", "nowhere", "--jobs", "2"]) == 2
    assert "--jobs" in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]


def test_without_dask_it_is_said_how_to_install_it(made, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert run(["synth", str(made("turner") / "turner.srg"), "--cluster", "tcp://a:1"]) == 2
    assert 'pip install "srgc[cluster]"' in capsys.readouterr().err


def test_workers_that_are_lost_give_no_verdict(made, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def lost(*_arguments, **_options):
        raise WorkersLostError("all workers ended")

    monkeypatch.setattr(synthesis_run, "synthesise", lost)
    assert run(["synth", str(made("turner") / "turner.srg"), "-o", "out"]) == 4
    assert "unknown: all workers ended\n" in capsys.readouterr().err
    assert not (tmp_path / "out" / "design.json").exists()


def test_the_processes_are_ended_however_the_run_ends(monkeypatch):
    from solvers.execution.process_pool import ProcessPool
    from srgc.search_options import workers_for

    closed = []

    def close(pool):
        closed.append(pool)

    monkeypatch.setattr(ProcessPool, "close", close)

    def interrupted():
        with workers_for(2) as pool:
            assert pool.width == 2
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert len(closed) == 1


@pytest.mark.parametrize(("processors", "processes"), [(1, 2), (3, 3), (64, 64), (2000, 1000)])
def test_a_processor_gets_one_process_at_most(monkeypatch, processors, processes):
    from srgc.search_options import workers_for

    monkeypatch.setattr("os.sched_getaffinity", lambda _: set(range(processors)), raising=False)
    with workers_for(1000) as pool:
        assert pool.width == processes


def test_dask_is_loaded_for_a_cluster_alone(tmp_path):
    (tmp_path / "slider.srg").write_text(SLIDER, encoding="utf-8")
    program = (
        "import sys\n"
        "from srgc.cli import run\n"
        "assert run(['synth', 'slider.srg', '-o', 'out', '--jobs', '2']) == 0\n"
        "assert not {'dask', 'distributed'} & set(sys.modules)\n"
    )
    subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, check=True, capture_output=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
