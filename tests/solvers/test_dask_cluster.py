"""A cluster of two worker processes, of which one is killed in the middle of what it does."""

from __future__ import annotations

import os
import signal
import socket
import sys

import pytest

from solvers.execution import dask_cluster
from solvers.execution.dask_cluster import ClusterFault, join_cluster
from solvers.execution.workers import WorkersLostError
from solvers.search.evaluation import Evaluator
from tests.oracles import worker_jobs
from tests.oracles.cluster import ended, started
from tests.oracles.planned_arm import THETAS, bits, evaluated, planned_arm

pytestmark = [
    # Tornado's loops leave their sockets to the collector when a client closes.
    pytest.mark.filterwarnings("ignore:unclosed:ResourceWarning"),
]


@pytest.fixture(scope="module")
def address():
    process, address = started(2)
    yield address
    ended(process)


@pytest.fixture
def cluster(address):
    workers = join_cluster(address)
    yield workers
    workers.close()


def processes(workers):
    return {process for process, _ in workers.map(worker_jobs.whereabouts, range(12))}


def test_results_are_in_order_and_failures_in_their_turn(cluster):
    numbers = range(-4, 9)
    assert list(cluster.map(worker_jobs.cubed, numbers)) == [n**3 for n in numbers]
    results = cluster.map(worker_jobs.divided, [2, 0, 5])
    assert next(results) == 0.5
    with pytest.raises(ZeroDivisionError):
        next(results)
    assert os.getpid() not in processes(cluster)


@pytest.mark.slow
def test_a_worker_is_killed_in_the_middle_of_evaluations(cluster):
    here = [bits(evaluated(*theta)) for theta in THETAS]
    before = processes(cluster)
    assert len(before) == 2
    outcomes = Evaluator(planned_arm(), cluster).batch(THETAS)
    there = [bits(next(outcomes))]
    os.kill(min(before), signal.SIGKILL)
    there += [bits(outcome) for outcome in outcomes]
    assert there == here
    assert min(before) not in processes(cluster)


@pytest.mark.slow
def test_a_job_that_kills_every_worker_is_given_up():
    process, address = started(1, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="1")
    try:
        workers = join_cluster(address)
        with pytest.raises(WorkersLostError):
            list(workers.map(worker_jobs.killed, [os.getpid()]))
        workers.close()
    finally:
        ended(process)


@pytest.mark.slow
def test_a_scheduler_that_dies_ends_the_waiting():
    process, address = started(1)
    workers = join_cluster(address, 2.0)
    results = workers.map(worker_jobs.slept, [0.0, 600.0])
    assert next(results) == 0.0
    ended(process)
    with pytest.raises(WorkersLostError, match="connection"):
        next(results)
    with pytest.raises(WorkersLostError, match="connection"):
        next(workers.map(worker_jobs.slept, [0.0]))
    workers.close()


def test_clusters_that_cannot_be_used(monkeypatch, address):
    with socket.socket() as nobody:
        nobody.bind(("127.0.0.1", 0))
        place = f"tcp://127.0.0.1:{nobody.getsockname()[1]}"
        with pytest.raises(ClusterFault, match=f"{place} cannot be reached"):
            join_cluster(place, 0.5)
    for wrong in ("nonsense", "", "ftp://there:1"):
        with pytest.raises(ClusterFault, match="cannot be reached"):
            join_cluster(wrong, 0.5)
    monkeypatch.setattr(dask_cluster, "version", lambda _: "0.0.0")
    with pytest.raises(ClusterFault, match=r"has srgc .*; srgc 0\.0\.0 is needed"):
        join_cluster(address)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterFault, match=r'pip install "srgc\[cluster\]"'):
        join_cluster(address)


def test_a_cluster_without_workers():
    process, address = started(0)
    try:
        with pytest.raises(ClusterFault, match="has no workers"):
            join_cluster(address, 0.5)
    finally:
        ended(process)
