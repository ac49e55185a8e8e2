"""Ctrl-C and SIGTERM at many moments: one line, status 130, no child left, and the run goes on."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from srgc import interruption
from srgc.cli import run
from srgc.interruption import interrupted_text, resumable
from tests.conftest import ROOT
from tests.oracles.small_specs import TURNER
from tests.srgc.test_interruption import KEPT, same_results, whole_or_absent

READY = "from srgc.cli import main; print('ready', flush=True); main()"
"""Says when srgc takes over: an interrupt before that is Python's own."""


def started(arguments, folder, program=READY):
    process = subprocess.Popen(
        [sys.executable, "-c", program, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        start_new_session=True,
    )  # fmt: skip
    assert process.stdout.readline() == b"ready\n"
    return process


def session_of(leader):
    """The processes of a session, zombies apart."""
    found = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError, ValueError):
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
            if int(fields[3]) == leader and fields[0] != "Z":
                found.append(int(entry.name))
    return found


def nothing_is_left(leader):
    """The tracker of multiprocessing ends a little after its parent."""
    for _ in range(100):
        if not session_of(leader):
            return True
        time.sleep(0.05)
    return False


def interrupted(process, number, signals=(signal.SIGINT,), group=False):
    """Send signals; the lines on standard error without those of progress."""
    for each in signals:
        (os.killpg if group else os.kill)(process.pid, each)
    out, err = process.communicate(timeout=60)
    assert b"Traceback" not in err, (number, err)
    assert nothing_is_left(process.pid), number
    said = [line for line in err.splitlines() if line and not line.startswith(b"[")]
    return process.returncode, out, said


def resumed_alike(made, folder):
    """The same command goes on to the bytes of a run that nothing interrupted."""
    process = started(["synth", "turner.srg", "-o", "out"], folder)
    _, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    same_results(folder / "out", made("turner") / "out")


def one_moment(folder, seconds, jobs, **how):
    """A run that is interrupted after so many seconds, or had ended before."""
    process = started(["synth", "turner.srg", "-o", "out", "--jobs", jobs], folder)
    time.sleep(seconds)
    status, out, said = interrupted(process, seconds, **how)
    if status == -signal.SIGTERM:  # it came before srgc could take it: silence, and nothing done
        assert (out, said) == (b"", [])
        return status
    assert status in (130, 0), (seconds, said)
    if status == 130:
        assert out == b""
        assert said in ([b"interrupted"], [KEPT]), seconds
        if (folder / "out").exists():
            whole_or_absent(folder / "out")
    return status


@pytest.mark.slow
def test_it_ends_at_any_moment_and_goes_on(made, tmp_path):
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    twice = [signal.SIGINT, signal.SIGINT]
    statuses = [
        one_moment(tmp_path, 0, 1),
        one_moment(tmp_path, 0.05, 1, signals=[signal.SIGTERM]),
        one_moment(tmp_path, 0.5, 2, signals=twice),
        one_moment(tmp_path, 1.3, 2, group=True),
    ]
    assert statuses[0] == 130
    resumed_alike(made, tmp_path)


