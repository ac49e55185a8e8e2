"""Ctrl-C and SIGTERM: at whatever moment they come, one line, and exit status 130.

A signal that is raised as an exception comes out of any line, also out of the import of a library
or a solver that takes it for a fault of its own; the answer then is wrong, or a traceback.  So a
thread waits for signals and ends the process: result folders are whole at every moment, as after a
kill, and are resumed from their journals.  Only a block that says so gets the exception.
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
"""Seconds that a block with the exception may take to end."""
CHILDREN = "/proc/{0}/task/{1}/children"
"""Where Linux lists the processes that a thread has started."""


@dataclass(slots=True)
class _State:
    """What is under way in this process."""

    folder: Path | None = None
    redrawn: bool = False
    gentle: bool = False
    raised: bool = False


_STATE = _State()
_ENDING = Lock()


@contextmanager
def resumable(folder: Path) -> Iterator[None]:
    """In the block, what is done is kept in a folder from which another run goes on.

    After an exception the folder is still told by :func:`interrupted_text`.
    """
    _STATE.folder = folder
    yield
    _STATE.folder = None


@contextmanager
def redrawing() -> Iterator[None]:
    """In the block a line of standard error is redrawn, with the cursor hidden."""
    _STATE.redrawn = True
    try:
        yield
    finally:
        _STATE.redrawn = False


@contextmanager
def as_exception() -> Iterator[None]:
    """In the block an interrupt is raised as KeyboardInterrupt, so that it can clean up."""
    _STATE.gentle, _STATE.raised = True, False
    try:
        yield
    finally:
        _STATE.gentle = False


def begin() -> None:
    """Forget what an earlier command of this process has left."""
    _STATE.folder = None


def interrupted_text() -> str:
    """What is said of an interruption."""
    if _STATE.folder is None:
        return "interrupted"
    return (
        f"interrupted; what was done is kept in {_STATE.folder}: "
        "the same command goes on from there"
    )


def watch() -> None:
    """From now on a signal ends this process, unless it was started with the signal ignored.

    On Windows interrupts remain exceptions.
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
    """The same under another number, if that of a standard stream, which was closed, was free."""
    if descriptor > 2:
        return descriptor
    from fcntl import F_DUPFD_CLOEXEC, fcntl

    again = fcntl(descriptor, F_DUPFD_CLOEXEC, 3)
    os.close(descriptor)
    return again


def _noted(_number: int, _frame: FrameType | None) -> None:
    """The thread has been told; in a block that asked for it, so is the main one."""
    if _STATE.gentle and not _STATE.raised:
        _STATE.raised = True
        raise KeyboardInterrupt


def _ignore() -> None:
    """What is left to do is to take this process down: its status is known."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _wait(reader: int) -> None:
    """End the process at the first signal, or where it cleans up, soon after it or at the next."""
    while os.read(reader, 1)[0] not in SIGNALS:
        pass
    # The block may be over by now: what it does about the exception comes after it.
    if _STATE.gentle or _STATE.raised:
        select([reader], [], [], PATIENCE)
    end()


def end() -> None:
    """Say that the process was interrupted, end its children and then itself."""
    _ENDING.acquire()  # for good: whoever comes second has nothing more to do
    if sys.stderr is not None:
        # Not by the stream, whose lock the main thread may hold.
        clear = "\r\x1b[2K\x1b[?25h" if _STATE.redrawn else ""
        with suppress(OSError):
            last = os.dup(2)
            _silence(2)  # a thread that redraws would write below the last line
            os.write(last, f"{clear}{interrupted_text()}\n".encode(errors="backslashreplace"))
    _let_processes_start()
    _release_semaphores()
    for child in _children(os.getpid()):
        with suppress(OSError):
            os.kill(child, signal.SIGKILL)
    os._exit(INTERRUPTED)


def _silence(descriptor: int) -> None:
    """What is written there from now on goes nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)


def _let_processes_start() -> None:
    """Processes that are being started have what they read first, and no others are started.

    One whose parent ends before would say so in a traceback.
    """
    pool = sys.modules.get("solvers.execution.process_pool")
    if pool is not None:
        pool.STARTING.acquire(timeout=PATIENCE)


def _release_semaphores() -> None:
    """Or a tracker of :mod:`multiprocessing`, which lives on, warns of them."""
    utilities = sys.modules.get("multiprocessing.util")
    with suppress(Exception):
        utilities._run_finalizers(0)  # type: ignore[union-attr]  # noqa: SLF001


def _children(process: int) -> list[int]:
    """The processes that a process has started, and theirs; none where the system does not say."""
    found: list[int] = []
    with suppress(OSError):
        for thread in Path(f"/proc/{process}/task").iterdir():
            listed = Path(CHILDREN.format(process, thread.name)).read_text(encoding="ascii")
            for child in map(int, listed.split()):
                if not _is_tracker(child):
                    found += [*_children(child), child]
    return found


def _is_tracker(process: int) -> bool:
    """Whether a process is that of :mod:`multiprocessing` which cleans up after others."""
    with suppress(OSError):
        return b"resource_tracker" in Path(f"/proc/{process}/cmdline").read_bytes()
    return False
