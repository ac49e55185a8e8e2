"""Patterns and chains of states for the Pygments lexer."""

from __future__ import annotations

from pygments.lexer import default, include, words
from pygments.token import Punctuation

from grammar_lang.units import UNIT_NAMES

FUNCTIONS = ("rot", "move", "sin", "cos", "tan", "sqrt", "abs", "rate")
EMISSIONS = (
    "rod", "point", "solid", "effector", "sphere", "capsule", "cylinder", "box", "hull", "visual",
)  # fmt: skip
ROLES = ("base", "joint", "link", "effector")
ITEMS = "module|grammar|semantics|workspace|task|mission"
END = r"(?![A-Za-z0-9_])"
NAME = rf"(?!(?:and|or|not|empty|this|world|start|accept|x|y|z){END})[A-Za-z_][A-Za-z0-9_]*"
GAP = r"(?:[ \t\r\n\f\v]++|//[^\n]*+|/\*(?:[^*]++|\*(?!/))*+\*/)*+"
NUMBER = r"[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?"
_ONE_UNIT = rf"(?:{'|'.join(sorted(UNIT_NAMES, key=len, reverse=True))})(?:\^-?[0-9]+)?"
UNIT = rf"{_ONE_UNIT}(?:[*/]{_ONE_UNIT})*(?![A-Za-z0-9_.(])"
COMPARISON = "<=|>=|==|<|>"


def word_of(*choices: str) -> words:
    """Match any of some words, but not as a part of a longer word."""
    return words(choices, suffix=END)


def separated(state: str, closing: str) -> list[object]:
    """The rules after the first item of a list: read each in ``state``, up to a bracket."""
    return [
        include("gap"),
        (",", Punctuation, state),
        (closing, Punctuation, "#pop"),
        default("#pop"),
    ]


def heading(kind: object) -> list[object]:
    """The rules for the name of an item."""
    return [include("gap"), include("next item"), (NAME, kind, "#pop"), default("#pop")]