@pytest.mark.slow
def test_fifty_random_moments(made, tmp_path):
    chance = random.Random(9)
    (tmp_path / "turner.srg").write_text(TURNER, encoding="utf-8")
    statuses = []
    for number in range(50):
        jobs = 1 + number % 2
        how = {
            "signals": [chance.choice([signal.SIGINT, signal.SIGTERM])],
            "group": number % 3 == 0,
        }
        if statuses[-1:] == [0]:
            for path in sorted((tmp_path / "out").rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() else path.unlink()
        statuses.append(one_moment(tmp_path, chance.uniform(0, 1.2), jobs, **how))
    assert statuses.count(130) > 25
    resumed_alike(made, tmp_path)


def test_processes_that_are_started_are_waited_for(tmp_path):
    """Or they would say in a traceback that they have no parent."""
    program = (
        "import time\n"
        "from solvers.execution.process_pool import STARTING\n"
        "from srgc.interruption import watch\n"
        "watch()\n"
        "with STARTING:\n"
        "    print('ready', flush=True)\n"
        "    time.sleep(0.5)\n"
        "    open('written', 'w').close()\n"
        "time.sleep(60)\n"
    )
    status, _, said = interrupted(started([], tmp_path, program), 0)
    assert (status, said) == (130, [b"interrupted"])
    assert (tmp_path / "written").exists()


def test_a_child_is_ended_with_its_parent(tmp_path):
    """z3 is stood in for by a child that would go on for a minute."""
    program = (
        "import subprocess, sys\n"
        "from srgc.interruption import watch\n"
        "watch()\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        "print('ready', flush=True)\n"
        "child.wait()\n"
    )
    status, _, said = interrupted(started([], tmp_path, program), 0)
    assert (status, said) == (130, [b"interrupted"])


def test_a_main_thread_that_is_busy_elsewhere_is_no_hindrance(tmp_path):
    """Such as one in a solver: a handler in Python would wait for it to come back."""
    program = (
        "from srgc.interruption import watch\n"
        "watch()\n"
        "import ctypes; sleep = ctypes.CDLL(None).sleep\n"
        "print('ready', flush=True)\n"
        "while True: sleep(30)\n"
    )
    process = started([], tmp_path, program)
    status, _, said = interrupted(process, 0, signals=[signal.SIGTERM])
    assert (status, said) == (130, [b"interrupted"])


NATIVE = {
    "a convex program": """
from solvers.backends.portfolio import UsualSolver
from tests.oracles.hard_programs import hard_program
task = lambda: UsualSolver().solve(hard_program(), 1e-8)
""",
    "a question to z3": """
from solvers.backends.smt import solve_script
from tests.solvers.test_smt import HARD
task = lambda: solve_script(HARD, resources=1_000_000_000)
""",
}
"""Work that takes minutes within a library."""


@pytest.mark.parametrize("sort", NATIVE)
def test_work_in_a_library_is_interrupted(tmp_path, sort):
    """Even if the library lets no other thread run, or takes the signal for itself."""
    program = (
        "from srgc.interruption import watch\n"
        "watch()\n"
        f"{NATIVE[sort]}\n"
        "print('ready', flush=True)\n"
        "task()\n"
    )
    process = started([], tmp_path, program)
    time.sleep(1.5)
    status, _, said = interrupted(process, sort)
    assert (status, said) == (130, [b"interrupted"])


REDRAWN = """
import sys, time
from threading import Thread
from srgc import interruption

def draw():
    while True:
        sys.stderr.write("\\rsearching")
        sys.stderr.flush()
        time.sleep(0.001)

interruption._release_semaphores = lambda: time.sleep(0.3)  # an end that takes its time
interruption.watch()
with interruption.redrawing():
    Thread(target=draw, daemon=True).start()
    time.sleep(0.1)
    print("ready", flush=True)
    time.sleep(60)
"""


def test_nothing_is_drawn_after_the_last_line(tmp_path):
    process = started([], tmp_path, REDRAWN)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err.endswith(b"\r\x1b[2K\x1b[?25hinterrupted\n")


def test_a_block_that_cleans_up_gets_the_exception(tmp_path):
    program = (
        "import time\n"
        "from srgc.interruption import as_exception, watch\n"
        "watch()\n"
        "try:\n"
        "    with as_exception():\n"
        "        print('ready', flush=True)\n"
        "        time.sleep(60)\n"
        "except KeyboardInterrupt:\n"
        "    print('cleaned up', flush=True)\n"
    )
    status, out, said = interrupted(started([], tmp_path, program), 0)
    assert (status, out, said) == (0, b"cleaned up\n", [])


def test_a_block_that_never_ends_is_ended_by_a_second_signal(tmp_path):
    program = (
        "import time\n"
        "from srgc.interruption import as_exception, watch\n"
        "import srgc.interruption; srgc.interruption.PATIENCE = 600\n"
        "watch()\n"
        "with as_exception():\n"
        "    try:\n"
        "        print('ready', flush=True)\n"
        "        time.sleep(60)\n"
        "    except KeyboardInterrupt:\n"
        "        print('stuck', flush=True)\n"
        "        while True:\n"
        "            try:\n"
        "                time.sleep(60)\n"
        "            except KeyboardInterrupt:\n"
        "                pass\n"
    )
    process = started([], tmp_path, program)
    os.kill(process.pid, signal.SIGINT)
    assert process.stdout.readline() == b"stuck\n"
    status, _, said = interrupted(process, 0)
    assert (status, said) == (130, [b"interrupted"])


def test_an_ignored_signal_stays_ignored(tmp_path):
    """As of a job that a script runs in the background, or under nohup."""
    program = (
        "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "import os, time\n"
        "from srgc.interruption import watch\n"
        "watch()\n"
        "print('ready', flush=True)\n"
        "os.kill(os.getpid(), signal.SIGINT)\n"
        "time.sleep(0.2); print('goes on')\n"
    )
    process = started([], tmp_path, program)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (0, b"goes on\n", b"")


def test_what_is_said(tmp_path, monkeypatch, capsys):
    assert interrupted_text() == "interrupted"
    with resumable(tmp_path):
        assert interrupted_text() == _told(tmp_path)
    assert interrupted_text() == "interrupted"

    def broken(*_):
        with resumable(tmp_path):
            raise KeyboardInterrupt

    monkeypatch.setattr("srgc.session.check_file", broken)
    assert run(["check", "x.srg"]) == 130
    assert capsys.readouterr().err == f"{_told(tmp_path)}\n"
    # What an earlier command of this process has left is not told of the next one.
    monkeypatch.setattr(
        "srgc.session.check_file", lambda _: (_ for _ in ()).throw(KeyboardInterrupt)
    )
    assert run(["check", "x.srg"]) == 130
    assert capsys.readouterr().err == "interrupted\n"
    assert interruption._STATE.folder is None


def _told(folder):
    return f"interrupted; what was done is kept in {folder}: the same command goes on from there"
