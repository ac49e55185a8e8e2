"""Progress of long work: one live line on a terminal or in a notebook, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from importlib import import_module
from statistics import fmean
from types import TracebackType
from typing import TYPE_CHECKING, Any

from grammar_lang.files.file_tree import visible
from srgc.interruption import redrawing
from srgc.terminal import colours, redraws, silence

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console
    from rich.constrain import Constrain
    from rich.text import Text

SILENCE = 1.0
"""Seconds before the live line is shown; shorter work needs none."""
REDRAWN = 0.25
"""Seconds between two versions of the line in a notebook."""
SPARSE = 10.0
"""Seconds between two plain lines about finished parts, and of silence before one about a step."""


class QuietProgress:
    """The interface for reporting progress; this class shows nothing."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._open = ExitStack()

    def __enter__(self) -> QuietProgress:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """Report that a structure is being tried."""

    def path(self, cells: tuple[str, ...]) -> None:
        """Report that a cell path is being tried."""

    def robustness(self, value: float) -> None:
        """Report the best robustness so far."""

    def note(self, text: str) -> None:
        """Report a finding that is worth a line."""

    def step(self, text: str) -> None:
        """Report what is being done; there may be very many steps."""

    def finding(self, text: str) -> None:
        """Report a part of the answer; it stays, whatever happens to the rest of the work."""

    def part(self, done: int, count: int) -> None:
        """Report that ``done`` of ``count`` parts of the work are finished."""


class PlainProgress(QuietProgress):
    """One line per structure, path and improvement; ``unit`` is the unit of robustness."""

    def __init__(self, unit: str = "") -> None:
        super().__init__()
        self._unit = unit
        self._best: float | None = None
        self._told = self._spoken = self._start

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """Print that a structure is being tried."""
        self._best = None
        self._line(f"structure {number}: {' '.join(word)}")

    def path(self, cells: tuple[str, ...]) -> None:
        """Print that a cell path is being tried."""
        self._best = None
        self._line(f"path: {' > '.join(cells)}")

    def robustness(self, value: float) -> None:
        """Print the robustness if it has increased."""
        if self._best is None or value > self._best:
            self._best = value
            self._line(f"best robustness: {value:.4g} {self._unit}".rstrip())

    def note(self, text: str) -> None:
        """Print a finding."""
        self._line(text)

    finding = note

    def step(self, text: str) -> None:
        """Print a step after a long silence."""
        if time.monotonic() - self._spoken >= SPARSE:
            self._line(text)

    def part(self, done: int, count: int) -> None:
        """Print a line now and then, and none if the work is short."""
        now = time.monotonic()
        if now - self._told >= SPARSE:
            self._told = now
            self._line(f"{done} of {count}")

    def _line(self, text: str) -> None:
        self._spoken = time.monotonic()
        _say(f"[{time.monotonic() - self._start:7.2f} s] {text}")


def tell_kept(kept: Path | None, *, quiet: bool) -> None:
    """Print where the results of an earlier version of a spec were moved, if there are any."""
    if kept is not None and not quiet:
        _say(visible(f"note: the spec was edited; the results so far are kept in {kept}"))


def _say(text: str) -> None:
    """Write a permanent line to standard error."""
    try:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
    except OSError:  # nobody reads it, or the disk is full: the work continues
        silence(sys.stderr)


class LiveProgress(QuietProgress):
    """A line that is redrawn in place and removed at the end.

    The most important parts come first, because a narrow terminal cuts off the rest.  ``measure``
    is the unit of robustness.
    """

    def __init__(
        self, what: str, unit: str, count: Callable[[], int | None], measure: str = ""
    ) -> None:
        super().__init__()
        self._measure = measure
        self._what, self._unit, self._count = what, unit, count
        self._total: int | None = None
        self._begun: float | None = None
        self._number: int | None = None
        self._durations: list[float] = []
        self._best: float | None = None
        self._detail = ""
        self._console: Console

    def __enter__(self) -> LiveProgress:
        from rich.console import Console
        from rich.live import Live

        self._total = self._count()
        plain = not colours(sys.stderr)
        console = Console(file=sys.stderr, force_terminal=True, no_color=plain, highlight=False)
        self._console = console
        live = Live(
            console=console, get_renderable=self._shown, refresh_per_second=8, transient=True
        )
        self._open.enter_context(redrawing())
        self._open.enter_context(live)
        return self

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """Show that a structure is being tried; the ones before it are finished."""
        self._step(number)
        self._best, self._detail = None, " ".join(word)

    def path(self, cells: tuple[str, ...]) -> None:
        """Reset the robustness; there are too many paths to show each."""
        self._best = None

    def robustness(self, value: float) -> None:
        """Show the best robustness so far."""
        if self._best is None or value > self._best:
            self._best = value

    def note(self, text: str) -> None:
        """Show a finding until there is another."""
        self._detail = " ".join(text.split())

    def step(self, text: str) -> None:
        """Show what is being done until there is something else."""
        self.note(text)

    def finding(self, text: str) -> None:
        """Print a line above the one that is redrawn."""
        self._console.print(text, markup=False, soft_wrap=True)

    def part(self, done: int, count: int) -> None:
        """Show that ``done`` of ``count`` parts are finished."""
        self._total = count
        self._step(done)

    def _step(self, number: int) -> None:
        now = time.monotonic()
        if self._begun is not None and self._number is not None and number > self._number:
            each = (now - self._begun) / (number - self._number)
            self._durations += [each] * (number - self._number)
        self._begun, self._number = now, number

    def text(self) -> str:
        """The current line."""
        now = time.monotonic()
        parts = [self._what]
        left = None
        if self._number is not None:
            total = "" if self._total is None else f" of {self._total}"
            parts.append(f"{self._number}{total} {self._unit}")
            left = None if self._total is None else max(0, self._total - self._number)
        running = 0.0 if self._begun is None else now - self._begun
        parts += [duration_text(now - self._start), estimate_text(self._durations, running, left)]
        if self._best is not None:
            parts.append(f"robustness {self._best:.4g} {self._measure}".rstrip())
        if self._detail:
            parts.append(self._detail)
        return " · ".join(parts)

    def _shown(self) -> Constrain | Text:
        from rich.constrain import Constrain
        from rich.text import Text

        if time.monotonic() - self._start < SILENCE:
            return Text("")
        line = Text(self.text(), no_wrap=True, overflow="ellipsis")
        # Leave room for the terminal's `^C`: on a new line, it could not be removed.
        return Constrain(line, max(1, self._console.width - len("^C") - 1))


