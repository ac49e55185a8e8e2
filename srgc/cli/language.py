"""The commands about words: ``words``, ``accepts`` and ``language``."""

from __future__ import annotations

from pathlib import Path

import click

from srgc.cli.arguments import FILE, GRAMMAR, QUIET, DocumentedCommand
from srgc.cli.completions import complete_symbol
from srgc.faults import UsageFault


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc words specs/planar_arm.srg --limit 5",
        "srgc words specs/planar_arm.srg --count --max-length 15",
        "srgc words specs/planar_arm.srg --sample 3 --length 11",
    ],
    statuses={4: "counting would take too long"},
    read_on="docs/how-to/words.md",
)
@FILE
@GRAMMAR
@click.option(
    "--max-length",
    type=click.IntRange(0),
    help="The largest number of symbols of a word, including edges.",
)
@click.option(
    "--limit", type=click.IntRange(0), help="The largest number of words to list; default 100."
)
@click.option("--count", is_flag=True, help="Print the number of words of each length.")
@click.option(
    "--sample",
    type=click.IntRange(1),
    help="Draw this many words of --length, uniformly at random.",
)
@click.option(
    "--length", type=click.IntRange(0), help="With --sample: the number of symbols of a word."
)
@click.option("--seed", type=click.IntRange(0), help="With --sample: the seed; default 0.")
@QUIET
def words(
    file: Path,
    grammar: str | None,
    max_length: int | None,
    limit: int | None,
    count: bool,  # noqa: FBT001
    sample: int | None,
    length: int | None,
    seed: int | None,
    quiet: bool,  # noqa: FBT001
) -> int:
    """List the words of a robot family, shortest first, or count them, or draw some at random.

    A word has a symbol for every module and every edge.  This command lists 100 words unless
    --limit says otherwise.  A random draw gives every word the same chance, however many
    derivations it has.
    """
    if sample is None and length is not None:
        raise UsageFault("--length goes with --sample; for other lists there is --max-length")
    if sample is None and seed is not None:
        raise UsageFault("--seed goes with --sample")
    if sample is not None and (length is None or count or max_length is not None):
        raise UsageFault("--sample needs --length, and goes with neither --count nor --max-length")
    if limit is not None and (count or sample is not None):
        raise UsageFault("--limit goes with the list of words, not with --count or --sample")
    from srgc.results.progress_display import progress
    from srgc.session import chosen, program_of
    from srgc.text_reports.language_report import (
        EMPTY_WORD,
        counted,
        listed,
        nothing_listed,
        sampled,
    )

    program = program_of(file)
    family = chosen(program.grammars, grammar, "grammar")
    with progress("words", quiet=quiet, plain=False):  # all is counted before the first line
        if sample is not None and length is not None:
            lines = sampled(program, family, length, sample, seed or 0)
        elif count:
            lines = counted(program, family, max_length)
        else:
            lines = listed(program, family, max_length, 100 if limit is None else limit)
    line: str | None = None
    for line in lines:
        click.echo(line or EMPTY_WORD)
    if line is None:
        shortest = next(listed(program, family, None, 1), None)
        click.echo(f"note: {nothing_listed(family, shortest, max_length)}", err=True)
    return 0


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc accepts specs/planar_arm.srg -- B eps JO eps L eps JO eps L eps EN",
        "srgc accepts specs/planar_arm.srg --trace -- B eps JO eps L eps JO eps L eps EN",
    ],
    statuses={0: "accepted", 1: "not accepted"},
    read_on="docs/how-to/words.md",
)
@FILE
@GRAMMAR
@click.option("--trace", is_flag=True, help="Show the run of the automaton and a derivation.")
@click.argument("symbols", nargs=-1, metavar="[SYM]...", shell_complete=complete_symbol)
def accepts(file: Path, grammar: str | None, trace: bool, symbols: tuple[str, ...]) -> int:  # noqa: FBT001
    """Decide whether a word is in the family, symbol by symbol.

    If the word is not accepted, the command names the place at which no word of the family goes on.
    """
    from srgc.session import chosen, program_of
    from srgc.text_reports.language_report import acceptance_text

    program = program_of(file)
    family = chosen(program.grammars, grammar, "grammar")
    accepted, text = acceptance_text(program, family, symbols, trace=trace)
    click.echo(text)
    return 0 if accepted else 1


@click.command(
    cls=DocumentedCommand,
    examples=["srgc language specs/planar_arm.srg", "srgc language specs/nested.srg"],
    read_on="docs/how-to/words.md",
)
@FILE
@GRAMMAR
def language(file: Path, grammar: str | None) -> int:
    """Describe the language of a family: its automata, its words, and whether it is ambiguous.

    Every statement is proved.  If a property is undecidable and remains open, the output says so.
    """
    from srgc.session import chosen, program_of
    from srgc.text_reports.language_report import language_text

    program = program_of(file)
    click.echo(language_text(program, chosen(program.grammars, grammar, "grammar")))
    return 0
