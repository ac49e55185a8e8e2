"""The symbols that a grammar speaks of: those of its productions and of its accept condition.

A language over these symbols alone is the same language, and its automata are as small as the
grammar, however many modules the file declares.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import assert_never

from grammar_lang import ir


def alphabet_of(grammar: ir.Grammar, order: Mapping[str, int]) -> tuple[str, ...]:
    """The terminals of a grammar and of its accept condition, in order of declaration.

    Args:
        grammar: a resolved grammar.
        order: the place of every declared terminal in the file.
    """
    used = {
        symbol.name
        for production in grammar.productions
        for symbol in production.right
        if symbol.kind != "nonterminal"
    }
    used.update(_accept_symbols(grammar.accept))
    return tuple(sorted(used, key=order.__getitem__))


def _accept_symbols(accept: ir.Accept) -> Iterator[str]:
    todo = [accept]
    while todo:
        node = todo.pop()
        match node:
            case ir.AllOf(parts) | ir.AnyOf(parts):
                todo += parts
            case ir.NotAccept(part):
                todo.append(part)
            case ir.Contains(word) | ir.StartsWith(word) | ir.EndsWith(word):
                yield from word
            case ir.Count(symbol):
                if symbol is not None:
                    yield symbol
            case ir.Matches(regex):
                yield from _regex_symbols(regex)
            case _:
                assert_never(node)


def _regex_symbols(regex: ir.Regex) -> Iterator[str]:
    todo = [regex]
    while todo:
        node = todo.pop()
        match node:
            case ir.RSymbol(name):
                yield name
            case ir.REmpty():
                pass
            case ir.RSequence(parts) | ir.RChoice(parts):
                todo += parts
            case ir.RRepeat(part):
                todo.append(part)
            case _:
                assert_never(node)
