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
"""Seconds before the live line is shown: what is done by then needs none."""
REDRAWN = 0.25
"""Seconds between two versions of the line in a notebook."""
SPARSE = 10.0
"""Seconds between two plain lines about the points of a grid."""


class QuietProgress:
    """What is told of a run, a reporter of a synthesis: here nothing is shown of it."""

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
        """A structure is being tried."""

    def path(self, cells: tuple[str, ...]) -> None:
        """A cell path is being tried."""

    def robustness(self, value: float) -> None:
        """The best robustness so far."""

    def note(self, text: str) -> None:
        """A finding worth a line."""

    def part(self, done: int, count: int) -> None:
        """So many of all parts of the work are done."""


class PlainProgress(QuietProgress):
    """One line per structure, path and improvement; ``unit`` is that of robustness."""

    def __init__(self, unit: str = "") -> None:
        super().__init__()
        self._unit = unit
        self._best: float | None = None
        self._told = self._start

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """A structure is being tried."""
        self._best = None
        self._line(f"structure {number}: {' '.join(word)}")

    def path(self, cells: tuple[str, ...]) -> None:
        """A cell path is being tried."""
        self._best = None
        self._line(f"path: {' > '.join(cells)}")

    def robustness(self, value: float) -> None:
        """A line where it grew."""
        if self._best is None or value > self._best:
            self._best = value
            self._line(f"best robustness: {value:.4g} {self._unit}".rstrip())

    def note(self, text: str) -> None:
        """A finding worth a line."""
        self._line(text)

    def part(self, done: int, count: int) -> None:
        """A line now and then, and none for work that is done soon."""
        now = time.monotonic()
        if now - self._told >= SPARSE:
            self._told = now
            self._line(f"{done} of {count}")

    def _line(self, text: str) -> None:
        _say(f"[{time.monotonic() - self._start:7.2f} s] {text}")


def tell_kept(kept: Path | None, *, quiet: bool) -> None:
    """Say where the results of an earlier version of a spec are, if there are any."""
    if kept is not None and not quiet:
        _say(visible(f"note: the spec was edited; the results so far are kept in {kept}"))


def _say(text: str) -> None:
    """A line on standard error that stays."""
    try:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
    except OSError:  # nobody reads it, or the disk is full: the work goes on all the same
        silence(sys.stderr)


class LiveProgress(QuietProgress):
    """A line that is redrawn in place, and is gone at the end.

    What matters most comes first: a terminal that is too narrow cuts the rest.  ``measure`` is the
    unit of robustness.
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
        """A structure is being tried: the ones before it are finished."""
        self._step(number)
        self._best, self._detail = None, " ".join(word)

    def path(self, cells: tuple[str, ...]) -> None:
        """Paths are too many to be told one by one."""
        self._best = None

    def robustness(self, value: float) -> None:
        """The best robustness so far."""
        if self._best is None or value > self._best:
            self._best = value

    def note(self, text: str) -> None:
        """The last finding stands until there is another."""
        self._detail = " ".join(text.split())

    def part(self, done: int, count: int) -> None:
        """So many of all parts of the work are done."""
        self._total = count
        self._step(done)

    def _step(self, number: int) -> None:
        now = time.monotonic()
        if self._begun is not None and self._number is not None and number > self._number:
            each = (now - self._begun) / (number - self._number)
            self._durations += [each] * (number - self._number)
        self._begun, self._number = now, number

    def text(self) -> str:
        """The line."""
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
        # The terminal's `^C` goes behind it: on a new line it could not be taken back.
        return Constrain(line, max(1, self._console.width - len("^C") - 1))


class NotebookProgress(LiveProgress):
    """The same line below the cell of a notebook, which is empty at the end."""

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
        """A structure is being tried: the ones before it are finished."""
        super().structure(number, word)
        self._draw()

    def robustness(self, value: float) -> None:
        """The best robustness so far."""
        super().robustness(value)
        self._draw()

    def note(self, text: str) -> None:
        """The last finding stands until there is another."""
        super().note(text)
        self._draw()

    def part(self, done: int, count: int) -> None:
        """So many of all parts of the work are done."""
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
    """Whether the kernel of a notebook runs this."""
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
    """The display that fits standard error, or the notebook.

    Args:
        what: is being done.
        quiet: nothing is shown.
        unit: what is counted.
        count: how many there are of it, None where that is not known; asked on terminals only.
        plain: where standard error is no terminal, there are lines.
        measure: the unit of robustness, "" where it has none or several.
    """
    if quiet:
        return QuietProgress()
    if in_notebook():
        return NotebookProgress(what, unit, count)
    if redraws(sys.stderr):
        return LiveProgress(what, unit, count, measure)
    return PlainProgress(measure) if plain else QuietProgress()


# --------------------------------------------------------------------------------------------------
# How long work of equal-looking parts may still take: a range from what its parts have taken.


LEAST_PARTS = 4
"""After fewer finished parts there is no estimate."""
NO_ESTIMATE = "no estimate"


def remaining(finished: Sequence[float], running: float, left: int) -> tuple[float, float] | None:
    """Seconds that the parts which are left may take, at the least and at the most.

    Args:
        finished: what each finished part took, s, in order.
        running: for how long the present part has been under way, s.
        left: how many parts there still are, the present one among them.

    Returns:
        The parts that are left, each as long as those finished on average, all of them or the last
        quarter with the present one, if that is longer already: parts mostly become longer, and a
        range says how much.  None after too few parts.
    """
    if len(finished) < LEAST_PARTS:
        return None
    recent = finished[-max(2, len(finished) // 4) :]
    if running > fmean(recent):
        recent = [*recent, running]
    rates = sorted((fmean(finished), fmean(recent)))
    return left * rates[0], left * rates[1]


def estimate_text(finished: Sequence[float], running: float, left: int | None) -> str:
    """The estimate in words; ``left`` None: nobody knows how many parts there are."""
    expected = None if left is None else remaining(finished, running, left)
    if expected is None:
        return NO_ESTIMATE
    low, high = (duration_text(seconds) for seconds in expected)
    return f"{low} left for all" if low == high else f"{low} to {high} left for all"


def duration_text(seconds: float) -> str:
    """A duration as one says it, in one unit: ``40 s``, ``3 min``, ``2 h``."""
    for unit, size in (("s", 1), ("min", 60), ("h", 3600)):
        if seconds < 100 * size or unit == "h":
            return f"{max(1, round(seconds / size))} {unit}"
    raise AssertionError
