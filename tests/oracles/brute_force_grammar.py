"""Brute force for grammars: word sets by height of derivation, conditions by their definition.

Nothing here uses the algorithms of the compiler: no automata, no normal forms, no charts.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product

from grammar_lang import ir

Word = tuple[str, ...]


def words_of(grammar: ir.Grammar, max_length: int) -> set[Word]:
    """All words up to a length that the productions derive; the accept condition is ignored."""
    return word_sets(grammar, max_length)[grammar.start]


def word_sets(grammar: ir.Grammar, max_length: int) -> dict[str, set[Word]]:
    """The words per nonterminal: derivations of height 1, 2, ... until nothing new comes."""
    found: dict[str, set[Word]] = {name: set() for name in grammar.nonterminals}
    while True:
        size = sum(map(len, found.values()))
        for production in grammar.productions:
            words: set[Word] = {()}
            for symbol in production.right:
                tails = found[symbol.name] if symbol.kind == "nonterminal" else {(symbol.name,)}
                words = {
                    w + tail for w in words for tail in tails if len(w) + len(tail) <= max_length
                }
            found[production.left] |= words
        if sum(map(len, found.values())) == size:
            return found


def sentential_words(grammar: ir.Grammar, max_length: int, max_form: int) -> set[Word]:
    """Words found by breadth-first search of leftmost sentential forms of bounded length.

    All words up to ``max_length`` where forms need not be longer than ``max_form``.
    """
    start: tuple[ir.Symbol, ...] = (ir.Symbol(grammar.start, "nonterminal"),)
    seen = {start}
    todo = [start]
    words: set[Word] = set()
    for form in todo:
        at = next((i for i, s in enumerate(form) if s.kind == "nonterminal"), None)
        if at is None:
            words.add(tuple(s.name for s in form))
            continue
        for production in grammar.productions:
            if production.left != form[at].name:
                continue
            new = form[:at] + production.right + form[at + 1 :]
            letters = sum(s.kind != "nonterminal" for s in new)
            if letters <= max_length and len(new) <= max_form and new not in seen:
                seen.add(new)
                todo.append(new)
    return words


def derivations(grammar: ir.Grammar, word: Word) -> Iterator[tuple[str, ...]]:
    """The leftmost derivations of a word as labels; the grammar must have no A =>+ A."""
    start = ir.Symbol(grammar.start, "nonterminal")
    return _of_symbol(grammar, word_sets(grammar, len(word)), start, word)


def _of_symbol(
    grammar: ir.Grammar, sets: dict[str, set[Word]], symbol: ir.Symbol, part: Word
) -> Iterator[tuple[str, ...]]:
    if symbol.kind != "nonterminal":
        if part == (symbol.name,):
            yield ()
    elif part in sets[symbol.name]:
        for production in grammar.productions:
            if production.left == symbol.name:
                for labels in _of_right(grammar, sets, production.right, part):
                    yield (production.label, *labels)


def _of_right(
    grammar: ir.Grammar, sets: dict[str, set[Word]], symbols: tuple[ir.Symbol, ...], part: Word
) -> Iterator[tuple[str, ...]]:
    if not symbols:
        if not part:
            yield ()
        return
    for cut in range(len(part) + 1):
        if _derives(sets, symbols[:1], part[:cut]) and _derives(sets, symbols[1:], part[cut:]):
            for head in _of_symbol(grammar, sets, symbols[0], part[:cut]):
                for tail in _of_right(grammar, sets, symbols[1:], part[cut:]):
                    yield head + tail


def _derives(sets: dict[str, set[Word]], symbols: tuple[ir.Symbol, ...], part: Word) -> bool:
    if not symbols:
        return not part
    words = sets[symbols[0].name] if symbols[0].kind == "nonterminal" else {(symbols[0].name,)}
    return any(
        part[:cut] in words and _derives(sets, symbols[1:], part[cut:])
        for cut in range(len(part) + 1)
    )


def satisfies(accept: ir.Accept, word: Word) -> bool:
    """The accept condition read literally; symbols of regular expressions have one character."""
    match accept:
        case ir.Contains(part):
            return any(word[i : i + len(part)] == part for i in range(len(word) + 1))
        case ir.StartsWith(part):
            return word[: len(part)] == part
        case ir.EndsWith(part):
            return not part or word[-len(part) :] == part
        case ir.Count(symbol, comparison, bound):
            number = len(word) if symbol is None else word.count(symbol)
            return {
                "<=": number <= bound,
                "<": number < bound,
                ">=": number >= bound,
                ">": number > bound,
                "==": number == bound,
            }[comparison]
        case ir.Matches(regex):
            return re.fullmatch(pattern(regex), "".join(word)) is not None
        case ir.AllOf(parts):
            return all(satisfies(part, word) for part in parts)
        case ir.AnyOf(parts):
            return any(satisfies(part, word) for part in parts)
        case ir.NotAccept(part):
            return not satisfies(part, word)


def pattern(regex: ir.Regex) -> str:
    """The same expression for the standard library's engine."""
    match regex:
        case ir.RSymbol(name):
            return re.escape(name)
        case ir.REmpty():
            return ""
        case ir.RSequence(parts):
            return "".join(f"(?:{pattern(part)})" for part in parts)
        case ir.RChoice(parts):
            return "(?:" + "|".join(f"(?:{pattern(part)})" for part in parts) + ")"
        case ir.RRepeat(part, mark):
            return f"(?:{pattern(part)}){mark}"


def all_words(alphabet: Word, max_length: int) -> list[Word]:
    """All words over an alphabet, by length, then in the order of the alphabet."""
    return [w for n in range(max_length + 1) for w in product(alphabet, repeat=n)]
