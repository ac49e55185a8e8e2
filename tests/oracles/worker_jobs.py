"""Jobs for tests of workers; other processes find them by name."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path


def cubed(number):
    """Later jobs are finished first."""
    time.sleep(0.02 * (number % 3 == 0))
    return number**3


def divided(number):
    return 1 / number


def whereabouts(_job):
    """The process, and what its libraries are told about threads."""
    time.sleep(0.05)
    return os.getpid(), os.environ.get("OMP_NUM_THREADS")


def killed_once(job):
    """Kills the process it is done in, the first time that it is done."""
    number, marker = job
    if marker is not None and not Path(marker).exists():
        Path(marker).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number**2


def killed(parent):
    """Kills the process it is done in, unless that is the parent."""
    if os.getpid() != parent:
        os.kill(os.getpid(), signal.SIGKILL)


def slept(seconds):
    time.sleep(seconds)
    return seconds


def noted(job):
    """Leaves a file that says it was begun."""
    number, folder = job
    (Path(folder) / str(number)).touch()
    return number


def total(numbers):
    return sum(numbers)
