"""Ctrl-C and SIGTERM: whenever they arrive, srgc prints one line and exits with status 130.

A signal handler that raises can interrupt any line, even in the import of a library or in a solver
that takes the exception for a failure of its own.  The result is a wrong answer or a traceback.  So
a thread waits for signals and ends the process.  Result folders are consistent at every moment, as
after a kill, and runs resume from their journals.  Only blocks under :func:`as_exception` get the
exception.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from select import select
from threading import Lock, Thread
from types import FrameType

from srgc.faults import INTERRUPTED

SIGNALS = (signal.SIGINT, signal.SIGTERM)
PATIENCE = 2.0
"""Seconds that a block under :func:`as_exception` has to end."""
CHILDREN = "/proc/{0}/task/{1}/children"
"""The file in which Linux lists the processes that a thread has started."""


@dataclass(slots=True)
class _State:
    """What is going on in this process."""

    folder: Path | None = None
    redrawn: bool = False
    gentle: bool = False
    raised: bool = False


_STATE = _State()
_ENDING = Lock()


@contextmanager
def resumable(folder: Path) -> Iterator[None]:
    """Within the block, work is kept in a folder from which another run can resume.

    After an exception, :func:`interrupted_text` still names the folder.
    """
    _STATE.folder = folder
    yield
    _STATE.folder = None


@contextmanager
def redrawing() -> Iterator[None]:
    """Within the block, a line of standard error is redrawn, with the cursor hidden."""
    _STATE.redrawn = True
    try:
        yield
    finally:
        _STATE.redrawn = False


@contextmanager
def as_exception() -> Iterator[None]:
    """Within the block, an interrupt raises KeyboardInterrupt, so that the block can clean up."""
    _STATE.gentle, _STATE.raised = True, False
    try:
        yield
    finally:
        _STATE.gentle = False


def begin() -> None:
    """Forget the folder of an earlier command in this process."""
    _STATE.folder = None


def interrupted_text() -> str:
    """The line that is printed after an interrupt."""
    if _STATE.folder is None:
        return "interrupted"
    return (
        f"interrupted; what was done is kept in {_STATE.folder}: "
        "the same command goes on from there"
    )


def watch() -> None:
    """Let signals end this process from now on, except those it was started to ignore.

    On Windows, interrupts remain exceptions.
    """
    if sys.platform == "win32":
        return
    reader, writer = map(_beyond_standard_streams, os.pipe())
    os.set_blocking(writer, False)
    Thread(target=_wait, args=(reader,), daemon=True).start()
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _noted)
    atexit.register(_ignore)  # registered first, called last


def _beyond_standard_streams(descriptor: int) -> int:
    """Move a descriptor that got the number of a closed standard stream to a number above 2."""
    if descriptor > 2:
        return descriptor
    from fcntl import F_DUPFD_CLOEXEC, fcntl

    again = fcntl(descriptor, F_DUPFD_CLOEXEC, 3)
    os.close(descriptor)
    return again


def _noted(_number: int, _frame: FrameType | None) -> None:
    """Handle a signal, which the thread has seen: under :func:`as_exception`, raise once."""
    if _STATE.gentle and not _STATE.raised:
        _STATE.raised = True
        raise KeyboardInterrupt


def _ignore() -> None:
    """Ignore signals from now on: the process is ending and its status is known."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _wait(reader: int) -> None:
    """End the process at the first signal; a block under :func:`as_exception` first gets time."""
    while os.read(reader, 1)[0] not in SIGNALS:
        pass
    # The block may be over by now, but the handling of its exception comes after it.
    if _STATE.gentle or _STATE.raised:
        select([reader], [], [], PATIENCE)
    end()


def end() -> None:
    """Print that the process was interrupted, end its children and then itself."""
    _ENDING.acquire()  # never released: whoever comes second has nothing to do
    if sys.stderr is not None:
        # Write to the descriptor: the main thread may hold the lock of the stream.
        clear = "\r\x1b[2K\x1b[?25h" if _STATE.redrawn else ""
        with suppress(OSError):
            last = os.dup(2)
            _silence(2)  # else a thread that redraws would write below the last line
            os.write(last, f"{clear}{interrupted_text()}\n".encode(errors="backslashreplace"))
    _let_processes_start()
    _release_semaphores()
    for child in _children(os.getpid()):
        with suppress(OSError):
            os.kill(child, signal.SIGKILL)
    os._exit(INTERRUPTED)


def _silence(descriptor: int) -> None:
    """Discard everything that is written to the descriptor from now on."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)


def _let_processes_start() -> None:
    """Wait until processes that are being started have read their input, and start no others.

    A process whose parent ends earlier would print a traceback.
    """
    pool = sys.modules.get("solvers.execution.process_pool")
    if pool is not None:
        pool.STARTING.acquire(timeout=PATIENCE)


def _release_semaphores() -> None:
    """Release semaphores, or the tracker of :mod:`multiprocessing` would warn about them."""
    utilities = sys.modules.get("multiprocessing.util")
    with suppress(Exception):
        utilities._run_finalizers(0)  # type: ignore[union-attr]  # noqa: SLF001


def _children(process: int) -> list[int]:
    """The descendants of a process; empty if the system does not list them."""
    found: list[int] = []
    with suppress(OSError):
        for thread in Path(f"/proc/{process}/task").iterdir():
            listed = Path(CHILDREN.format(process, thread.name)).read_text(encoding="ascii")
            for child in map(int, listed.split()):
                if not _is_tracker(child):
                    found += [*_children(child), child]
    return found


def _is_tracker(process: int) -> bool:
    """Whether a process is the resource tracker of :mod:`multiprocessing`."""
    with suppress(OSError):
        return b"resource_tracker" in Path(f"/proc/{process}/cmdline").read_bytes()
    return False
