"""One call of ``srgc fmt``: what it writes and prints about each of its files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from srgc.formatting.canonical_form import formatted_file, formatted_stdin, replace_file


def _print(text: str) -> None:
    """As UTF-8, like the files, whatever the locale; a name that is no text as its bytes."""
    click.echo(text.encode("utf-8", "surrogateescape"), nl=False)


@dataclass(slots=True)
class FormatRun:
    """What the files of a call have in common, and how many have been formatted so far."""

    only_check: bool
    as_diff: bool
    colour: bool
    changed: int = 0
    unchanged: int = 0

    def one(self, path: Path) -> int:
        """Format a file, or standard input where the path is ``-``; the exit status.

        Raises:
            UsageFault: it cannot be read or written.
            SpecErrors: it has syntax errors.
            NotFaithful: the formatter is at fault.
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
        """How many files were written; empty where none was looked at for that."""
        parts = []
        for count, what in ((self.changed, "formatted"), (self.unchanged, "left unchanged")):
            if count:
                parts.append(f"{count} file{'s' if count != 1 else ''} {what}")
        return f"{', '.join(parts)}\n" if parts else ""
