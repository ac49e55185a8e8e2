"""A command whose help teaches: what it does, examples, exit statuses, and where to read on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import click

ALWAYS = {
    2: "wrong usage, or a file that cannot be read or written",
    5: "the spec has errors, or is not there",
    70: "a fault of srgc",
    130: "interrupted",
    141: "nobody reads the output any more",
}
"""Statuses that every command may end with; 5 only those that read a spec."""


class DocumentedCommand(click.Command):
    """A click command with more sections in its help.

    ``examples`` are command lines that work in a checkout of srgc, in this order; the suite runs
    them.  ``statuses`` are those of :data:`ALWAYS` and of the command itself: what each says.
    ``read_on`` names a page under ``docs/``.
    """

    def __init__(
        self,
        *arguments: Any,
        examples: Sequence[str] = (),
        statuses: Mapping[int, str] | None = None,
        reads_spec: bool = True,
        read_on: str = "",
        **options: Any,
    ) -> None:
        super().__init__(*arguments, **options)
        self.examples = tuple(examples)
        always = {k: text for k, text in ALWAYS.items() if reads_spec or k != 5}
        self.statuses = dict(sorted(({0: "done"} | dict(statuses or {}) | always).items()))
        self.read_on = read_on

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """As click does it; completing the value of an option, it knows what stands before."""
        if ctx.resilient_parsing and args and self._awaits_value(args[-1]):
            args = args[:-1]
        return super().parse_args(ctx, args)

    def _awaits_value(self, word: str) -> bool:
        """Whether a word is an option whose value comes next."""
        options = (each for each in self.params if isinstance(each, click.Option))
        return any(word in each.opts and not (each.is_flag or each.count) for each in options)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The sections after the options."""
        super().format_epilog(ctx, formatter)
        with formatter.section("Examples"):
            for example in self.examples:  # as they are: a line that is cut cannot be copied
                formatter.write(f"{'':{formatter.current_indent}}{example}\n")
        with formatter.section("Exit status"):
            formatter.write_dl([(str(status), text) for status, text in self.statuses.items()])
        if self.read_on:
            formatter.write_paragraph()
            formatter.write_text(f"Read on: {self.read_on}")
