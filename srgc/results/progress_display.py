"""Live progress on a terminal, plain lines elsewhere; both on standard error."""

from __future__ import annotations

import sys
import time
from types import TracebackType

from rich.console import Console
from rich.live import Live
from rich.table import Table


class PlainProgress:
    """One line per structure, path and improvement."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._best: float | None = None

    def __enter__(self) -> PlainProgress:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Nothing to close."""

    def _line(self, text: str) -> None:
        sys.stderr.write(f"[{time.monotonic() - self._start:7.2f} s] {text}\n")
        sys.stderr.flush()

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """A structure is being tried."""
        self._best = None
        self._line(f"structure {number}: {' '.join(word)}")

    def path(self, cells: tuple[str, ...]) -> None:
        """A cell path is being tried."""
        self._best = None
        self._line(f"path: {' > '.join(cells)}")

    def robustness(self, value: float) -> None:
        """The best robustness so far; a line where it grew."""
        if self._best is None or value > self._best:
            self._best = value
            self._line(f"best robustness: {value:.4f}")

    def note(self, text: str) -> None:
        """A finding worth a line."""
        self._line(text)


class LiveProgress(PlainProgress):
    """A small table that is redrawn in place."""

    def __init__(self, console: Console) -> None:
        super().__init__()
        self._rows = {"structure": "", "path": "", "best robustness": "", "note": ""}
        self._live = Live(console=console, get_renderable=self._table, refresh_per_second=8)

    def __enter__(self) -> LiveProgress:
        self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._live.stop()

    def _table(self) -> Table:
        table = Table.grid(padding=(0, 2))
        for name, text in self._rows.items():
            if text:
                table.add_row(f"[bold]{name}[/]", text)
        table.add_row("[bold]time[/]", f"{time.monotonic() - self._start:.1f} s")
        return table

    def _line(self, text: str) -> None:
        name, _, rest = text.partition(": ")
        if name.startswith("structure "):
            self._rows.update(structure=f"{name[10:]}  {rest}", path="", note="")
            self._rows["best robustness"] = ""
        elif name in self._rows:
            self._rows[name] = rest
        else:
            self._rows["note"] = text


class QuietProgress(PlainProgress):
    """Nothing at all."""

    def _line(self, text: str) -> None:
        """Nothing."""


def progress(*, quiet: bool) -> PlainProgress:
    """The display that fits standard error."""
    if quiet:
        return QuietProgress()
    console = Console(stderr=True)
    return LiveProgress(console) if console.is_terminal else PlainProgress()
