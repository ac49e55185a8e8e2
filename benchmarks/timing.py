"""Times of processes and calls, and the lines of a report about them.

Times are medians.  Pairs are measured in turn (a, b, a, b, ...) and the ratio is the median of the
ratios of the pairs, so that a machine that is busy for a while troubles both alike.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[1]
SPEC = ROOT / "specs" / "planar_arm.srg"
SRGC = [sys.executable, "-c", "from srgc.cli import main; main()"]


@dataclass(frozen=True)
class Process:
    """One run of a process: seconds, seconds, MiB."""

    wall: float
    cpu: float
    peak: float


@dataclass(frozen=True)
class Line:
    """A line of the report."""

    what: str
    runs: int
    wall: float
    cpu: float | None = None
    peak: float | None = None
    note: str = ""

    def __str__(self) -> str:
        cpu = "" if self.cpu is None else f"{self.cpu:.3f}"
        peak = "" if self.peak is None else f"{self.peak:.0f}"
        return f"{self.what:<44}{self.runs:>5}{self.wall:>11.4f}{cpu:>10}{peak:>8}  {self.note}"


HEAD = f"{'what':<44}{'runs':>5}{'wall s':>11}{'cpu s':>10}{'MiB':>8}"


def process(command: list[str], expected: int = 0) -> Process:
    """Run a process to its end; its children count as they were waited for."""
    started = time.perf_counter()
    child = subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - started
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != expected:
        raise SystemExit(f"{' '.join(command[2:])}: exit status {child.returncode}")
    # ru_maxrss counts kilobytes on Linux, bytes on macOS.
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return Process(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / unit)


def summary(what: str, runs: list[Process], note: str = "") -> Line:
    """The medians of some runs; the peak is the largest."""
    wall, cpu = median(r.wall for r in runs), median(r.cpu for r in runs)
    return Line(what, len(runs), wall, cpu, max(r.peak for r in runs), note)


def seconds(action: Callable[[], object]) -> float:
    """The wall time of a call."""
    started = time.perf_counter()
    action()
    return time.perf_counter() - started


def paired(
    names: tuple[str, str], actions: tuple[Callable[[], object], Callable[[], object]], runs: int
) -> list[Line]:
    """Two calls in turn, with the ratio of the second to the first; one round to warm up."""
    for action in actions:
        action()
    pairs = [(seconds(actions[0]), seconds(actions[1])) for _ in range(runs)]
    ratio = median(b / a for a, b in pairs)
    first, second = (median(pair[i] for pair in pairs) for i in (0, 1))
    return [
        Line(names[0], runs, first),
        Line(names[1], runs, second, note=f"{ratio:.1f} times the line above"),
    ]


def machine() -> str:
    """Where this is measured, and how busy it is."""
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    return (
        f"{platform.system()} {platform.machine()}, Python {platform.python_version()}, "
        f"{os.cpu_count()} cores, {memory:.0f} GiB, load {os.getloadavg()[0]:.1f}"
    )
