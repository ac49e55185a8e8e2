"""``srgc words``: the lines of the list, of the counts, of the sample."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from random import Random

from compiler.words.language import language
from compiler.words.sampling import WordSampler
from grammar_lang import ir
from srgc.session import UsageFault


def listed(
    program: ir.Program, grammar: ir.Grammar, max_length: int | None, limit: int
) -> Iterator[str]:
    """The first words."""
    family = language(grammar, program.terminals, program.modules)
    return map(" ".join, islice(family.words(max_length=max_length), limit))


def counted(program: ir.Program, grammar: ir.Grammar, max_length: int | None) -> Iterator[str]:
    """The number of words of each length.

    Raises:
        UsageFault: a length is needed.
        BudgetExceededError: it would take too long.
    """
    family = language(grammar, program.terminals, program.modules)
    if max_length is None and not family.is_finite():
        raise UsageFault("the language is infinite: give --max-length to count it")
    counts = family.count_words(max_length)
    return (f"{length} {number}" for length, number in enumerate(counts))


def sampled(
    program: ir.Program, grammar: ir.Grammar, length: int, number: int, seed: int
) -> Iterator[str]:
    """Words of one length, drawn independently and uniformly.

    Raises:
        UsageFault: there is no word of that length.
        BudgetExceededError: it would take too long.
    """
    family = language(grammar, program.terminals, program.modules)
    sampler = WordSampler(family, length)
    if not sampler.number:
        raise UsageFault(f"there is no word of {length} symbols")
    random = Random(seed)  # noqa: S311  (a sample, not a secret)
    return (" ".join(sampler.draw(random)) for _ in range(number))
