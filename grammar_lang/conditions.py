"""Conditions on words that do not stand in a file: written as text, and read back from it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from grammar_lang import ir

_NAME = "Condition"


def condition_text(condition: ir.Accept) -> str:
    """A condition as ``accept`` writes it; reading the text gives the same condition."""
    match condition:
        case ir.Contains(word):
            return f"contains {' '.join(word)}"
        case ir.StartsWith(word):
            return f"starts with {' '.join(word)}"
        case ir.EndsWith(word):
            return f"ends with {' '.join(word)}"
        case ir.Count(symbol, comparison, bound):
            counted = "length" if symbol is None else f"count({symbol})"
            return f"{counted} {comparison} {bound}"
        case ir.Matches(regex):
            return f"matches {_regex(regex)}"
        case ir.NotAccept(part):
            return f"not {_inner(part)}"
        case ir.AllOf(parts):
            return " and ".join(map(_inner, parts))
        case ir.AnyOf(parts):
            return " or ".join(
                condition_text(part) if isinstance(part, ir.AllOf) else _inner(part)
                for part in parts
            )
        case _:
            assert_never(condition)


def _inner(condition: ir.Accept) -> str:
    text = condition_text(condition)
    return f"({text})" if isinstance(condition, ir.AllOf | ir.AnyOf) else text


def _regex(regex: ir.Regex) -> str:
    match regex:
        case ir.RSymbol(name):
            return name
        case ir.REmpty():
            return "empty"
        case ir.RSequence(parts):
            return " ".join(_grouped(part, ir.RChoice, ir.RSequence) for part in parts)
        case ir.RChoice(parts):
            return " | ".join(_grouped(part, ir.RChoice) for part in parts)
        case ir.RRepeat(part, mark):
            return _grouped(part, ir.RChoice, ir.RSequence, ir.RRepeat) + mark
        case _:
            assert_never(regex)


def _grouped(regex: ir.Regex, *kinds: type) -> str:
    return f"({_regex(regex)})" if isinstance(regex, kinds) else _regex(regex)


def condition_of(text: str, symbols: Iterable[str]) -> ir.Accept:
    """Read a condition on words over the given symbols.

    Raises:
        ValueError: the text is not a condition, or not as ``condition_text`` writes it.
    """
    # Imported here because only reading a condition needs the parser.
    from grammar_lang.load import load_text

    declared = "".join(f"edge {symbol};\n" for symbol in symbols)
    grammar = f"grammar {_NAME} {{\n start Words;\n none: Words -> empty;\n accept {text};\n}}\n"
    program = load_text(declared + grammar, "a condition").program
    found = None if program is None else program.grammars[_NAME].accept
    if found is None or condition_text(found) != text:
        raise ValueError(f"{text!r} is not a condition on words of the family")
    return found