class NotebookProgress(LiveProgress):
    """The live line below the cell of a notebook, cleared at the end."""

    def __init__(self, what: str, unit: str, count: Callable[[], int | None]) -> None:
        super().__init__(what, unit, count)
        self._drawn = self._start + SILENCE - REDRAWN
        self._handle: Any = None

    def __enter__(self) -> NotebookProgress:
        self._total = self._count()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._handle is not None:
            self._handle.update({"text/plain": ""}, raw=True)

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """Show that a structure is being tried; the ones before it are finished."""
        super().structure(number, word)
        self._draw()

    def robustness(self, value: float) -> None:
        """Show the best robustness so far."""
        super().robustness(value)
        self._draw()

    def note(self, text: str) -> None:
        """Show a finding until there is another."""
        super().note(text)
        self._draw()

    def finding(self, text: str) -> None:
        """Show a part of the answer until there is another."""
        self.note(text)

    def part(self, done: int, count: int) -> None:
        """Show that ``done`` of ``count`` parts are finished."""
        super().part(done, count)
        self._draw()

    def _draw(self) -> None:
        now = time.monotonic()
        if now - self._drawn < REDRAWN:
            return
        self._drawn, line = now, {"text/plain": self.text()}
        if self._handle is None:
            show = import_module("IPython.display").display
            self._handle = show(line, raw=True, display_id=True)
        else:
            self._handle.update(line, raw=True)


def in_notebook() -> bool:
    """Whether the code runs in the kernel of a notebook."""
    ipython: Any = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None


def progress(
    what: str,
    *,
    quiet: bool,
    unit: str = "",
    count: Callable[[], int | None] = lambda: None,
    plain: bool = True,
    measure: str = "",
) -> QuietProgress:
    """The display that fits standard error or the notebook.

    Args:
        what: the name of the work.
        quiet: whether to show nothing.
        unit: the things that are counted.
        count: gives their number, or None if it is not known; called on terminals only.
        plain: whether to print lines if standard error is not a terminal.
        measure: the unit of robustness, "" if it has none or several.
    """
    if quiet:
        return QuietProgress()
    if in_notebook():
        return NotebookProgress(what, unit, count)
    if redraws(sys.stderr):
        return LiveProgress(what, unit, count, measure)
    return PlainProgress(measure) if plain else QuietProgress()


# --------------------------------------------------------------------------------------------------
# The remaining time of work with similar parts, as a range estimated from the finished parts.


LEAST_PARTS = 4
"""There is no estimate before this many parts are finished."""
NO_ESTIMATE = "no estimate"


def remaining(finished: Sequence[float], running: float, left: int) -> tuple[float, float] | None:
    """The least and the greatest time in seconds that the remaining parts may take.

    Args:
        finished: the durations of the finished parts, s, in order.
        running: how long the present part has been running, s.
        left: the number of remaining parts, including the present one.

    Returns:
        The number of remaining parts times two means, the smaller first: that of all finished
        parts, and that of the last quarter of them, with the present part if it has already
        taken longer.  Parts mostly become longer, and the range shows how much.  None after too
        few parts.
    """
    if len(finished) < LEAST_PARTS:
        return None
    recent = finished[-max(2, len(finished) // 4) :]
    if running > fmean(recent):
        recent = [*recent, running]
    rates = sorted((fmean(finished), fmean(recent)))
    return left * rates[0], left * rates[1]


def estimate_text(finished: Sequence[float], running: float, left: int | None) -> str:
    """The estimate in words; ``left`` is None if the number of parts is not known."""
    expected = None if left is None else remaining(finished, running, left)
    if expected is None:
        return NO_ESTIMATE
    low, high = (duration_text(seconds) for seconds in expected)
    return f"{low} left for all" if low == high else f"{low} to {high} left for all"


def duration_text(seconds: float) -> str:
    """A duration in one unit: ``40 s``, ``3 min``, ``2 h``."""
    for unit, size in (("s", 1), ("min", 60), ("h", 3600)):
        if seconds < 100 * size or unit == "h":
            return f"{max(1, round(seconds / size))} {unit}"
    raise AssertionError
