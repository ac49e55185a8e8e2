"""``srgc compare``: whether two grammars have the same words."""

from __future__ import annotations

from compiler.words.equivalence import compare
from compiler.words.language import language
from grammar_lang import ir


def comparison_text(
    program: ir.Program, first: ir.Grammar, second: ir.Grammar, max_length: int
) -> tuple[bool, str]:
    """Whether no difference is found, and what to print.

    Raises:
        BudgetExceededError: it would take too long.
    """
    families = [language(g, program.terminals, program.modules) for g in (first, second)]
    found = compare(families[0], families[1], max_length)
    if found.word is not None:
        owner, other = (first, second) if found.in_first else (second, first)
        word = " ".join(found.word) or "the empty word"
        return False, f"different: {owner.name} has a word that {other.name} has not:\n{word}"
    if found.longest is None:
        return True, f"{first.name} and {second.name} have the same words"
    return True, (
        f"{first.name} and {second.name} have the same words of at most {found.longest} symbols; "
        "longer ones were not compared"
    )
