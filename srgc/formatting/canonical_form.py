"""``srgc fmt``: the canonical form of files and of standard input."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import click

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.files.file_tree import LIMIT, TooLarge, decoded, read_file
from grammar_lang.formatting.formatter import canonical
from grammar_lang.source import Source
from srgc.faults import Checked, SpecErrors, UsageFault
from srgc.standard_input import STDIN, standard_input

_WRITABLE = 0o222


@dataclass(frozen=True, slots=True)
class Formatted:
    """A text and its canonical form, both as bytes."""

    name: str
    before: bytes
    after: bytes

    @property
    def changes(self) -> bool:
        """Whether the text is not canonical."""
        return self.before != self.after

    def difference(self, *, colour: bool) -> str:
        """A unified diff, coloured on request; empty if the text is canonical."""
        before, after = self.before.decode("utf-8"), self.after.decode("utf-8")
        return unified(before, after, self.name, colour=colour)


def formatted(data: bytes, name: str) -> Formatted:
    """The canonical form of a text given as bytes.

    Raises:
        SpecErrors: it has syntax errors, or it is not text.
        NotFaithful: the formatter has a bug.
    """
    sink = Sink()
    text, sound = decoded(data, 0, sink)
    after = canonical(text, sink) if sound else None
    if after is None:
        raise SpecErrors(Checked(None, sink.sorted(), (Source(name, text),)))
    return Formatted(name, data, after.encode("utf-8"))


def formatted_file(path: Path) -> Formatted:
    """The canonical form of a file; the file is not changed.

    Raises:
        UsageFault: it cannot be read.
        SpecErrors: it is missing, has syntax errors or is not text.
        NotFaithful: the formatter has a bug.
    """
    try:
        data = read_file(path, LIMIT)
    except (OSError, ValueError, TooLarge):
        from srgc.session import check_file  # loads all checks, to report what is wrong

        checked = check_file(path)
        if checked.program is not None:
            raise UsageFault(f"{path} changes while it is read") from None
        raise SpecErrors(checked) from None
    return formatted(data, str(path))


def formatted_stdin() -> Formatted:
    """The canonical form of standard input.

    Raises:
        UsageFault: it cannot be read, or is larger than a file may be.
        SpecErrors: it has syntax errors or is not text.
        NotFaithful: the formatter has a bug.
    """
    return formatted(standard_input(), STDIN)


def replace_file(path: Path, data: bytes) -> None:
    """Replace the content of a file atomically: no reader and no crash ever sees a part of it.

    A symbolic link stays, and its target is replaced.  The mode is kept, and the owner if
    permitted.

    Raises:
        UsageFault: the file or its folder cannot be written.
    """
    target = path.resolve()
    try:
        _refuse_read_only(path, target)
        with tempfile.NamedTemporaryFile(dir=target.parent, prefix=".fmt-", delete=False) as file:
            fresh = Path(file.name)
            try:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
                _take_over(target, fresh)
                fresh.replace(target)
            except BaseException:
                fresh.unlink(missing_ok=True)
                raise
    except OSError as error:
        raise UsageFault(f"{path}: cannot write it: {error.strerror}") from None


def _refuse_read_only(path: Path, target: Path) -> None:
    """Refuse a read-only file or folder, even to a user such as root who may override the mode."""
    for place, what in ((target, "it is read-only"), (target.parent, "its folder is read-only")):
        if not place.stat().st_mode & _WRITABLE or not os.access(place, os.W_OK):
            raise UsageFault(f"{path}: cannot write it: {what}")


def _take_over(old: Path, new: Path) -> None:
    status = old.stat()
    with suppress(PermissionError):
        os.chown(new, status.st_uid, status.st_gid)
    shutil.copymode(old, new)


# --- One call of ``srgc fmt``: what it writes and prints for each of its files --------------------


def _print(text: str) -> None:
    """Print as UTF-8, like the files, in any locale; names that are not text keep their bytes."""
    click.echo(text.encode("utf-8", "surrogateescape"), nl=False)


@dataclass(slots=True)
class FormatRun:
    """The options that the files of a call share, and the numbers of files formatted so far."""

    only_check: bool
    as_diff: bool
    colour: bool
    changed: int = 0
    unchanged: int = 0

    def one(self, path: Path) -> int:
        """Format a file, or standard input for ``-``; return the exit status.

        Raises:
            UsageFault: it cannot be read or written.
            SpecErrors: it has syntax errors.
            NotFaithful: the formatter has a bug.
        """
        is_stdin = str(path) == "-"
        found = formatted_stdin() if is_stdin else formatted_file(path)
        if self.as_diff:
            _print(found.difference(colour=self.colour))
        elif self.only_check:
            _print(f"{found.name}\n" if found.changes else "")
        elif is_stdin:
            click.echo(found.after, nl=False)
        else:
            self._write(path, found.after if found.changes else None)
        return int(self.only_check and found.changes)

    def _write(self, path: Path, data: bytes | None) -> None:
        if data is None:
            self.unchanged += 1
        else:
            replace_file(path, data)
            self.changed += 1

    def summary(self) -> str:
        """The number of files written and left unchanged; empty if this call writes none."""
        parts = []
        for count, what in ((self.changed, "formatted"), (self.unchanged, "left unchanged")):
            if count:
                parts.append(f"{count} file{'s' if count != 1 else ''} {what}")
        return f"{', '.join(parts)}\n" if parts else ""


# --- A unified diff of two texts that differ only in whitespace, in linear time -------------------
#
# Two lines correspond if the same number of other characters precedes their ends; no search for a
# longest common subsequence is needed. Source: the unified format of GNU diffutils, section
# "Detailed Description of Unified Format".


CONTEXT = 3

_BYTE_ORDER_MARK = "\ufeff"
_COLOURS = {"-": "\033[31m", "+": "\033[32m", "@": "\033[36m"}
_BOLD, _RESET = "\033[1m", "\033[0m"


class Change(NamedTuple):
    """Lines ``start <= i < stop`` of one text, and the lines of the other that replace them."""

    start: int
    stop: int
    other_start: int
    other_stop: int


def _lines(text: str) -> list[str]:
    """The lines with their line ends; only a line feed ends a line."""
    *lines, rest = text.split("\n")
    return [f"{line}\n" for line in lines] + ([rest] if rest else [])


def _ends(lines: Sequence[str]) -> Iterator[tuple[int, int]]:
    """For each line that is not blank, the non-blank characters up to its end, and its number."""
    count = 0
    for number, line in enumerate(lines, start=1):
        inked = sum(map(len, line.replace(_BYTE_ORDER_MARK, "").split()))
        if inked:
            count += inked
            yield count, number


def _cuts(before: Sequence[str], after: Sequence[str]) -> Iterator[tuple[int, int]]:
    """The places between lines at which both texts can be cut."""
    ends, others = list(_ends(before)), list(_ends(after))
    here = there = 0
    while here < len(ends) and there < len(others):
        if ends[here][0] == others[there][0]:
            yield ends[here][1], others[there][1]
        move, step = ends[here][0] <= others[there][0], ends[here][0] >= others[there][0]
        here, there = here + move, there + step
    yield len(before), len(after)


def _differences(before: Sequence[str], after: Sequence[str]) -> Iterator[Change]:
    """The differences between cuts, without equal lines at either end."""
    start = other_start = 0
    for end, other_end in _cuts(before, after):
        old, new = before[start:end], after[other_start:other_end]
        most = min(len(old), len(new))
        head = next((i for i in range(most) if old[i] != new[i]), most)
        most -= head
        tail = next((i for i in range(most) if old[-1 - i] != new[-1 - i]), most)
        if head + tail < max(len(old), len(new)):
            yield Change(start + head, end - tail, other_start + head, other_end - tail)
        start, other_start = end, other_end


def changes(before: Sequence[str], after: Sequence[str]) -> Iterator[Change]:
    """The differences in order; equal lines lie between any two of them."""
    found: Change | None = None
    for change in _differences(before, after):
        if found is not None and change.start == found.stop:
            found = Change(found.start, change.stop, found.other_start, change.other_stop)
        else:
            if found is not None:
                yield found
            found = change
    if found is not None:
        yield found


def _hunks(found: Iterator[Change]) -> Iterator[list[Change]]:
    """Groups of changes whose contexts touch."""
    hunk: list[Change] = []
    for change in found:
        if hunk and change.start - hunk[-1].stop > 2 * CONTEXT:
            yield hunk
            hunk = []
        hunk.append(change)
    if hunk:
        yield hunk


def _range(start: int, stop: int) -> str:
    if stop - start == 1:
        return f"{start + 1}"
    return f"{start + (stop > start)},{stop - start}"


def _hunk(hunk: Sequence[Change], before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    lead = min(CONTEXT, hunk[0].start)
    tail = min(CONTEXT, len(before) - hunk[-1].stop)
    here, end = hunk[0].start - lead, hunk[-1].stop + tail
    there, other_end = hunk[0].other_start - lead, hunk[-1].other_stop + tail
    yield f"@@ -{_range(here, end)} +{_range(there, other_end)} @@\n"
    for change in hunk:
        yield from (f" {line}" for line in before[here : change.start])
        yield from (f"-{line}" for line in before[change.start : change.stop])
        yield from (f"+{line}" for line in after[change.other_start : change.other_stop])
        here = change.stop
    yield from (f" {line}" for line in before[here:end])


def _shown(line: str, *, colour: bool) -> str:
    body, end = (
        (line[:-1], "\n") if line.endswith("\n") else (line, "\n\\ No newline at end of file\n")
    )
    paint = _COLOURS.get(line[0]) if colour else None
    return f"{body}{end}" if paint is None else f"{paint}{body}{_RESET}{end}"


def unified(before: str, after: str, name: str, *, colour: bool = False) -> str:
    """The unified diff of two texts that differ only in whitespace; empty if they are equal.

    Args:
        before: the text.
        after: the formatted text.
        name: the name of the file.
        colour: whether to use the colours of a terminal.
    """
    old, new = _lines(before), _lines(after)
    parts: list[str] = []
    for hunk in _hunks(changes(old, new)):
        parts += (_shown(line, colour=colour) for line in _hunk(hunk, old, new))
    if not parts:
        return ""
    head = (f"--- {name}", f"+++ {name}")
    shown = (f"{_BOLD}{line}{_RESET}\n" if colour else f"{line}\n" for line in head)
    return "".join((*shown, *parts))
