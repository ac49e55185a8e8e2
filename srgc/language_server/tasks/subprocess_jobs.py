"""``srgc synth`` and ``srgc verify`` beside the server, with their progress and their end."""

from __future__ import annotations

import asyncio
import re
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

_TIME = re.compile(r"^\[ *[0-9.]+ s\] ")
_PATIENCE = 10.0
"""Seconds that a run has to write down what it has, when it is told to end."""


@dataclass(frozen=True, slots=True)
class Ended:
    """A run that has ended: its exit status, the ends of what it printed."""

    status: int
    output: str
    errors: str


@dataclass(slots=True)
class Jobs:
    """The runs that are going on; they end with the server."""

    _running: set[asyncio.subprocess.Process] = field(
        default_factory=set[asyncio.subprocess.Process]
    )

    async def run(
        self,
        arguments: Sequence[str],
        folder: Path,
        told: Callable[[str], None],
        ended: Callable[[], bool],
    ) -> Ended:
        """Run ``srgc`` with these arguments.

        Args:
            arguments: its command line.
            folder: where it runs.
            told: is given every line of its progress.
            ended: whether the user wants it to end; asked again and again.

        Raises:
            OSError: it cannot be started.
        """
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-P",
            "-m",
            "srgc",
            *arguments,
            cwd=folder,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        self._running.add(process)
        watch = asyncio.create_task(_watch(process, ended))
        try:
            output, errors = await asyncio.gather(
                _lines(process.stdout, lambda _: None), _lines(process.stderr, told)
            )
            status = await process.wait()
        finally:
            watch.cancel()
            self._running.discard(process)
            if process.returncode is None:
                await _stop(process)
        return Ended(status, output, errors)

    def stop(self) -> None:
        """End all runs; what they have found so far they keep."""
        for process in self._running:
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGINT)


async def _stop(process: asyncio.subprocess.Process) -> None:
    """An interrupt, so that the run can be resumed; after a while an end."""
    with suppress(ProcessLookupError):
        process.send_signal(signal.SIGINT)
        try:
            await asyncio.wait_for(process.wait(), _PATIENCE)
        except TimeoutError:
            process.kill()


async def _watch(process: asyncio.subprocess.Process, ended: Callable[[], bool]) -> None:
    while not ended():
        await asyncio.sleep(0.1)
    await _stop(process)


async def _lines(stream: asyncio.StreamReader | None, told: Callable[[str], None]) -> str:
    """Give out line by line; the last of them."""
    last: list[str] = []
    while stream is not None:
        try:
            line = await stream.readline()
        except ValueError:
            continue  # a line that is too long says nothing to anybody
        if not line:
            break
        text = _TIME.sub("", line.decode("utf-8", "replace").rstrip())
        if text:
            told(text)
            last = [*last[-19:], text]
    return "\n".join(last)
