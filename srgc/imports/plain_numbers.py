"""Read numbers as files of other tools mean them: neither `1_0` nor digits of other scripts."""

from __future__ import annotations


def plain_index(word: str) -> int:
    """The integer in a text.

    Raises:
        ValueError: the text is not an integer.
    """
    return int(_plain(word))


def plain_number(word: str) -> float:
    """The number in a text.

    Raises:
        ValueError: the text is not a number.
    """
    return float(_plain(word))


def _plain(word: str) -> str:
    if "_" in word or not word.isascii():
        raise ValueError(f"{word} is not a number")
    return word
