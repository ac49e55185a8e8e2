"""Jobs: in order, no further ahead than may be, and done again where a process was killed."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import pytest

from solvers.execution import in_order as module_in_order
from solvers.execution.dask_cluster import AnyExecutor
from solvers.execution.in_order import in_order
from solvers.execution.process_pool import ProcessPool
from solvers.execution.workers import InProcess, WorkersLostError
from tests.conftest import ROOT
from tests.oracles import worker_jobs

NUMBERS = range(-4, 9)


@pytest.fixture(scope="module")
def pool():
    made = ProcessPool(2, patience=0.0)
    # Until they are there, this process does their jobs.
    while os.getpid() in {process for process, _ in made.map(worker_jobs.whereabouts, range(8))}:
        list(made.map(worker_jobs.slept, [0.0] * 100))
    yield made
    made.close()


class ByHand:
    """An executor whose jobs the test finishes; ``lost`` says which error means a lost worker."""

    def __init__(self, width):
        self.width, self.alive = width, True
        self.begun = []

    def start(self, function, job):
        future = Future()
        self.begun.append((job, future))
        return future

    def is_lost(self, error):
        return isinstance(error, ConnectionError)

    def is_alive(self):
        return self.alive


def test_results_are_in_the_order_of_the_jobs(pool):
    expected = [number**3 for number in NUMBERS]
    assert list(InProcess().map(worker_jobs.cubed, NUMBERS)) == expected
    assert list(pool.map(worker_jobs.cubed, NUMBERS)) == expected
    executor = ProcessPoolExecutor(2, mp_context=get_context("spawn"))
    with executor:
        workers = AnyExecutor(executor, 2)
        assert list(workers.map(worker_jobs.cubed, iter(NUMBERS))) == expected
        assert list(workers.map(worker_jobs.cubed, [])) == []


def test_threads_are_refused():
    with ThreadPoolExecutor(1) as threads, pytest.raises(TypeError, match="threads"):
        AnyExecutor(threads, 1)


def test_a_job_that_fails_fails_in_its_turn(pool):
    for workers in (InProcess(), pool):
        results = workers.map(worker_jobs.divided, [2, -4, 0, 5])
        assert [next(results), next(results)] == [0.5, -0.25]
        with pytest.raises(ZeroDivisionError):
            next(results)
    assert list(pool.map(worker_jobs.divided, [8])) == [0.125]


@pytest.mark.parametrize("width", [1, 2, 3])
def test_no_more_jobs_are_begun_than_the_width(width):
    source = ByHand(width)
    drawn = []

    def jobs():
        for number in range(20):
            drawn.append(number)
            yield number

    results = in_order(source, abs, jobs())
    assert drawn == []
    # The results of the first jobs are there as soon as they are begun.
    begin = source.start

    def at_once(function, job):
        future = begin(function, job)
        if job < 2:
            future.set_result(-job)
        return future

    source.start = at_once
    assert next(results) == 0
    assert drawn == [0]  # it was there: nothing else was due
    assert next(results) == -1
    assert drawn == [0, 1]


def test_jobs_are_drawn_only_while_a_result_is_waited_for(pool, tmp_path):
    results = pool.map(worker_jobs.noted, ((number, str(tmp_path)) for number in range(40)))
    assert next(results) == 0
    time.sleep(0.3)
    begun = len([*tmp_path.iterdir()])
    assert begun < 20
    time.sleep(0.2)
    assert len([*tmp_path.iterdir()]) == begun
    assert list(results) == list(range(1, 40))


def test_a_width_of_one_is_never_ahead(tmp_path):
    with_one = ProcessPool(1, patience=0.0)
    try:
        for workers in (InProcess(), with_one):
            drawn = []
            jobs = (drawn.append(number) or number for number in range(30))
            for count, _ in enumerate(workers.map(worker_jobs.cubed, jobs), 1):
                assert drawn == list(range(count))
    finally:
        with_one.close()


def test_others_do_the_jobs_with_one_thread_each(pool):
    found = set(pool.map(worker_jobs.whereabouts, range(8)))
    assert len(found) == 2
    assert {threads for _, threads in found} == {"1"}
    assert os.getpid() not in {process for process, _ in found}
    assert "OMP_NUM_THREADS" not in os.environ or os.environ["OMP_NUM_THREADS"] == "1"


def test_a_short_run_starts_no_process():
    short = ProcessPool(2)
    assert {process for process, _ in short.map(worker_jobs.whereabouts, range(3))} == {os.getpid()}
    assert short._executor is None
    short.close()


def test_a_killed_process_is_replaced_and_its_jobs_are_done_again(pool, tmp_path):
    marker = str(tmp_path / "killed")
    jobs = [(n, marker if n == 3 else None) for n in range(9)]
    before = {process for process, _ in pool.map(worker_jobs.whereabouts, range(8))}
    assert list(pool.map(worker_jobs.killed_once, jobs)) == [n**2 for n in range(9)]
    assert (tmp_path / "killed").exists()
    after = {process for process, _ in pool.map(worker_jobs.whereabouts, range(8))}
    assert len(after) == 2
    assert not after & before


def test_a_job_that_kills_every_worker_is_given_up():
    workers = ProcessPool(1, patience=0.0)
    workers._is_ready = lambda _: True
    try:
        with pytest.raises(WorkersLostError, match="ended in the middle"):
            list(workers.map(worker_jobs.killed, [os.getpid()]))
    finally:
        workers.close()


def test_an_executor_that_stays_broken_gives_up():
    executor = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
    with executor, pytest.raises(WorkersLostError):
        list(AnyExecutor(executor, 1).map(worker_jobs.killed, [os.getpid()]))


def test_lost_jobs_are_begun_again_at_once_and_cancelled_where_nobody_waits():
    source = ByHand(2)
    begin = source.start

    def lost_together(function, job):
        future = begin(function, job)
        if len(source.begun) == 2:
            for _, one in source.begun:
                one.set_exception(ConnectionError())
        elif len(source.begun) == 3:
            future.set_result("zero")
        return future

    source.start = lost_together
    results = in_order(source, abs, [0, 1, 2, 3])
    assert next(results) == "zero"
    assert [job for job, _ in source.begun] == [0, 1, 0, 1]
    left = [future for _, future in source.begun if not future.done()]
    assert left
    results.close()
    assert all(future.cancelled() for future in left)


def test_jobs_that_nobody_can_finish_are_given_up(monkeypatch):
    monkeypatch.setattr(module_in_order, "PULSE", 0.01)
    source = ByHand(1)
    source.alive = False
    with pytest.raises(WorkersLostError, match="connection"):
        next(in_order(source, abs, [1]))


def test_closing_ends_the_processes_whatever_they_do():
    workers = ProcessPool(2, patience=0.0)
    workers._is_ready = lambda _: True
    processes = [p for p, _ in workers.map(worker_jobs.whereabouts, range(6))]
    results = workers.map(worker_jobs.slept, [0.0, 600.0, 600.0])
    assert next(results) == 0.0
    workers.close()
    for process in set(processes):
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_processes_end_with_a_parent_that_is_killed():
    program = (
        "import os, signal\n"
        "from solvers.execution.process_pool import ProcessPool\n"
        "from tests.oracles import worker_jobs\n"
        "if __name__ == '__main__':\n"
        "    pool = ProcessPool(2, patience=0.0)\n"
        "    pool._is_ready = lambda _: True\n"
        "    found = {p for p, _ in pool.map(worker_jobs.whereabouts, range(6))}\n"
        "    print(*found, flush=True)\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    finished = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True,
        check=False, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    processes = [int(word) for word in finished.stdout.split()]
    assert processes, finished.stderr
    deadline = time.monotonic() + 20
    while any(_runs(process) for process in processes):
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.mark.parametrize("piped", [False, True])
def test_processes_do_not_run_the_program_that_starts_them(piped, tmp_path):
    # multiprocessing would run a script once more in each of them, and cannot run a piped one.
    program = (
        "from solvers.execution.process_pool import ProcessPool\n"
        "print('begun', flush=True)\n"
        "pool = ProcessPool(2, patience=0.0)\n"
        "print(pool.start(abs, -3).result(60))\n"
        "pool.close()\n"
        "import __main__\n"
        "print(__main__.pool is pool)\n"
    )
    script = tmp_path / "script.py"
    script.write_text(program, encoding="utf-8")
    finished = subprocess.run(
        [sys.executable, "-" if piped else str(script)], input=program if piped else None,
        cwd=ROOT, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert (finished.stdout.split(), finished.stderr) == (["begun", "3", "True"], "")


def _runs(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_job_is_sent_as_it_is_when_it_begins(pool):
    """What a job refers to may change while it is on its way."""
    jobs = [list(range(2000)) for _ in range(20)]
    begun = [pool.begin(worker_jobs.total, job) for job in jobs]
    for job in jobs:
        job.clear()
    assert [one.result() for one in begun] == [sum(range(2000))] * 20


def test_a_job_that_was_begun_is_done_when_asked_without_processes():
    done = []
    begun = InProcess().begin(done.append, 3)
    assert begun.done
    assert done == []
    begun.result()
    assert done == [3]


def test_a_job_that_was_begun_is_done_again_where_its_process_is_killed(pool, tmp_path):
    begun = pool.begin(worker_jobs.killed_once, (7, tmp_path / "marker"))
    assert begun.result() == 49
    assert begun.done


def test_errors_of_a_job_that_was_begun_are_raised_when_it_is_asked_for(pool):
    begun = pool.begin(worker_jobs.divided, 0)
    with pytest.raises(ZeroDivisionError):
        begun.result()
