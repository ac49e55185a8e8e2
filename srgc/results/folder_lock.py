"""One writer at a time in a result folder.

The lock is the operating system's, on a file in the folder: it ends with the process that holds it,
however that ends.  Source: the locks of ``flock(2)`` and ``LockFileEx``, by way of filelock.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from srgc.faults import UsageFault
from srgc.near_places import unwritable
from srgc.results.folder_layout import LOCK, refuse_other


@contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """In the block nobody else, in this process or another, writes to the folder, which is there.

    Raises:
        UsageFault: somebody does already, or the folder cannot be written.
    """
    from filelock import FileLock, Timeout

    place = folder / LOCK
    refuse_other(place, "file")
    lock = FileLock(place, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise UsageFault(
            f"another srgc is writing to {folder}: wait until it ends, or use another folder"
        ) from None
    except OSError as error:
        raise unwritable(place, error) from None
    try:
        yield
    finally:
        if sys.platform != "win32":  # where filelock removes the file, as nobody else can
            with suppress(OSError):
                place.unlink()
        lock.release()
